/* The order of a step. A step is begun once, and attempted once. Where its solver does not converge, or contact or a
 * corrector rejects it, it is repeated as two half steps (or as a corrector divides it), up to twelve times over. What
 * a scene does not need is passed over.
 *
 * The report of an integrator is checked: the step taken must lie between 0 and the stop, and the integrator may change
 * neither the time nor the address and size of the state vector. */
#include "core/engine/contract/contract.h"
#include "core/engine/loop/loop.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum { HALVINGS = 12 };

/* What a scene needs of a step. */
enum {
  ALWAYS = 0,
  SOURCES = 1,     /* particles are born and die */
  CONSTRAINTS = 2, /* equations g(x) = 0 */
  BEFORE = 4,      /* the state before the step, for what looks back at it */
  CANDIDATES = 8,  /* forces of contact look for what may meet in the step */
  PINS = 16,       /* pins move or slide */
  MOVES = 32,      /* moves are checked against contact, as the method does not */
  ENCOUNTERS = 64, /* somebody looks at what the step missed */
  CORRECTORS = 128,
  IMPACTS = 256, /* one-sided equations are met inside steps; at their ends a method of order 1 keeps its order */
  CHOSEN = 512   /* the stages have been chosen */
};

static hk_step_stage interruption, sources, equations, keep_before, contact_candidates, integrator, arrival, pins,
    impacts, constraints, moves, encounters, correctors, acceptance;

typedef struct stage {
  unsigned need;
  hk_step_stage *take;
} stage;

static const stage beginning[] = {
    {ALWAYS, interruption},
    {SOURCES, sources},
    {CONSTRAINTS, equations},
};

static const stage attempt[] = {
    {BEFORE, keep_before},
    {CANDIDATES, contact_candidates},
    {ALWAYS, integrator}, /* with pins, parameters of the time, forces and constraints in every evaluation */
    {ALWAYS, arrival},    /* the new time */
    {PINS, pins},
    {IMPACTS, impacts},
    {CONSTRAINTS, constraints},
    {MOVES, moves},
    {ENCOUNTERS, encounters},
    {CORRECTORS, correctors},
    {ALWAYS, acceptance},
};

_Static_assert(sizeof attempt / sizeof *attempt <= HK_STAGES, "HK_STAGES: room for all stages");

static unsigned needs_of(const hk_loop *loop) {
  const hk_dynamics *d = loop->dynamics;
  const size_t count = loop->plugins->kind[HK_CORRECTOR].count;
  unsigned needs = CHOSEN;
  if (loop->emit) needs |= SOURCES;
  if (d->constrain) needs |= CONSTRAINTS;
  if (d->constrain && loop->method->order > 1 && d->constrain->may_strike(d)) needs |= IMPACTS | BEFORE;
  if (d->updates) needs |= CANDIDATES;
  if (loop->pins->has_paths || loop->pins->has_slides) needs |= PINS;
  if (d->limits && !(loop->method->flags & HK_LIMITS_MOVES)) needs |= MOVES | BEFORE;
  if (loop->hooks.moved) needs |= ENCOUNTERS | BEFORE;
  if (count) needs |= CORRECTORS;
  if (count && hk_correctors_need_start(loop)) needs |= BEFORE;
  return needs;
}

static void choose(hk_loop *loop, unsigned needs) {
  loop->needs = needs;
  loop->stages = 0;
  for (size_t k = 0; k < sizeof attempt / sizeof *attempt; k++)
    if (attempt[k].need == ALWAYS || attempt[k].need & needs) loop->stage[loop->stages++] = attempt[k].take;
}

hk_status hk_step_begin(hk_loop *loop, double h) {
  hk_attempt a = {.h = h};
  hk_status status = HK_OK;
  const unsigned needs = needs_of(loop);
  if (needs != loop->needs) choose(loop, needs);
  for (size_t k = 0; k < sizeof beginning / sizeof *beginning && status == HK_OK; k++)
    if (beginning[k].need == ALWAYS || beginning[k].need & needs) status = beginning[k].take(loop, &a);
  return status;
}

static hk_status take_stages(hk_loop *loop, hk_attempt *a) {
  hk_status status = HK_OK;
  a->rejected = false;
  a->begin = loop->state->t;
  for (size_t k = 0; k < loop->stages && status == HK_OK && !a->rejected; k++) status = loop->stage[k](loop, a);
  return status;
}

/* ---- the beginning ---- */

static hk_status interruption(hk_loop *loop, hk_attempt *a) {
  const hk_schedule *s = &loop->schedule;
  bool asked = s->interrupted && *s->interrupted,
       counted = s->step_limit && loop->record->steps + loop->record->rejected >= s->step_limit;
  (void)a;
  loop->between_steps = asked || counted;
  if (asked) return hk_error_set(loop->error, HK_INTERRUPTED, "interrupted at t = %g s", loop->state->t);
  if (counted)
    return hk_error_set(loop->error, HK_INTERRUPTED, "stopped after %zu steps at t = %g s, as asked",
                        loop->record->steps, loop->state->t);
  return HK_OK;
}

static hk_status sources(hk_loop *loop, hk_attempt *a) {
  hk_status status = loop->emitted ? HK_OK : loop->emit(loop, a->h, 0);
  loop->emitted = true;
  return status;
}

static hk_status equations(hk_loop *loop, hk_attempt *a) {
  const hk_constraint_calls *constrain = loop->dynamics->constrain;
  hk_status status = constrain->update(loop->dynamics);
  (void)a;
  if (constrain->jumped(loop->dynamics)) hk_step_reset(loop, HK_STATE_CHANGED);
  return status;
}

/* ---- an attempt ---- */

/* Only the positions where nothing may reject the step. */
static hk_status keep_before(hk_loop *loop, hk_attempt *a) {
  bool whole = loop->needs & (MOVES | IMPACTS) || hk_correctors_need_start(loop);
  size_t size = whole ? loop->state->size : 3 * loop->state->model.n + 1; /* 1: there may be no particles */
  if (whole) loop->record_before = *loop->record;
  (void)a;
  if (hk_state_copy(loop->state, &loop->X_before, &loop->room_before, size)) return HK_OK;
  return hk_error_set(loop->error, HK_NO_MEMORY, "no memory for the state before a step");
}

static hk_status contact_candidates(hk_loop *loop, hk_attempt *a) {
  return hk_contact_begin(loop, fmin(a->h, a->t_stop - a->begin));
}

static hk_status refuse_report(const hk_loop *loop, const char *what) {
  return hk_error_set(loop->error, HK_FAILED, "integrator '%s' %s at t = %.17g s: the plugin breaks its contract",
                      loop->integrator->plugin->name, what, loop->state->t);
}

/* Checks the step that the integrator reports, and that it changed no data of the host. */
static hk_status check_report(const hk_loop *loop, const hk_attempt *a) {
  const hk_system *s = &loop->dynamics->system;
  const hk_step *out = &a->out;
  double t = a->begin, most = (a->t_stop - t) * (1 + 1e-9) + 2 * DBL_EPSILON * fabs(a->t_stop);
  bool adaptive = loop->method->flags & HK_ADAPTIVE;
  if (s->t != t) return refuse_report(loop, "moved the time, which is the host's");
  if (s->X != loop->state->X || s->n != loop->state->model.n || s->size != loop->state->size)
    return refuse_report(loop, "changed the system, which is the host's");
  if (isnan(out->h)) return refuse_report(loop, "took a step without saying how long it was");
  if (!adaptive && out->h != a->h)
    return refuse_report(loop, "has a fixed step and reports another one than it was given");
  if (!(out->h > 0) || !(out->h <= most))
    return refuse_report(loop, "reports a step that is not above 0, or beyond its stop");
  if (adaptive && !(out->h_next > 0)) return refuse_report(loop, "does not say what step it would take next");
  return HK_OK;
}

/* Where forces of contact were not finite, because they were evaluated in an overlap, the step is rejected. */
static hk_status integrator(hk_loop *loop, hk_attempt *a) {
  hk_instance *instance = loop->integrator;
  const hk_integrator *method = loop->method;
  a->out = (hk_step){method->flags & HK_ADAPTIVE ? NAN : a->h, NAN, NAN};
  hk_status status = instance->spec->timed_count ? hk_instance_set_time(instance, a->begin, loop->error) : HK_OK;
  const hk_instance *outer = hk_enter(instance);
  if (status == HK_OK)
    status = method->step(instance->self, method->method, &loop->dynamics->system, a->t_stop, a->h, &a->out);
  status = hk_leave_with(instance, outer, "step", status);
  hk_dynamics_take_all(loop->dynamics);
  if (loop->needs & MOVES && !a->last) a->rejected = hk_contact_rejects(loop, &status);
  if (status != HK_OK || a->rejected) return status;
  if (loop->error->status != HK_OK)
    hk_error_clear(loop->error); /* the message of an attempt that the method repeated */
  return check_report(loop, a);
}

void hk_step_set_time(hk_loop *loop, double t) {
  loop->state->t = t;
  loop->state->view.t = t;
  loop->state->model.t = t;
  loop->dynamics->system.t = t;
}

static hk_status arrival(hk_loop *loop, hk_attempt *a) {
  double t = a->begin, h = a->out.h, t_end = a->t_stop;
  if (loop->method->flags & HK_ADAPTIVE) {
    bool reaches_stop = h >= a->stop - t || t + h >= a->stop;
    loop->step->dt = a->out.h_next;
    if (!reaches_stop && t + h == t)
      return hk_error_set(loop->error, HK_NOT_CONVERGED, "the step %g s no longer moves t = %.17g s", h, t);
    t_end = reaches_stop ? a->stop : t + h;
  }
  hk_step_set_time(loop, t_end);
  return HK_OK;
}

static hk_status pins(hk_loop *loop, hk_attempt *a) {
  hk_state *s = loop->state;
  (void)a;
  return hk_dynamics_impose(loop->dynamics, s->t, s->X, s->X + 3 * s->model.n);
}

/* A step in which a one-sided equation is met is taken back, and taken as the part up to there and the rest. */
static hk_status impacts(hk_loop *loop, hk_attempt *a) {
  hk_state *s = loop->state;
  const hk_constraint_calls *constrain = loop->dynamics->constrain;
  double h = s->t - a->begin, part;
  hk_status status = constrain->impact(loop->dynamics, s->t, s->X, s->X + 3 * s->model.n, h, &part);
  if (status != HK_OK || !(part < 1)) return status;
  a->rejected = !a->last && a->begin + part * h > a->begin;
  loop->record->late_impacts += !a->rejected;
  if (!a->rejected) return HK_OK;
  memcpy(s->X, loop->X_before, s->size * sizeof *s->X);
  loop->part = part;
  return HK_OK;
}

static hk_status constraints(hk_loop *loop, hk_attempt *a) {
  hk_state *s = loop->state;
  const hk_constraint_calls *constrain = loop->dynamics->constrain;
  const hk_constraint_table *constraint = loop->dynamics->system.constraint;
  bool kept = constraint && constraint->holonomic && hk_integrator_tables_of(loop->method)->constrained.keeps &&
              !constrain->may_strike(loop->dynamics);
  (void)a;
  hk_status status = kept ? HK_OK : constrain->project(loop->dynamics, s->t, s->X, s->X + 3 * s->model.n);
  if (constrain->jumped(loop->dynamics)) hk_step_reset(loop, HK_STATE_CHANGED);
  return status;
}

static hk_status moves(hk_loop *loop, hk_attempt *a) { return hk_contact_check(loop, a->begin, &a->rejected); }

/* The hook may have ended its own calls in this step. */
static hk_status encounters(hk_loop *loop, hk_attempt *a) {
  if (loop->hooks.moved) loop->hooks.moved(loop->hooks.context, a->out.h);
  return HK_OK;
}

static hk_status correctors(hk_loop *loop, hk_attempt *a) {
  return hk_correctors_apply(loop, a->out.h, a->last, &a->rejected);
}

static hk_status acceptance(hk_loop *loop, hk_attempt *a) { return hk_step_accept(loop, a->out.h, a->out.error); }

/* ---- an accepted step ---- */

hk_status hk_step_check(const hk_loop *loop) {
  double sum = 0;
  for (size_t k = 0; k < loop->state->size; k++) sum += loop->state->X[k] * 0;
  return sum == 0 ? HK_OK : HK_NOT_FINITE;
}

static void note_step(hk_loop *loop, double h, double error) {
  hk_record *r = loop->record;
  r->steps++;
  if (h < r->dt_min) r->dt_min = h;
  if (h > r->dt_max) r->dt_max = h;
  if (h > loop->step->limit_now * (1 + 1e-9) && h > r->dt_beyond) r->dt_beyond = h;
  if (loop->pins->has_paths) r->path_speed_error = fmax(r->path_speed_error, hk_pins_speed_error(loop->pins));
  r->step_taken = h, r->step_error = fmax(r->step_error, error);
  if (error > r->worst_error) r->worst_error = error;
}

/* What forces remember of the step. */
static hk_status accept_by_forces(hk_loop *loop, double h) {
  hk_evolution e = {0};
  hk_status status = hk_forces_accepted(loop->dynamics, h);
  if (status == HK_OK) status = hk_forces_evolve(loop->dynamics, h, &e);
  loop->record->dissipated += e.dissipated;
  if (e.changed) hk_step_reset(loop, HK_STATE_CHANGED);
  return status;
}

/* What comes to rest, or back to its start, at every frame is seen between them: at every second one of the first
 * steps, since a swing may last as many as there are between two of the later looks. */
static void note_passing(hk_loop *loop) {
  const hk_state *s = loop->state;
  loop->record->kinetic_max = fmax(loop->record->kinetic_max, hk_state_kinetic(s, s->X));
  if (loop->hooks.passing) loop->hooks.passing(loop->hooks.context);
}

hk_status hk_step_accept(hk_loop *loop, double h, double error) {
  hk_state *s = loop->state;
  loop->emitted = false;
  if (loop->dynamics->evaluations.distance) hk_evaluations_accept(&loop->dynamics->evaluations, s->t);
  note_step(loop, h, error);
  hk_status status = loop->dynamics->listens ? accept_by_forces(loop, h) : HK_OK;
  size_t steps = loop->record->steps;
  bool now_and_then = steps % HK_TILE_STEPS == 0, early = steps < HK_EARLY_STEPS && steps % 2 == 1;
  if (status == HK_OK && now_and_then) status = hk_step_check(loop);
  if (status == HK_OK && (now_and_then || early)) note_passing(loop);
  return status;
}

/* ---- the attempts of a step ---- */

static hk_status stuck(const hk_loop *loop, double h) {
  return hk_error_set(loop->error, HK_NOT_CONVERGED, "%s takes every step back, down to %g s", loop->rejected_by, h);
}

/* The state is that before a rejected attempt, and so are the time, the record and what constraints know of it. */
static hk_status restore(hk_loop *loop, const hk_attempt *a) {
  *loop->record = loop->record_before;
  loop->record->rejected++;
  hk_step_set_time(loop, a->begin);
  hk_step_reset(loop, HK_STATE_CHANGED);
  return loop->needs & IMPACTS ? loop->dynamics->constrain->update(loop->dynamics) : HK_OK;
}

static hk_status subdivide(hk_loop *loop, double t_end, double h, double part, int halvings);

static hk_status fixed_step(hk_loop *loop, double t_end, double h, int halvings) {
  hk_attempt a = {.t_stop = t_end, .stop = t_end, .h = h, .last = halvings == 0};
  hk_status status = take_stages(loop, &a);
  if (status == HK_NOT_CONVERGED && halvings > 0 && loop->state->t != t_end) {
    hk_error_clear(loop->error);
    return subdivide(loop, t_end, h, 0.5, halvings - 1);
  }
  if (status != HK_OK || !a.rejected) return status;
  status = restore(loop, &a);
  if (status != HK_OK) return status;
  if (halvings > 0 && a.begin + loop->part * h > a.begin) return subdivide(loop, t_end, h, loop->part, halvings - 1);
  return stuck(loop, h);
}

static hk_status subdivide(hk_loop *loop, double t_end, double h, double part, int halvings) {
  hk_step_reset(loop, HK_STEP_CHANGED);
  hk_status status = fixed_step(loop, loop->state->t + part * h, part * h, halvings);
  if (status == HK_OK) status = fixed_step(loop, t_end, h - part * h, halvings);
  hk_step_reset(loop, HK_STEP_CHANGED);
  return status;
}

hk_status hk_step_fixed(hk_loop *loop, double t_end, double h) { return fixed_step(loop, t_end, h, HALVINGS); }

hk_status hk_step_adaptive(hk_loop *loop, double stop, double h) {
  for (int tries = 0;; tries++, h *= loop->part) {
    double t = loop->state->t;
    hk_attempt a = {.t_stop = tries ? fmin(stop, t + h) : stop, .stop = stop, .h = h, .last = tries == HALVINGS};
    hk_status status = take_stages(loop, &a);
    if (status != HK_OK || !a.rejected) return status;
    status = restore(loop, &a);
    if (status != HK_OK) return status;
    h = fmin(h, isnan(a.out.h) ? stop - t : a.out.h);
    if (tries == HALVINGS || t + loop->part * h == t) return stuck(loop, h);
  }
}
