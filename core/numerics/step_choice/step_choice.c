/* The choice of the step size: dt of the scene or the command line, checked against the stable limit; or, without dt,
 * the limit times a safety factor. The limit is estimated at the start, after events and at some frames. The interval
 * between estimates is a number of evaluations, so that the estimates cost a few percent and runs are reproducible bit
 * by bit. What is chosen resolves beside what functions of time do, and collisions. */
#include "core/engine/contract/contract.h"
#include "core/numerics/constraints/constraints.h"
#include "core/numerics/step_choice/step_choice.h"

#include <stdlib.h>
#include <string.h>

/* Evaluations of the run per evaluation of an estimate: of those at regular intervals, the same where forces state
 * their stiffness and are watched, of those that the watch asks for, and of these where there are constraints, of which
 * it has a sample alone. */
enum { REVIEW_EVERY = 40, REVIEW_WATCHED = 100, REVIEW_RISEN = 100, REVIEW_TAUT = 20, REVIEW_FREE = 100 };

/* Where surfaces are kept apart by impulses a sheet may be crushed within few steps, and a step costs as much as some
 * ten evaluations: so many times as often. */
enum { OFTEN_IN_CONTACT = 10 };

/* A step that is shorter than this part of another is considerably so. */
static const double considerably = 0.9;

/* Of estimates after births and deaths: evaluations of the run per evaluation of one, the number that is free, and the
 * inverse of the part of the particles that has to be new. */
enum { REVIEW_BIRTHS = 20, FREE_BIRTHS = 10, TURNOVER = 10 };

/* Equal within a tenth of a percent: the old limit is then kept, since computing it can cost more than a frame of a
 * small scene. */
static bool close_to(double a, double b) { return fabs(a - b) <= 1e-3 * fmax(fabs(a), fabs(b)); }

static bool same(const hk_spectrum *a, const hk_spectrum *b) {
  bool damped_alike = true;
  for (int k = 0; k < HK_DAMPED_LINES; k++)
    damped_alike &=
        close_to(a->damped[k].slope, b->damped[k].slope) && close_to(a->damped[k].offset, b->damped[k].offset);
  return damped_alike && close_to(a->w_max, b->w_max) && close_to(a->g_max, b->g_max) && close_to(a->b_max, b->b_max) &&
         close_to(a->alpha, b->alpha) && close_to(a->beta, b->beta) && close_to(a->w_undamped, b->w_undamped) &&
         close_to(a->w_switching, b->w_switching) && close_to(a->channel_rate, b->channel_rate) && a->evaluations > 0;
}

static void find_limit(hk_step_choice *c) {
  const hk_instance *outer = hk_enter(c->integrator);
  hk_stable stable = hk_stable_step(c->method, c->parameters, &c->spectrum);
  hk_leave(c->integrator, outer);
  c->dt_limit = c->length.limit_now = stable.limit;
  c->dt_suggested = stable.suggestion;
  c->growth_rate = stable.growth_rate;
  c->growth_expected = stable.limit == 0;
}

/* For the watch, which looks rarely; the caller frees it. */
static double (*allocate_blocks(const hk_dynamics *d))[6] {
  double(*block)[6] = malloc((d->system.n + 1) * sizeof *block);
  if (!block) hk_error_set(d->error, HK_NO_MEMORY, "no memory to watch the stable step");
  return block;
}

/* What a method takes in shorter steps of its own is no part of the estimates. */
static hk_status select_fast(hk_step_choice *c, hk_dynamics *d) {
  const hk_split_facet *split = &hk_integrator_tables_of(c->method)->split;
  if (!split->select_fast) return HK_OK;
  const hk_instance *outer = hk_enter(c->integrator);
  return hk_leave_with(c->integrator, outer, "select_fast", split->select_fast(c->integrator->self, &d->system));
}

static size_t often(const hk_dynamics *d) {
  const hk_instances *correctors = &d->plugins->kind[HK_CORRECTOR];
  for (size_t k = 0; k < correctors->count; k++)
    if (correctors->item[k]->plugin->corrector->contacts) return OFTEN_IN_CONTACT;
  return 1;
}

/* (m/s)^2, the sum of the squares of the velocities of what constraints hold, less that of their mean; a function of
 * the state alone, as a run that goes on has no other. 0: there are none. */
static double motion_of(const hk_dynamics *d) {
  const hk_constraints *c = d->constraints;
  const double *v = d->state->X + 3 * d->state->model.n;
  double sum = 0;
  if (!c || c->equations == 0) return 0;
  for (size_t e = 0; e < 3; e++) {
    double mean = 0;
    for (size_t b = 0; b < c->blocks; b++) mean += v[3 * (size_t)c->list.pair[b][1] + e] / (double)c->blocks;
    for (size_t b = 0; b < c->blocks; b++) {
      double moves = v[3 * (size_t)c->list.pair[b][1] + e] - mean;
      sum += moves * moves;
    }
  }
  return sum;
}

/* At which evaluation the loop asks again: with constraints before every step, for their motion. */
static void ask_again(hk_step_choice *c, const hk_dynamics *d) {
  c->length.watch_at = d->system.constraint ? 0 : c->watch.next;
}

/* `method`: the one whose step is wanted, or that is given one; NULL: all is estimated. The evaluations and sampled
 * times of an estimate are not added to those of the run. */
static hk_status estimate(hk_step_choice *c, hk_dynamics *d, const hk_integrator *method, double given) {
  hk_counts before = d->count;
  hk_spectrum last = c->spectrum;
  hk_status status = select_fast(c, d);
  if (status != HK_OK) return status;
  status = hk_spectrum_estimate_for(&d->system, method, c->parameters, given, &c->spectrum, d->error);
  c->estimate_cost = status == HK_OK ? c->spectrum.evaluations : d->count.evaluations - before.evaluations;
  d->count = before;
  c->estimated_at = before.evaluations;
  double(*block)[6] = status == HK_OK ? allocate_blocks(d) : NULL;
  if (!block) return status == HK_OK ? HK_NO_MEMORY : status;
  c->watch.often = often(d);
  hk_watch_begin(&c->watch, &d->system, block, motion_of(d), before.evaluations);
  d->count = before;
  ask_again(c, d);
  free(block);
  if (!same(&last, &c->spectrum)) find_limit(c);
  return HK_OK;
}

hk_status hk_step_estimate(hk_step_choice *c, hk_dynamics *d) { return estimate(c, d, NULL, NAN); }

/* The usual number of steps in a collision of the discrete element method. With a symplectic method of order 2 and a
 * restitution of 0.8 it leaves the speed after a collision right to 0.6 %, and of 0.3 to 5 % (RMS over 64 instants at
 * which the collision begins); four steps to 6 and 19 %. */
static const double steps_in_collision = 20;

/* s. Implicit methods are chosen to step over what is fast. */
static double resolving_collisions(const hk_step_choice *c, const hk_dynamics *d) {
  const hk_instances *forces = &d->plugins->kind[HK_FORCE];
  double shortest = INFINITY;
  for (size_t k = 0; k < forces->count && !(c->method->flags & HK_IMPLICIT); k++) {
    const hk_instance *force = forces->item[k];
    if (!d->force_acts[k] || !hk_force_of(force->plugin)->bounds.shortest_collision) continue;
    hk_view view = hk_force_view_at(d, k, d->state->t, d->state->X, d->state->model.n);
    const hk_instance *outer = hk_enter(force);
    double lasts = hk_force_of(force->plugin)->bounds.shortest_collision(force->self, &view);
    hk_leave(force, outer);
    if (lasts > 0) shortest = fmin(shortest, lasts);
  }
  return shortest / steps_in_collision;
}

/* s, a quarter of the time in which the fastest function of time changes of which that is known: eight steps a period.
 */
static double resolving(const hk_dynamics *d) {
  double fastest = INFINITY;
  for (int kind = 0; kind < HK_KINDS; kind++)
    for (size_t k = 0; k < d->plugins->kind[kind].count; k++) {
      const hk_plugin_spec *spec = d->plugins->kind[kind].item[k]->spec;
      for (size_t j = 0; j < spec->timed_count; j++)
        if (spec->timed[j].function.fastest > 0) fastest = fmin(fastest, spec->timed[j].function.fastest);
    }
  for (size_t k = 0; k < d->pins->count; k++) {
    const hk_pin_spec *spec = d->pins->item[k].spec;
    if (spec->path.fastest > 0) fastest = fmin(fastest, spec->path.fastest);
    if (spec->rotation.fastest > 0) fastest = fmin(fastest, spec->rotation.fastest);
  }
  return fastest / 4;
}

static void choose(hk_step_choice *c, const hk_dynamics *d) {
  hk_warnings *warnings = d->shared->warnings;
  double frame = 1 / c->fps, most = fmin(resolving(d), resolving_collisions(c, d));
  c->length.dt = c->dt_estimated =
      fmin(most, c->method->flags & HK_IMPLICIT ? frame / 2 : fmin(c->dt_suggested, frame));
  if (c->growth_expected)
    hk_warn(warnings,
            "%s has no stable step on this scene; dt = %.3g s is chosen for accuracy, and motion may grow at a rate of "
            "%.3g 1/s",
            c->integrator->plugin->name, c->length.dt, c->growth_rate);
}

/* Steps end at frames: a longer one, of whatever method with fixed steps, changes nothing. */
static void take_given(hk_step_choice *c, double given, hk_warnings *warnings) {
  double frame = 1 / c->fps;
  c->length.dt = given;
  if (given > frame * (1 + 1e-9))
    hk_warn(warnings, "dt = %g s is longer than a frame of %g s, so steps are of one frame; fps = %g allows it", given,
            frame, 1 / given);
}

/* x + h v + h^2 a/2 and v + h a into X. */
static hk_status go_ahead(hk_dynamics *d, double h, double *X) {
  size_t m = 3 * d->system.n;
  double *a = calloc(d->system.size + 1, sizeof *a), *x = X, *v = X + m;
  if (!a) return hk_error_set(d->error, HK_NO_MEMORY, "no memory to foretell the stable step");
  hk_status status = d->system.accelerations(&d->system, d->system.t, x, v, X + 2 * m, a, a + m);
  for (size_t e = 0; e < m && status == HK_OK; e++) {
    x[e] += h * (v[e] + h / 2 * a[e]);
    v[e] += h * a[e];
  }
  free(a);
  return status;
}

/* Of the state a step ahead the sample of the stiffness or, where *sample is not wanted, the estimate. */
static hk_status estimate_ahead(hk_step_choice *c, hk_dynamics *d, double h, double *sample) {
  size_t size = d->system.size;
  double *kept = malloc((size + 1) * sizeof *kept), *X = d->system.X;
  hk_counts counts = d->count;
  if (!kept) return hk_error_set(d->error, HK_NO_MEMORY, "no memory to foretell the stable step");
  memcpy(kept, X, size * sizeof *kept);
  hk_status status = go_ahead(d, h, X);
  if (status == HK_OK) status = sample ? hk_stiffness_sample(&d->system, sample) : estimate(c, d, c->method, NAN);
  memcpy(X, kept, size * sizeof *kept);
  free(kept);
  d->count = counts;
  return status;
}

/* The estimate is that of a step ahead, where it allows a shorter step alone: what constraints hold stiffens as their
 * forces grow, which are none in a chain that is let go from the horizontal, so that the first step would be one of a
 * frame, and what stiffens in it would be thrown out of its way. A state ahead that cannot be evaluated is no reason to
 * fail: where the run comes to it, it says so. */
static hk_status foresee(hk_step_choice *c, hk_dynamics *d) {
  hk_error error = *d->error;
  for (bool shorter = true; shorter;) {
    const hk_step_choice before = *c;
    double sample = 0, h = c->length.dt;
    hk_status status = estimate_ahead(c, d, h, &sample);
    shorter = status == HK_OK && hk_watch_exceeded(&c->watch, sample);
    if (shorter) status = estimate_ahead(c, d, h, NULL);
    if (status == HK_NO_MEMORY) return status;
    shorter = shorter && status == HK_OK && c->dt_suggested < considerably * h;
    if (shorter)
      c->length.dt = c->dt_estimated = fmax(h / 4, c->dt_suggested);
    else
      *c = before;
    *d->error = error;
  }
  return HK_OK;
}

static void check_given(hk_step_choice *c, double given, hk_warnings *warnings) {
  take_given(c, given, warnings);
  double h = fmin(given, 1 / c->fps);
  if (c->growth_expected)
    hk_warn(warnings, "%s has no stable step on this scene; motion may grow", c->integrator->plugin->name);
  else if (h > c->dt_limit)
    hk_warn(warnings,
            "dt = %g s is above the largest stable step, %.4g s: expect an explosion; leave dt out to have it chosen",
            h, c->dt_limit);
}

hk_status hk_step_choose(hk_step_choice *c, hk_dynamics *d, double given) {
  c->chosen = isnan(given); /* a checkpoint's may have been */
  if (c->method->flags & HK_ADAPTIVE) {
    c->length.dt = isnan(given) ? INFINITY : given;
    return HK_OK;
  }
  if (c->method->flags & HK_IMPLICIT) {
    if (isnan(given))
      choose(c, d);
    else
      take_given(c, given, d->shared->warnings);
    return HK_OK;
  }
  hk_status status = estimate(c, d, c->method, given);
  if (status == HK_NOT_FINITE) { /* not caused by the step size: where F is not finite, the first evaluation says so */
    *d->error = (hk_error){0};
    c->dt_limit = c->length.limit_now = NAN;
    c->length.dt = c->dt_estimated = c->chosen ? 1 / c->fps : given;
    hk_warn(d->shared->warnings,
            "the largest stable step is not known: close to the start forces are not finite; steps are of %g s",
            c->length.dt);
    return HK_OK;
  }
  if (status != HK_OK) return status;
  if (!isnan(given)) {
    check_given(c, given, d->shared->warnings);
    return HK_OK;
  }
  choose(c, d);
  return d->system.constraint ? foresee(c, d) : HK_OK;
}

/* After a new limit: the summary reports the smallest, and a chosen dt follows it, up to `most`. */
static void keep_least(hk_step_choice *c, const hk_dynamics *d, double old, bool expected, double most) {
  c->growth_expected |= expected;
  if (c->dt_limit > old) c->dt_limit = old;
  if (c->chosen) c->length.dt = fmin(fmin(most, c->dt_suggested), resolving_collisions(c, d));
}

static bool watches(const hk_step_choice *c, const hk_dynamics *d) {
  return !(c->method->flags & (HK_ADAPTIVE | HK_IMPLICIT)) && d->state->model.n > 0 &&
         d->queries.flags & (HK_DEPENDS_ON_X | HK_DEPENDS_ON_V);
}

static hk_step_choice *choice_of(hk_step_length *length) { return (hk_step_choice *)(void *)length; }

/* After enough evaluations; with `event`, always. */
static hk_status reestimate(hk_step_length *length, hk_dynamics *d, bool event) {
  hk_step_choice *c = choice_of(length);
  size_t every = (c->watch.allowed.covered ? REVIEW_WATCHED : REVIEW_EVERY) / often(d);
  if (!watches(c, d)) return HK_OK;
  if (!event && d->count.evaluations - c->estimated_at < every * c->estimate_cost) return HK_OK;
  double old = c->dt_limit;
  bool expected = c->growth_expected;
  hk_status status = estimate(c, d, c->method, c->chosen ? NAN : c->length.dt);
  if (status != HK_OK) return status == HK_NOT_FINITE ? HK_OK : status;
  keep_least(c, d, old, expected, c->dt_estimated);
  c->dt_estimated = c->length.dt;
  return HK_OK;
}

/* Newborns may be stiffer than all others where they are lighter; a stream of births has few masses, or fewer and fewer
 * that are the lightest so far. Otherwise the scene is another one when a tenth of its particles are others, and is
 * then estimated as far as the evaluations so far can pay for it, at first without. */
static hk_status review(hk_step_length *length, hk_dynamics *d, size_t births, size_t deaths) {
  hk_step_choice *c = choice_of(length);
  const hk_model *model = &d->state->model;
  bool lighter = false;
  for (size_t i = model->n - births; i < model->n; i++)
    if (!(c->lightest > 0) || model->mass[i] < c->lightest) {
      c->lightest = model->mass[i];
      lighter = true;
    }
  c->turnover += births + deaths;
  bool another = TURNOVER * c->turnover >= model->n;
  bool stated = c->watch.allowed.covered && !(c->spectrum.w_switching > 0); /* contact is there at some times only */
  if (another && !lighter && stated) {
    c->watch.next = c->length.watch_at = 0;
    c->turnover = 0;
    return HK_OK;
  }
  bool paid = REVIEW_BIRTHS * c->births_cost <= d->count.evaluations + FREE_BIRTHS * REVIEW_BIRTHS * c->estimate_cost;
  if (!lighter && !(another && paid)) return HK_OK;
  hk_status status = reestimate(length, d, true);
  c->births_cost += c->estimate_cost;
  c->turnover = 0;
  return status;
}

static hk_status measure(hk_step_choice *c, hk_dynamics *d, size_t now, bool *risen) {
  double(*block)[6] = allocate_blocks(d);
  hk_counts before = d->count;
  hk_error error = *d->error; /* a sample that fails is left out; the step that fails there says why */
  double longer = c->dt_suggested / c->length.dt;
  c->watch.leeway = longer > 1 ? longer * longer : 1;
  *risen = block && hk_watch_measure(&c->watch, &d->system, block, motion_of(d), now);
  if (block) *d->error = error;
  d->count = before;
  ask_again(c, d);
  free(block);
  return block ? HK_OK : HK_NO_MEMORY;
}

/* Lowers the limit, and a chosen dt, before the scene has become too stiff for them. A new estimate is sharper than the
 * raised bounds, where the evaluations so far allow for it. */
static hk_status watch(hk_step_length *length, hk_dynamics *d) {
  hk_step_choice *c = choice_of(length);
  size_t now = d->count.evaluations;
  double old = c->dt_limit;
  bool expected = c->growth_expected, risen = false;
  if (!watches(c, d) || isnan(old)) return HK_OK;
  if (!hk_watch_calls(&c->watch, motion_of(d), now)) {
    ask_again(c, d);
    return HK_OK;
  }
  hk_status status = reestimate(length, d, false);
  if (status == HK_OK) status = measure(c, d, now, &risen);
  if (status != HK_OK || !risen) return status;
  size_t each = d->system.constraint ? REVIEW_TAUT : REVIEW_RISEN;
  if (each * c->estimates_cost <= often(d) * now + REVIEW_FREE * c->estimate_cost) {
    status = reestimate(length, d, true);
    c->estimates_cost += c->estimate_cost;
    if (status == HK_OK) status = measure(c, d, now, &risen);
    if (status != HK_OK || !risen) return status;
  }
  hk_watch_raise(&c->watch, &c->spectrum);
  find_limit(c);
  keep_least(c, d, old, expected, c->length.dt);
  return HK_OK;
}

hk_step_choice *hk_step_choice_open(const hk_instance *integrator, double fps) {
  const double usual = 1e-6, own = hk_integrator_of(integrator->plugin)->adaptive.tolerance;
  hk_step_choice *c = malloc(sizeof *c);
  if (!c) return NULL;
  *c = (hk_step_choice){
      .length = {.limit_now = NAN, .watch = watch, .reestimate = reestimate, .review = review},
      .method = integrator->plugin->integrator,
      .parameters = integrator->self,
      .integrator = integrator,
      .tol = own > 0 ? own : usual,
      .fps = fps,
      .dt_limit = NAN,
  };
  return c;
}
