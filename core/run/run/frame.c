/* The work of one frame: energies, momenta and measures, the script's on_frame, the outputs, and the row of
 * measures.csv, in this order. */
#include "core/run/run/run.h"

#include <stdlib.h>

hk_status hk_run_name_forces(hk_run *run) {
  const hk_instances *forces = &run->plugins.kind[HK_FORCE];
  run->force_name = calloc(forces->count + 1, sizeof *run->force_name);
  if (!run->force_name) return hk_error_set(&run->error, HK_NO_MEMORY, "no memory for the names of the forces");
  for (size_t k = 0; k < forces->count; k++) run->force_name[k] = forces->item[k]->label;
  return HK_OK;
}

static hk_status call_output(hk_run *run, hk_instance *output, const hk_frame *frame) {
  hk_view view = hk_instance_view(output, &run->state.view);
  hk_status status = hk_instance_set_time(output, run->state.t, &run->error);
  double begin = hk_clock();
  const hk_instance *outer = hk_enter(output);
  if (status == HK_OK) status = output->plugin->output->frame(output->self, &view, frame);
  status = hk_leave_with(output, outer, "frame", status);
  output->seconds += hk_clock() - begin;
  output->calls++;
  output->sampled++;
  return status;
}

/* Whether plugins left the process as it was, at the first frames and every 16th of the later ones: it takes 2 us. */
static hk_status survey(hk_run *run) {
  enum { FIRST_FRAMES = 64, EVERY = 16 };
  size_t frame = run->loop.record->frames;
  const char *what = NULL;
  if (run->shared.disturber) return hk_disturbed(&run->shared);
  if (run->options.disturbed && (frame < FIRST_FRAMES || frame % EVERY == 0)) what = run->options.disturbed();
  if (!what) return HK_OK;
  return hk_error_set(&run->error, HK_FAILED, "a plugin of this run %s, by the frame at t = %.9g s", what,
                      run->state.t);
}

/* Steps of a run that will not reach its end are better not taken. */
static hk_status keep_pace(const hk_run *run, hk_error *error) {
  static const double first_part = 0.125, times = 3;
  double limit = (double)run->options.step_limit, steps = (double)(run->record.steps + run->record.rejected);
  if (!run->options.gives_up || !(steps > first_part * limit)) return HK_OK;
  if (steps * hk_run_end(run) <= times * limit * run->state.t) return HK_OK;
  return hk_error_set(error, HK_INTERRUPTED, "given up at t = %g s: %g steps will not reach the end", run->state.t,
                      limit);
}

hk_status hk_run_frame(void *context) {
  hk_run *run = context;
  const hk_function *on_frame = &run->scene->on_frame;
  double t = run->state.t;
  size_t got = 0;
  hk_status status = survey(run);
  if (status == HK_OK) status = hk_figures_take(&run->loop, &run->judgement, run);
  if (status == HK_OK && on_frame->call) status = on_frame->call(on_frame, run, &t, 1, NULL, 0, &got, &run->error);
  hk_frame frame = hk_run_output_frame(run);
  for (size_t k = 0; k < run->outputs_open && status == HK_OK; k++)
    status = call_output(run, run->plugins.kind[HK_OUTPUT].item[k], &frame);
  if (status == HK_OK) status = hk_measures_write(run->measures, t, &run->judgement.last_frame, &run->error);
  if (status == HK_OK) status = keep_pace(run, &run->error);
  run->loop.record->step_error = 0;
  if (run->options.kept) run->options.kept(run->options.kept_context, &run->judgement.last_good, &run->state);
  hk_progress_show(&run->progress, &run->loop, &run->judgement.last_frame);
  return status;
}
