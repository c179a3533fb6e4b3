/* What outputs may ask of a frame beside its figures: nothing of the answers stays in the run. */
#include "core/engine/contract/contract.h"
#include "core/run/run/run.h"

static hk_status force(const hk_frame *frame, size_t k, double *f) {
  hk_run *run = frame->run;
  return hk_run_forces(run, k, f, &run->error);
}

static hk_view view_of(const hk_run *run, size_t k) {
  return hk_force_view_at(&run->dynamics, k, run->state.t, run->state.X, run->state.model.n);
}

static bool flow(const hk_frame *frame, size_t k, const double *x, size_t count, double *u) {
  hk_run *run = frame->run;
  const hk_instance *f = run->plugins.kind[HK_FORCE].item[k];
  if (!hk_force_of(f->plugin)->pictures.flow || !run->dynamics.force_acts[k]) return false;
  hk_view view = view_of(run, k);
  const hk_instance *outer = hk_enter(f);
  hk_force_of(f->plugin)->pictures.flow(f->self, &view, x, count, u);
  hk_leave(f, outer);
  return true;
}

static bool points_of_force(hk_run *run, size_t k, const hk_contact_points *points) {
  const hk_instance *f = run->plugins.kind[HK_FORCE].item[k];
  if (!hk_force_of(f->plugin)->pictures.contact_points) return false;
  if (!points || !run->dynamics.force_acts[k]) return true;
  hk_view view = view_of(run, k);
  const hk_instance *outer = hk_enter(f);
  hk_force_of(f->plugin)->pictures.contact_points(f->self, &view, points);
  hk_leave(f, outer);
  return true;
}

static bool points_of_corrector(hk_run *run, size_t k, const hk_contact_points *points) {
  const hk_instance *c = run->plugins.kind[HK_CORRECTOR].item[k];
  if (!c->plugin->corrector->contact_points) return false;
  if (!points) return true;
  hk_view view = hk_instance_view(c, &run->state.view);
  const hk_instance *outer = hk_enter(c);
  c->plugin->corrector->contact_points(c->self, &view, points);
  hk_leave(c, outer);
  return true;
}

static bool contact_points(const hk_frame *frame, const hk_contact_points *points) {
  hk_run *run = frame->run;
  bool any = false;
  for (size_t k = 0; k < run->plugins.kind[HK_FORCE].count; k++) any |= points_of_force(run, k, points);
  for (size_t k = 0; k < run->plugins.kind[HK_CORRECTOR].count; k++) any |= points_of_corrector(run, k, points);
  return any;
}

static hk_status bar_forces(const hk_frame *frame, const hk_pair_forces *into) {
  hk_run *run = frame->run;
  return hk_run_bar_forces(run, into, &run->error);
}

/* The measured figures are the judgement's; what outputs may ask beside them is added here, so that no address gets
 * into a checkpoint. */
hk_frame hk_run_output_frame(hk_run *run) {
  hk_frame frame = run->judgement.last_frame;
  frame.step = run->loop.record->step_taken;
  frame.error = run->loop.method->flags & HK_ADAPTIVE ? run->loop.record->step_error : NAN;
  frame.forces = run->plugins.kind[HK_FORCE].count;
  frame.force_name = run->force_name;
  frame.force = force;
  frame.flow = flow;
  frame.contact_points = contact_points;
  frame.bar_forces = bar_forces;
  frame.run = run;
  frame.scene = run->scene->script;
  frame.origin = run->scene->origin;
  return frame;
}
