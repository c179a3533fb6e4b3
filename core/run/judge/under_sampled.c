/* Whether a function of time of the script, a parameter or a pin's path, varies between the times at which the run
 * evaluated it: a pulse of one millisecond between steps of sixteen, or an oscillation with the period of the steps.
 * The functions are sampled at random times, in a number that does not depend on the steps, more densely where they
 * vary (functions/samples.c), and what they do within the distance of two evaluations is looked at (functions/rapid.c).
 * What is shorter than the distance of two samples may hide: it is assumed that there is nothing, and said; where the
 * script declares the shortest time in which a function changes, `fastest`, the samples are so dense that nothing can
 * hide. A function of the state is one of time for a particle on its way: three of them are looked at. */
#include "core/engine/contract/contract.h"
#include "core/numerics/functions/functions.h"
#include "core/run/judge/judge.h"

#include <stdlib.h>
#include <string.h>

static const size_t most_declared = 2000000, /* calls of all functions whose shortest time is declared */
    per_fastest = 4;                         /* parts in that time: samples are at most half of it apart */

/* A function of the scene, from `begin` to `end` (s), when it acts. */
typedef struct subject {
  const hk_function *function;
  const char *where, *label, *name;
  double begin, end, fastest;
  bool stepwise; /* evaluated once a step */
  bool path;     /* of a pin: between the sides of a jump it has no speed that a step could follow */
} subject;

typedef struct search {
  const hk_loop *loop;
  const hk_trajectory *trajectory; /* or NULL */
  double until;                    /* s */
  const subject *now;
  size_t most_calls, functions; /* that share the calls; half of them are kept for where a function varies */
  hk_sampling *result;
} search;

/* ---- the functions of a run ---- */

typedef void visit(search *, const subject *);

/* A function of the state as one of time: for a particle on its way, or at the place of the end where that is not
 * known. */
typedef struct on_the_way {
  hk_function function; /* first member */
  const hk_function *of_state;
  const hk_trajectory *trajectory;
  uint32_t id;
  double x[3], v[3];
  size_t arguments; /* t, x [, v], id */
} on_the_way;

static hk_status call_on_the_way(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                                 size_t max_out, size_t *n_out, hk_error *error) {
  on_the_way w = *(const on_the_way *)(const void *)f;
  (void)n_in;
  if (w.trajectory) hk_trajectory_place(w.trajectory, w.id, in[0], w.x, w.v);
  double all[] = {in[0], w.x[0], w.x[1], w.x[2], w.v[0], w.v[1], w.v[2], 0};
  all[w.arguments - 1] = w.id;
  return w.of_state->call(w.of_state, caller, all, w.arguments, out, max_out, n_out, error);
}

/* The indices of the particles that functions of a plugin are called for, *count of them; NULL: the first ones. */
static const uint32_t *called_for(const hk_instance *plugin, size_t n, size_t *count) {
  *count = plugin->is_active ? plugin->acting : n;
  for (const hk_param *p = plugin->plugin->params; p && p->name; p++) {
    if (!p->particles) continue;
    const hk_tuples *list = hk_param_in(p, plugin->self);
    *count = list->count;
    return list->index;
  }
  return plugin->active;
}

/* Functions of a force along the ways of three particles; those of a constraint, which are 0 there, at their places. */
static void visit_state_function(search *s, const hk_instance *plugin, const hk_param *p, subject one, visit *each) {
  on_the_way at = {.function.call = call_on_the_way, .arguments = hk_function_arguments(p)};
  const hk_state *state = s->loop->state;
  size_t n = state->model.n, count;
  if (at.arguments == 1) return; /* of time alone: the plugin has times of its own for it, which are not the steps' */
  const uint32_t *index = called_for(plugin, n, &count);
  at.of_state = *(const hk_function *const *)hk_param_in(p, plugin->self);
  at.trajectory = plugin->plugin->kind == HK_FORCE ? s->trajectory : NULL;
  one.function = &at.function;
  one.name = p->name;
  for (size_t k = 0; at.of_state && k < 3 && k < count; k++) {
    size_t position = k * (count - 1) / 2, i = index ? index[position] : position;
    memcpy(at.x, state->X + 3 * i, sizeof at.x);
    memcpy(at.v, state->X + 3 * (n + i), sizeof at.v);
    at.id = state->id[i];
    each(s, &one);
  }
}

static void visit_plugins(search *s, hk_kind kind, visit *each) {
  const hk_instances *list = &s->loop->plugins->kind[kind];
  for (size_t k = 0; k < list->count; k++) {
    const hk_plugin_spec *spec = list->item[k]->spec;
    subject one = {.where = spec->where, .label = spec->label, .stepwise = kind == HK_CORRECTOR};
    one.begin = fmax(0, spec->from);
    one.end = fmin(s->until, spec->to);
    for (size_t j = 0; j < spec->timed_count && one.end > one.begin; j++) {
      one.function = &spec->timed[j].function;
      one.name = spec->timed[j].param->name;
      one.fastest = one.function->fastest > 0 ? one.function->fastest : spec->fastest;
      each(s, &one);
    }
    one.fastest = spec->fastest;
    for (const hk_param *p = spec->plugin->params; p && p->name && one.end > one.begin; p++)
      if (p->function) visit_state_function(s, list->item[k], p, one, each);
  }
}

static void visit_pin(search *s, const hk_pin_spec *spec, const hk_function *function, const char *name, visit *each) {
  subject one = {function, spec->where, "pin", name, .end = fmin(s->until, spec->release)};
  one.fastest = function->fastest > 0 ? function->fastest : spec->fastest;
  one.path = true;
  if (function->call && one.end > 0) each(s, &one);
}

static void visit_all(search *s, visit *each) {
  visit_plugins(s, HK_FORCE, each);
  visit_plugins(s, HK_CONSTRAINT, each);
  visit_plugins(s, HK_CORRECTOR, each);
  for (size_t k = 0; k < s->loop->pins->count; k++) {
    const hk_pin_spec *spec = s->loop->pins->item[k].spec;
    visit_pin(s, spec, &spec->path, "path", each);
    visit_pin(s, spec, &spec->rotation, "rotation", each);
  }
}

static void count(search *s, const subject *one) {
  (void)one;
  s->functions++;
}

/* ---- one function ---- */

/* The evaluations of a run that was gone on with are known from then on: before, none were further apart than the
 * longest step. */
static double distance(const void *context, double t) {
  const search *s = context;
  double longest = s->loop->record->dt_max;
  return s->now->stepwise ? longest : hk_evaluations_distance(&s->loop->dynamics->evaluations, t, longest);
}

static void keep(hk_sampling *result, const subject *one, const hk_rapid *found) {
  if (!found->varies || found->shortest >= result->shortest) {
    result->varies |= found->varies;
  } else {
    result->varies = true;
    result->shortest = found->shortest;
    result->where = one->where;
    result->label = one->label;
    result->name = one->name;
    result->begin = found->piece[0][0];
    result->end = found->piece[0][1];
  }
  for (size_t k = 0; k < found->pieces; k++) {
    if (result->pieces == HK_SAMPLING_PIECES) break;
    result->piece[result->pieces][0] = found->piece[k][0];
    result->piece[result->pieces++][1] = found->piece[k][1];
  }
  result->more |= found->more || result->pieces == HK_SAMPLING_PIECES;
}

static void note_jumps(hk_sampling *result, const hk_samples *samples) {
  size_t listed = result->jumps < HK_SAMPLING_JUMPS ? result->jumps : HK_SAMPLING_JUMPS;
  result->jumps += hk_samples_jumps(samples, result->jump + listed, HK_SAMPLING_JUMPS - listed);
}

/* Samples of a declared time that would be too many are as many as may be, and what is assumed is what they see. */
static void look_at(search *s, const subject *one) {
  hk_sampling *result = s->result;
  hk_samples samples;
  hk_rapid found = {.varies = false};
  size_t parts = s->most_calls / 2 / s->functions, extra = parts, most = most_declared / s->functions;
  double wanted = one->fastest > 0 ? ceil((double)per_fastest * (one->end - one->begin) / one->fastest) : 0;
  bool affordable = wanted <= (double)most;
  if (wanted > (double)parts) parts = affordable ? (size_t)wanted : most;
  hk_samples_take(&samples, one->function, one->begin, one->end, parts, parts + 2 + extra);
  s->now = one;
  if (samples.count > 1) hk_rapid_find(&found, &samples, distance, s);
  s->now = NULL;
  keep(result, one, &found);
  if (!one->path) note_jumps(result, &samples);
  if (one->fastest > 0) {
    result->declared = fmin(result->declared, one->fastest);
    result->too_dear |= !affordable;
    result->steps_too_long |= s->loop->record->dt_max > one->fastest;
  }
  result->assumed = fmax(result->assumed, one->fastest > 0 && affordable ? one->fastest : samples.spacing);
  result->calls += samples.calls;
  hk_samples_free(&samples);
}

/* ---- the whole ---- */

hk_sampling hk_under_sampled(hk_loop *loop, const hk_trajectory *trajectory, size_t most_calls) {
  hk_sampling result = {.shortest = INFINITY, .declared = INFINITY};
  search s = {
      .loop = loop, .trajectory = trajectory, .until = loop->state->t, .most_calls = most_calls, .result = &result};
  visit_all(&s, count);
  visit_all(&s, look_at);
  return result;
}

static void compare_with_step(search *s, const subject *one) {
  double dt = fmin(s->loop->step->dt, 1 / s->loop->fps);
  if (one->fastest > 0 && dt > one->fastest)
    hk_warn(
        s->loop->warnings,
        "%s: %s: the steps, %.3g s, are longer than `fastest`, %.3g s: they pass over what %s does within less; give "
        "a dt of half of it, or an integrator with steps of its own",
        one->where, one->label, dt, one->fastest, one->name);
}

void hk_warn_of_long_steps(hk_loop *loop) {
  search s = {.loop = loop, .until = INFINITY};
  if (!(loop->method->flags & HK_ADAPTIVE)) visit_all(&s, compare_with_step);
}

static int by_time(const void *a, const void *b) {
  double s = *(const double *)a, t = *(const double *)b;
  return (s > t) - (s < t);
}

size_t hk_sampling_cuts(const hk_sampling *s, double *times, size_t room) {
  double all[2 * (HK_SAMPLING_PIECES + HK_SAMPLING_JUMPS)];
  size_t total = 0, kept = 0, jumps = s->jumps <= HK_SAMPLING_JUMPS ? s->jumps : 0;
  for (size_t k = 0; k < s->pieces; k++)
    for (int side = 0; side < 2; side++) all[total++] = s->piece[k][side];
  for (size_t k = 0; k < jumps; k++)
    for (int side = 0; side < 2; side++) all[total++] = s->jump[k][side];
  qsort(all, total, sizeof *all, by_time);
  for (size_t k = 0; k < total && kept < room; k++)
    if (kept == 0 || all[k] > times[kept - 1]) times[kept++] = all[k];
  return kept;
}
