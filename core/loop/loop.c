/* The time loop: alone in owning the order of a step.
 *
 *   sources; pins and time-dependent parameters; integrator, with constraints; correctors; check that all is finite.
 *
 * Time is cut at frames (k/fps exactly), at events (a force's from and to, a pin's release) and where the caller wants
 * to stop. A fixed-step method takes n equal steps between two cuts, and between two frames h = 1/(fps n) is computed
 * from the integers, so that it is the same number in every frame; the time after step i is begin + i h, never a sum.
 */
#include "core/run/engine.h"

#include <stdlib.h>
#include <string.h>

static const double golden = 0.61803398874989485;

enum { CHECK_EVERY = 32, HALVINGS = 12, PROGRESS_EVERY = 1024 };

static double frame_time(const hk_run *run, size_t frame) { return (double)frame / run->scene->fps; }

static void sooner(double *stop, double t, double candidate) {
  if (candidate > t && candidate < *stop) *stop = candidate;
}

/* The next cut after t. */
static double next_stop(const hk_run *run, double target) {
  double t = run->system.t, stop = fmin(target, frame_time(run, run->frame));
  for (size_t k = 0; k < run->scene->force.count; k++) {
    sooner(&stop, t, run->scene->force.item[k]->from);
    sooner(&stop, t, run->scene->force.item[k]->to);
  }
  for (size_t k = 0; k < run->pins; k++) sooner(&stop, t, run->pin_state[k].spec->release);
  return stop;
}

/* A refined run cuts frames at the golden section, too, where something depends on time: what is in step with every
 * division of a frame is not in step with that. */
static double refined_stop(const hk_run *run, double stop) {
  double t = run->system.t;
  bool cut = run->options.refine && run->system.flags & HK_DEPENDS_ON_T && run->frame > 0;
  return cut && t == frame_time(run, run->frame - 1) ? t + golden * (stop - t) : stop;
}

static double total_energy(hk_run *run) {
  return hk_system_kinetic(run, run->X) + hk_system_potential(run, run->system.t, run->X);
}

static bool acts_at(const hk_run *run, size_t k, double t) {
  const hk_instance *force = run->scene->force.item[k];
  return t >= force->from && t < force->to;
}

static void reset(hk_run *run, hk_reason why) {
  if (run->method->reset) run->method->reset(run->scene->integrator->self, why);
}

/* At the start of a segment: what lets go or sets in here. The energy that an event brings counts as work. */
static hk_status begin_segment(hk_run *run, double stop) {
  double middle = run->system.t + (stop - run->system.t) / 2;
  bool event = false;
  for (size_t k = 0; k < run->scene->force.count; k++) event |= run->force_acts[k] != acts_at(run, k, middle);
  for (size_t k = 0; k < run->pins; k++)
    event |= !run->pin_state[k].released && run->system.t >= run->pin_state[k].spec->release;
  if (!event) return HK_OK;
  double before = total_energy(run);
  for (size_t k = 0; k < run->scene->force.count; k++) run->force_acts[k] = acts_at(run, k, middle);
  hk_pins_release(run);
  hk_elements_refresh(run);
  run->X[run->system.size - 1] += total_energy(run) - before;
  reset(run, HK_STATE_CHANGED);
  return hk_step_reestimate(run, true);
}

static hk_status correct(hk_run *run, double h) {
  size_t n = run->model.n;
  for (size_t k = 0; k < run->scene->corrector.count; k++) {
    hk_instance *corrector = run->scene->corrector.item[k];
    hk_correction c = {.h = h, .x = run->X, .v = run->X + 3 * n};
    if (corrector->plugin->corrector->flags & HK_WANTS_BEFORE) c.x_before = run->x_before;
    hk_view view = run->view;
    view.host = &corrector->host;
    double begin = hk_clock();
    hk_status status = corrector->plugin->corrector->correct(corrector->self, &view, &c);
    corrector->seconds += hk_clock() - begin;
    corrector->calls++;
    corrector->sampled++;
    if (status != HK_OK) return status;
    if (!c.changed) continue;
    run->corrected = true;
    status = hk_pins_impose(run, run->system.t, run->X, run->X + 3 * n);
    if (status != HK_OK) return status;
    reset(run, HK_STATE_CHANGED);
  }
  return HK_OK;
}

static hk_status keep_before(hk_run *run) {
  bool wanted = false;
  for (size_t k = 0; k < run->scene->corrector.count; k++)
    wanted |= run->scene->corrector.item[k]->plugin->corrector->flags & HK_WANTS_BEFORE;
  if (!wanted) return HK_OK;
  double *grown = realloc(run->x_before, (3 * run->model.n + 1) * sizeof *grown);
  if (!grown) return hk_error_set(&run->error, HK_NO_MEMORY, "no memory for the positions before a step");
  run->x_before = grown;
  memcpy(grown, run->X, 3 * run->model.n * sizeof *grown);
  return HK_OK;
}

static hk_status births(hk_run *run, double h) {
  bool changed;
  hk_status status = hk_state_emit(run, h, &changed);
  if (status != HK_OK || !changed) return status;
  run->sourced = true;
  reset(run, HK_PARTICLES_CHANGED);
  return hk_step_reestimate(run, true);
}

static hk_status check_finite(const hk_run *run) {
  double sum = 0;
  for (size_t k = 0; k < run->system.size; k++) sum += run->X[k] * 0;
  return sum == 0 ? HK_OK : HK_NOT_FINITE;
}

static void note_step(hk_run *run, double h) {
  run->steps++;
  if (h < run->dt_min) run->dt_min = h;
  if (h > run->dt_max) run->dt_max = h;
  if (h > run->limit_now * (1 + 1e-9) && h > run->dt_beyond) run->dt_beyond = h;
}

/* After the integrator: constraints exactly, pins exactly, correctors. `t` is the new time. */
static hk_status finish_step(hk_run *run, double t, double h) {
  size_t n = run->model.n;
  run->system.t = t;
  run->view.t = t;
  run->emitted = false;
  note_step(run, h);
  hk_status status = HK_OK;
  if (run->has_paths || run->has_slides) status = hk_pins_impose(run, t, run->X, run->X + 3 * n);
  if (status == HK_OK && run->constraints) status = hk_constraints_project(run, t, run->X, run->X + 3 * n);
  if (status == HK_OK && run->scene->corrector.count) status = correct(run, h);
  if (status == HK_OK && run->steps % CHECK_EVERY == 0) {
    status = check_finite(run);
    run->kinetic_max = fmax(run->kinetic_max, hk_system_kinetic(run, run->X)); /* frames may see every swing at rest */
  }
  return status;
}

static hk_status before_step(hk_run *run, double h) {
  if (run->options.interrupted && *run->options.interrupted)
    return hk_error_set(&run->error, HK_INTERRUPTED, "interrupted at t = %g s", run->system.t);
  if (run->options.step_limit && run->steps >= run->options.step_limit)
    return hk_error_set(&run->error, HK_INTERRUPTED, "stopped after %zu steps at t = %g s, as asked", run->steps,
                        run->system.t);
  hk_status status = run->scene->source.count && !run->emitted ? births(run, h) : HK_OK;
  run->emitted = true;
  if (status == HK_OK && run->scene->corrector.count) status = keep_before(run);
  return status;
}

static hk_status try_step(hk_run *run, double t_stop, double h, hk_step *out) {
  *out = (hk_step){h, h, NAN};
  hk_instance *integrator = run->scene->integrator;
  hk_status status = run->method->step(integrator->self, &run->system, t_stop, h, out);
  hk_system_take_all(run);
  if (status == HK_OK) run->error = (hk_error){0}; /* of an attempt that the method took back */
  if (out->error > run->worst_error) run->worst_error = out->error;
  return status;
}

/* One step of h to `t_end` of a fixed-step method; a solver that does not converge gets two of half the length. */
static hk_status fixed_step(hk_run *run, double t_end, double h, int halvings) {
  hk_step out;
  hk_error kept = run->error;
  hk_status status = try_step(run, t_end, h, &out);
  if (status != HK_NOT_CONVERGED || halvings == 0) return status == HK_OK ? finish_step(run, t_end, h) : status;
  run->error = kept;
  reset(run, HK_STEP_CHANGED);
  status = fixed_step(run, run->system.t + h / 2, h / 2, halvings - 1);
  if (status == HK_OK) status = fixed_step(run, t_end, h / 2, halvings - 1);
  reset(run, HK_STEP_CHANGED);
  return status;
}

/* Not what is left by rounding between the last frame and the end. */
static bool refines(const hk_run *run, double begin, double stop) {
  return run->options.refine && stop - begin > 1e-12 * fabs(stop);
}

static hk_status fixed_segment(hk_run *run, double begin, double stop) {
  bool whole = run->frame > 0 && begin == frame_time(run, run->frame - 1) && stop == frame_time(run, run->frame);
  double length = whole ? 1 / run->scene->fps : stop - begin, pieces = ceil(length / run->dt * (1 - 1e-12));
  size_t n = pieces > 1 ? (size_t)pieces : 1;
  if (refines(run, begin, stop)) n = 2 * run->options.refine * n + 1;
  double h = whole ? 1 / (run->scene->fps * (double)n) : length / (double)n;
  if (run->last_h != 0 && h != run->last_h) reset(run, HK_STEP_CHANGED);
  run->last_h = h;
  double dt = run->dt;
  for (size_t i = 1; i <= n; i++) {
    hk_status status = before_step(run, h);
    if (status == HK_OK && run->dt < dt) return HK_OK; /* a source made the scene stiffer: cut the rest anew */
    if (run->steps % PROGRESS_EVERY == 0) hk_progress(run, false);
    bool look = i == n && run->method->flags & HK_IMPLICIT;
    if (status == HK_OK && look) hk_under_resolved_begin(run);
    if (status == HK_OK) status = fixed_step(run, i == n ? stop : begin + (double)i * h, h, HALVINGS);
    if (status == HK_OK && look) hk_under_resolved_end(run, h);
    if (status != HK_OK) return status;
  }
  return HK_OK;
}

/* What an adaptive method is offered: its own choice, or in a refined run equal parts of what is left, none longer than
 * `most`. The first step is its own: methods take what is given there for the user's word. */
static double offered(const hk_run *run, double stop, double most) {
  double left = stop - run->system.t;
  if (run->steps == 0 || !(most < run->dt)) return run->dt;
  return fmin(run->dt, left / ceil(left / most * (1 - 1e-9)));
}

static hk_status adaptive_segment(hk_run *run, double stop) {
  double most = run->options.dt_most > 0 ? run->options.dt_most : INFINITY;
  if (refines(run, run->system.t, stop))
    most = fmin(most, (stop - run->system.t) / (2 * (double)run->options.refine + 1));
  while (run->system.t < stop) {
    double t = run->system.t, h = offered(run, stop, most);
    hk_step out;
    hk_status status = before_step(run, h);
    if (status == HK_OK) status = try_step(run, stop, h, &out);
    if (status != HK_OK) return status;
    run->dt = out.h_next;
    bool lands = out.h >= stop - t || t + out.h >= stop;
    if (!lands && t + out.h == t)
      return hk_error_set(&run->error, HK_NOT_CONVERGED, "the step %g s no longer moves t = %.17g s", out.h, t);
    status = finish_step(run, lands ? stop : t + out.h, out.h);
    if (status != HK_OK) return status;
  }
  return HK_OK;
}

hk_status hk_loop_to(hk_run *run, double target) {
  double loop_begin = hk_clock(), output_before = run->output_s;
  hk_status status = HK_OK;
  if (!(run->first_step_at > 0)) run->first_step_at = loop_begin;
  while (status == HK_OK && run->system.t < target) {
    double begin = run->system.t, stop = refined_stop(run, next_stop(run, target));
    status = begin_segment(run, stop);
    if (status == HK_OK)
      status = run->method->flags & HK_ADAPTIVE ? adaptive_segment(run, stop) : fixed_segment(run, begin, stop);
    if (status == HK_OK && run->system.t == frame_time(run, run->frame)) {
      status = check_finite(run);
      if (status == HK_OK) status = hk_loop_frame(run);
      if (status == HK_OK) status = hk_step_reestimate(run, false);
    }
  }
  run->loop_s += hk_clock() - loop_begin - (run->output_s - output_before);
  return status;
}

/* Energy and invariants, measures, on_frame, outputs. */
hk_status hk_loop_frame(hk_run *run) {
  double begin = hk_clock();
  hk_status status = hk_frame_figures(run, &run->last_frame);
  size_t got = 0;
  double t = run->system.t;
  const hk_function *on_frame = &run->scene->on_frame;
  if (status == HK_OK && on_frame->call) status = on_frame->call(on_frame, &t, 1, NULL, 0, &got, &run->error);
  for (size_t k = 0; k < run->outputs_open && status == HK_OK; k++) {
    hk_instance *output = run->scene->output.item[k];
    hk_view view = run->view;
    view.host = &output->host;
    double start = hk_clock();
    status = output->plugin->output->frame(output->self, &view, &run->last_frame);
    output->seconds += hk_clock() - start;
    output->calls++;
    output->sampled++;
  }
  if (status == HK_OK) status = hk_measures_write(run);
  run->frame++;
  hk_progress(run, false);
  run->output_s += hk_clock() - begin;
  return status;
}
