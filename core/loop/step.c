/* One step, in this order: sources; updates of contact and constraints; pins and time-dependent parameters; the
 * integrator, with constraints; projection onto pins and constraints; the check of moves against contact; correctors;
 * `accepted` of the forces; check that the state is finite.
 *
 * The report of an integrator is checked: the step taken must lie between 0 and the stop, and the integrator may change
 * neither the time nor the address and size of the state vector. A step whose solver does not converge, or that contact
 * or a corrector rejects, is repeated as two half steps (or as a corrector divides it), up to twelve times over. */
#include "core/loop/loop.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum { HALVINGS = 12 };

static hk_status interrupted(const hk_loop *loop) {
  const hk_schedule *s = &loop->schedule;
  if (s->interrupted && *s->interrupted)
    return hk_error_set(loop->error, HK_INTERRUPTED, "interrupted at t = %g s", loop->state->t);
  if (s->step_limit && loop->record->steps >= s->step_limit)
    return hk_error_set(loop->error, HK_INTERRUPTED, "stopped after %zu steps at t = %g s, as asked",
                        loop->record->steps, loop->state->t);
  return HK_OK;
}

hk_status hk_step_begin(hk_loop *loop, double h) {
  hk_status status = interrupted(loop);
  loop->between_steps = status != HK_OK;
  if (status != HK_OK) return status;
  if (loop->plugins->kind[HK_SOURCE].count && !loop->emitted) status = hk_sources_emit(loop, h, 0);
  loop->emitted = true;
  if (status == HK_OK && loop->dynamics->constraints) status = hk_constraints_update(loop->dynamics);
  if (hk_constraints_jumped(loop->dynamics)) hk_step_reset(loop, HK_STATE_CHANGED);
  return status;
}

hk_status hk_step_check(const hk_loop *loop) {
  double sum = 0;
  for (size_t k = 0; k < loop->state->size; k++) sum += loop->state->X[k] * 0;
  return sum == 0 ? HK_OK : HK_NOT_FINITE;
}

static void note_step(hk_loop *loop, double h) {
  hk_record *r = loop->record;
  r->steps++;
  if (h < r->dt_min) r->dt_min = h;
  if (h > r->dt_max) r->dt_max = h;
  if (h > loop->step->limit_now * (1 + 1e-9) && h > r->dt_beyond) r->dt_beyond = h;
  if (loop->pins->has_paths) r->path_speed_error = fmax(r->path_speed_error, hk_pins_speed_error(loop->pins));
}

void hk_step_set_time(hk_loop *loop, double t) {
  loop->state->t = t;
  loop->state->view.t = t;
  loop->dynamics->system.t = t;
}

hk_status hk_step_accept(hk_loop *loop, double h, double error, hk_status status) {
  hk_state *s = loop->state;
  loop->emitted = false;
  hk_evaluations_accept(&loop->dynamics->evaluations, s->t);
  note_step(loop, h);
  loop->record->step_taken = h, loop->record->step_error = fmax(loop->record->step_error, error);
  if (error > loop->record->worst_error) loop->record->worst_error = error;
  if (status == HK_OK && loop->dynamics->listens) status = hk_sweep_accepted(loop->dynamics, h);
  if (status == HK_OK && loop->record->steps % HK_LEVELS == 0) {
    status = hk_step_check(loop); /* the kinetic energy may be zero at every frame */
    loop->record->kinetic_max = fmax(loop->record->kinetic_max, hk_state_kinetic(s, s->X));
  }
  return status;
}

/* The parts of a step after the integrator. `t` is the new time, `error` the integrator's estimate. *rejected: the step
 * is to be repeated, and the state before the step is restored. */
static hk_status finish(hk_loop *loop, double t, double h, double error, bool *rejected) {
  hk_state *s = loop->state;
  double before = s->t, *x = s->X, *v = s->X + 3 * s->model.n;
  const hk_record kept = *loop->record;
  hk_status status = HK_OK;
  *rejected = false;
  hk_step_set_time(loop, t);
  if (loop->pins->has_paths || loop->pins->has_slides) status = hk_dynamics_impose(loop->dynamics, t, x, v);
  bool held = loop->step->method->flags & HK_KEEPS_CONSTRAINTS && loop->dynamics->system.holonomic;
  if (status == HK_OK && loop->dynamics->constraints && !held) status = hk_constraints_project(loop->dynamics, t, x, v);
  if (hk_constraints_jumped(loop->dynamics)) hk_step_reset(loop, HK_STATE_CHANGED);
  if (status == HK_OK && hk_contact_checks(loop)) status = hk_contact_check(loop, before, rejected);
  if (status == HK_OK && !*rejected && loop->hooks.moved) loop->hooks.moved(loop->hooks.context, h);
  if (status == HK_OK && !*rejected && loop->plugins->kind[HK_CORRECTOR].count)
    status = hk_correctors_apply(loop, h, rejected);
  if (*rejected) {
    *loop->record = kept;
    loop->record->rejected++;
    hk_step_set_time(loop, before);
    return status;
  }
  return hk_step_accept(loop, h, error, status);
}

static hk_status refuse_report(const hk_loop *loop, const char *what) {
  return hk_error_set(loop->error, HK_FAILED, "integrator '%s' %s at t = %.17g s: the plugin breaks its contract",
                      loop->step->method_name, what, loop->state->t);
}

/* Checks the step that the integrator reports, and that it changed no data of the host. */
static hk_status check_report(const hk_loop *loop, double t_stop, double h, const hk_step *out) {
  const hk_system *s = &loop->dynamics->system;
  double t = loop->state->t, most = (t_stop - t) * (1 + 1e-9) + 2 * DBL_EPSILON * fabs(t_stop);
  bool adaptive = loop->step->method->flags & HK_ADAPTIVE;
  if (s->t != t) return refuse_report(loop, "moved the time, which is the host's");
  if (s->X != loop->state->X || s->n != loop->state->model.n || s->size != loop->state->size)
    return refuse_report(loop, "changed the system, which is the host's");
  if (isnan(out->h)) return refuse_report(loop, "took a step without saying how long it was");
  if (!adaptive && out->h != h)
    return refuse_report(loop, "has a fixed step and reports another one than it was given");
  if (!(out->h > 0) || !(out->h <= most))
    return refuse_report(loop, "reports a step that is not above 0, or beyond its stop");
  if (adaptive && !(out->h_next > 0)) return refuse_report(loop, "does not say what step it would take next");
  return HK_OK;
}

/* Keeps the state before a step where contact or a corrector needs it, or its positions for the hook `moved`. */
static hk_status keep(hk_loop *loop) {
  bool whole = hk_contact_checks(loop) || hk_correctors_look_back(loop);
  if (!whole && !loop->hooks.moved) return HK_OK;
  size_t size = whole ? loop->state->size : 3 * loop->state->model.n + 1; /* 1: there may be no particles */
  double *grown = size > loop->room_before ? realloc(loop->X_before, size * sizeof *grown) : loop->X_before;
  if (!grown) return hk_error_set(loop->error, HK_NO_MEMORY, "no memory for the state before a step");
  loop->X_before = grown;
  if (size > loop->room_before) loop->room_before = size;
  memcpy(grown, loop->state->X, size * sizeof *grown);
  return HK_OK;
}

static hk_status integrate(hk_loop *loop, double t_stop, double h, hk_step *out) {
  hk_instance *integrator = loop->integrator;
  const hk_integrator *method = loop->step->method;
  *out = (hk_step){method->flags & HK_ADAPTIVE ? NAN : h, NAN, NAN};
  hk_status status = keep(loop);
  if (status == HK_OK && loop->dynamics->updates) status = hk_contact_begin(loop, fmin(h, t_stop - loop->state->t));
  if (status == HK_OK && integrator->spec->timed_count)
    status = hk_instance_set_time(integrator, loop->state->t, loop->error);
  const hk_instance *outer = hk_enter(integrator);
  if (status == HK_OK) status = method->step(integrator->self, &loop->dynamics->system, t_stop, h, out);
  status = hk_leave_with(integrator, outer, "step", status);
  hk_dynamics_take_all(loop->dynamics);
  if (status != HK_OK) return status;
  hk_error_clear(loop->error); /* the message of an attempt that the method repeated */
  return check_report(loop, t_stop, h, out);
}

static hk_status stuck(const hk_loop *loop, double h) {
  return hk_error_set(loop->error, HK_NOT_CONVERGED, "%s takes every step back, down to %g s", loop->rejected_by, h);
}

static hk_status divide(hk_loop *loop, double t_end, double h, double part, int halvings);

static hk_status one_step(hk_loop *loop, double t_end, double h, int halvings) {
  hk_step out;
  bool rejected = false;
  hk_status status = integrate(loop, t_end, h, &out);
  if (halvings > 0) rejected = hk_contact_takes_back(loop, &status);
  if (status == HK_OK && !rejected) status = finish(loop, t_end, h, out.error, &rejected);
  if (status == HK_NOT_CONVERGED && halvings > 0 && loop->state->t != t_end) {
    hk_error_clear(loop->error);
    return divide(loop, t_end, h, 0.5, halvings - 1);
  }
  if (!rejected) return status;
  hk_step_reset(loop, HK_STATE_CHANGED);
  if (halvings > 0 && loop->state->t + loop->part * h > loop->state->t)
    return divide(loop, t_end, h, loop->part, halvings - 1);
  return stuck(loop, h);
}

static hk_status divide(hk_loop *loop, double t_end, double h, double part, int halvings) {
  hk_step_reset(loop, HK_STEP_CHANGED);
  hk_status status = one_step(loop, loop->state->t + part * h, part * h, halvings);
  if (status == HK_OK) status = one_step(loop, t_end, h - part * h, halvings);
  hk_step_reset(loop, HK_STEP_CHANGED);
  return status;
}

hk_status hk_step_fixed(hk_loop *loop, double t_end, double h) { return one_step(loop, t_end, h, HALVINGS); }

hk_status hk_step_adaptive(hk_loop *loop, double stop, double h) {
  for (int tries = 0;; tries++, h *= loop->part) {
    hk_step out;
    bool rejected = false;
    double t = loop->state->t;
    hk_status status = integrate(loop, tries ? fmin(stop, t + h) : stop, h, &out);
    if (tries < HALVINGS && hk_contact_takes_back(loop, &status)) {
      h = fmin(h, stop - t);
      hk_step_reset(loop, HK_STATE_CHANGED);
      continue;
    }
    if (status != HK_OK) return status;
    loop->step->dt = out.h_next;
    bool reaches_stop = out.h >= stop - t || t + out.h >= stop;
    if (!reaches_stop && t + out.h == t)
      return hk_error_set(loop->error, HK_NOT_CONVERGED, "the step %g s no longer moves t = %.17g s", out.h, t);
    h = fmin(h, out.h);
    status = finish(loop, reaches_stop ? stop : t + out.h, out.h, out.error, &rejected);
    if (!rejected) return status;
    hk_step_reset(loop, HK_STATE_CHANGED);
    if (tries == HALVINGS || t + loop->part * h == t) return stuck(loop, h);
  }
}
