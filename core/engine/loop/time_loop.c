/* The time loop. Time is cut at frames (k/fps exactly), at events (a force's from and to, a pin's release) and at the
 * caller's target time. A fixed-step method takes n equal steps between two cuts, and between two frames h = 1/(fps n)
 * is computed from the integers, so that it is the same number in every frame; the time after step i is begin + i h,
 * not a sum of steps. */
#include "core/engine/loop/loop.h"

#include <float.h>
#include <stdlib.h>

enum { HOOK_EVERY = 64 };

static double frame_time(const hk_loop *loop, size_t frame) { return (double)frame / loop->fps; }

static void take_earlier(double *stop, double t, double candidate) {
  if (candidate > t && candidate < *stop) *stop = candidate;
}

/* The first of the schedule's cuts after t, or `stop` where that is earlier. */
static double before_cut(const hk_schedule *s, double t, double stop) {
  size_t low = 0, high = s->cuts;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (s->cut[middle] > t)
      high = middle;
    else
      low = middle + 1;
  }
  return low < s->cuts ? fmin(stop, s->cut[low]) : stop;
}

/* The next cut after t. */
static double next_stop(const hk_loop *loop, double target) {
  const hk_instances *forces = &loop->plugins->kind[HK_FORCE];
  double t = loop->state->t, stop = fmin(target, frame_time(loop, loop->record->frames));
  for (size_t k = 0; k < forces->count; k++) {
    take_earlier(&stop, t, forces->item[k]->spec->from);
    take_earlier(&stop, t, forces->item[k]->spec->to);
  }
  for (size_t k = 0; k < loop->pins->count; k++) take_earlier(&stop, t, loop->pins->item[k].spec->release);
  return before_cut(&loop->schedule, t, stop);
}

/* The additional cut of a frame that the schedule asks for. */
static double scheduled_stop(const hk_loop *loop, double stop) {
  double t = loop->state->t;
  bool cut = loop->schedule.part > 0 && loop->record->frames > 0;
  return cut && t == frame_time(loop, loop->record->frames - 1) ? t + loop->schedule.part * (stop - t) : stop;
}

static double total_energy(hk_loop *loop) {
  const hk_state *s = loop->state;
  return hk_state_kinetic(s, s->X) + hk_query_potential(loop->dynamics, s->t, s->X);
}

static hk_status reestimate(hk_loop *loop, bool event) {
  return loop->step->reestimate ? loop->step->reestimate(loop->step, loop->dynamics, event) : HK_OK;
}

static hk_status watch(hk_loop *loop) {
  const bool due = loop->step->watch && loop->dynamics->count.evaluations >= loop->step->watch_at;
  return due ? loop->step->watch(loop->step, loop->dynamics) : HK_OK;
}

double hk_loop_longest_step(hk_loop *loop) {
  double forces = loop->dynamics->demands ? hk_forces_longest_step(loop->dynamics) : INFINITY;
  return loop->plugins->kind[HK_CORRECTOR].count ? fmin(forces, hk_correctors_longest_step(loop)) : forces;
}

/* The events at the start of a segment: pins are released, forces begin or end to act. The change of energy by an event
 * counts as work. */
static hk_status begin_segment(hk_loop *loop, double stop) {
  hk_state *s = loop->state;
  hk_dynamics *d = loop->dynamics;
  const hk_instances *forces = &loop->plugins->kind[HK_FORCE];
  double middle = s->t + (stop - s->t) / 2;
  bool event = hk_pins_release_at(loop->pins, s->t);
  for (size_t k = 0; k < forces->count; k++) event |= d->force_acts[k] != hk_force_acts_at(forces->item[k], middle);
  if (!event) return HK_OK;
  double before = total_energy(loop);
  for (size_t k = 0; k < forces->count; k++) d->force_acts[k] = hk_force_acts_at(forces->item[k], middle);
  hk_pins_release(loop->pins, s);
  hk_dynamics_refresh(d);
  hk_status status = hk_elements_refresh(d);
  if (status == HK_OK) status = hk_forces_settle(d);
  hk_evolution begun = {0}; /* what it dissipates is in the change of the energy */
  if (status == HK_OK) status = hk_forces_evolve(d, 0, &begun);
  if (status != HK_OK) return status;
  s->X[s->size - 1] += total_energy(loop) - before;
  hk_step_reset(loop, HK_STATE_CHANGED);
  return reestimate(loop, true);
}

/* Whether the interval is divided more finely. The rounding difference between the last frame and the end is not. */
static bool refines(const hk_loop *loop, double begin, double stop) {
  return loop->schedule.refine && stop - begin > 1e-12 * fabs(stop);
}

static void periodic_hook(hk_loop *loop) {
  if (loop->hooks.now_and_then && loop->record->steps % HOOK_EVERY == 0) loop->hooks.now_and_then(loop->hooks.context);
}

/* Cuts the time from now to stop into n equal steps h. */
static void cut_into_steps(hk_loop *loop, double stop) {
  size_t frames = loop->record->frames;
  hk_piece *p = &loop->piece;
  *p = (hk_piece){.i = 1, .begin = loop->state->t, .stop = stop, .dt = loop->step->dt};
  bool whole = frames > 0 && p->begin == frame_time(loop, frames - 1) && stop == frame_time(loop, frames);
  double length = whole ? 1 / loop->fps : stop - p->begin;
  double pieces = ceil(length / fmin(p->dt, hk_loop_longest_step(loop)) * (1 - 1e-12));
  p->n = pieces > 1 ? (size_t)pieces : 1;
  if (refines(loop, p->begin, stop)) p->n = 2 * loop->schedule.refine * p->n + 1;
  p->h = whole ? 1 / (loop->fps * (double)p->n) : length / (double)p->n;
  if (loop->last_h != 0 && p->h != loop->last_h) hk_step_reset(loop, HK_STEP_CHANGED);
  loop->last_h = p->h;
}

/* Whether the rest of the segment needs shorter steps than when it was divided: sources made the scene stiffer, or a
 * force demands them. The slack is twice that of `cut_into_steps`, for rounding. */
static bool too_long(hk_loop *loop, const hk_piece *p) {
  return loop->step->dt < p->dt || hk_loop_longest_step(loop) < p->h * (1 - 2e-12);
}

/* Steps have to move the time `at`; 64: so that their lengths have some digits, too. */
static hk_status check_length(hk_loop *loop, double dt, double at) {
  double demanded = hk_loop_longest_step(loop), least = 64 * DBL_EPSILON * fabs(at);
  if (demanded > least && dt > least) return HK_OK;
  return hk_error_set(loop->error, demanded > least ? HK_BAD_PARAM : HK_NOT_CONVERGED,
                      "%s allows steps of %g s at most, too short to move t = %g s; above %.1g s they are not",
                      demanded > least ? "dt" : "a force or a corrector", fmin(dt, demanded), loop->state->t, least);
}

/* The next steps of the piece; *length: how many. */
static hk_status piece_steps(hk_loop *loop, const hk_piece *p, bool tiles, size_t *length) {
  const hk_loop_hooks *hooks = p->i == p->n ? &loop->hooks : NULL;
  periodic_hook(loop);
  if (tiles && (*length = hk_tile_length(loop, p)) > 0) return hk_tile_take(loop, p, length);
  *length = 1;
  if (hooks && !(hooks->before_sample && hooks->after_sample)) hooks = NULL;
  if (hooks) hooks->before_sample(hooks->context);
  hk_status status = hk_step_fixed(loop, p->i == p->n ? p->stop : p->begin + (double)p->i * p->h, p->h);
  if (status == HK_OK && hooks) hooks->after_sample(hooks->context, p->h);
  return status;
}

static hk_status fixed_segment(hk_loop *loop, double stop) {
  hk_piece *p = &loop->piece;
  if (p->n == 0 || p->stop != stop) { /* otherwise the run was interrupted in this piece */
    hk_status status = check_length(loop, loop->step->dt, stop);
    if (status != HK_OK) return status;
    cut_into_steps(loop, stop);
  }
  const bool tiles = hk_tile_fits(loop);
  for (size_t length = 1; p->i <= p->n; p->i += length) {
    hk_status status = hk_step_begin(loop, p->h);
    if (status == HK_OK) status = watch(loop);
    if (status == HK_OK && too_long(loop, p)) break;
    if (status == HK_OK) status = piece_steps(loop, p, tiles, &length);
    if (status == HK_OK && loop->emit) status = loop->emit(loop, p->h, HK_AFTER_STEPS);
    if (status != HK_OK) return status;
  }
  p->n = 0;
  return HK_OK;
}

/* The step offered to an adaptive method: the method's own choice, or, in a refined run, equal parts of the remaining
 * interval, none longer than `most`. The first step is the method's choice, because methods treat a step given there as
 * the user's dt. */
static double offered_step(const hk_loop *loop, double stop, double most) {
  double remaining = stop - loop->state->t, dt = loop->step->dt;
  if (loop->record->steps == 0 || !(most < dt)) return dt;
  return fmin(dt, remaining / ceil(remaining / most * (1 - 1e-9)));
}

static hk_status adaptive_segment(hk_loop *loop, double stop) {
  double most = loop->schedule.dt_most > 0 ? loop->schedule.dt_most : INFINITY;
  if (refines(loop, loop->state->t, stop))
    most = fmin(most, (stop - loop->state->t) / (2 * (double)loop->schedule.refine + 1));
  while (loop->state->t < stop) {
    double longest = hk_loop_longest_step(loop), h = fmin(longest, offered_step(loop, stop, fmin(most, longest)));
    hk_status status = hk_step_begin(loop, h);
    longest = hk_loop_longest_step(loop); /* of the newborn, too */
    if (status == HK_OK) status = check_length(loop, INFINITY, loop->state->t);
    double begin = loop->state->t;
    if (status == HK_OK) status = hk_step_adaptive(loop, stop, fmin(h, longest));
    if (status == HK_OK && loop->emit) status = loop->emit(loop, loop->state->t - begin, HK_AFTER_STEPS);
    if (status != HK_OK) return status;
  }
  return HK_OK;
}

static hk_status segment(hk_loop *loop, double target) {
  double stop = scheduled_stop(loop, next_stop(loop, target));
  bool adaptive = loop->method->flags & HK_ADAPTIVE;
  hk_status status = begin_segment(loop, stop);
  if (status == HK_OK) status = adaptive ? adaptive_segment(loop, stop) : fixed_segment(loop, stop);
  if (status != HK_OK || loop->state->t != frame_time(loop, loop->record->frames)) return status;
  status = hk_step_check(loop);
  if (status == HK_OK) status = hk_loop_frame(loop);
  if (status == HK_OK) status = reestimate(loop, false);
  return status == HK_OK && loop->hooks.framed ? loop->hooks.framed(loop->hooks.context) : status;
}

void hk_loop_open(hk_loop *loop, hk_dynamics *d, hk_step_length *step, hk_record *record, double fps) {
  hk_instance *integrator = hk_plugins_one(d->plugins, HK_INTEGRATOR);
  *loop = (hk_loop){.state = d->state, .pins = d->pins, .plugins = d->plugins, .dynamics = d, .step = step, .fps = fps};
  loop->record = record;
  loop->record->dt_min = INFINITY;
  loop->warnings = d->shared->warnings;
  loop->error = d->error;
  loop->integrator = integrator;
  loop->method = integrator->plugin->integrator;
}

hk_status hk_loop_to(hk_loop *loop, double target) {
  double begin = hk_clock(), output_before = loop->output_seconds;
  hk_status status = HK_OK;
  if (!(loop->first_step_at > 0)) loop->first_step_at = begin;
  while (status == HK_OK && loop->state->t < target) status = segment(loop, target);
  loop->seconds += hk_clock() - begin - (loop->output_seconds - output_before);
  return status;
}

hk_status hk_loop_frame(hk_loop *loop) {
  double begin = hk_clock();
  hk_status status = loop->hooks.frame ? loop->hooks.frame(loop->hooks.context) : HK_OK;
  loop->record->frames++;
  loop->output_seconds += hk_clock() - begin;
  return status;
}

void hk_loop_close(hk_loop *loop) {
  free(loop->X_before);
  free(loop->X_end);
}
