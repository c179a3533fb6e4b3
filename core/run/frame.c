/* The work of one frame: energies, momenta and measures, the script's on_frame, the outputs, and the row of
 * measures.csv, in this order. */
#include "core/run/run.h"

static hk_status call_output(hk_run *run, hk_instance *output) {
  hk_view view = hk_instance_view(output, &run->state.view);
  hk_status status = hk_instance_set_time(output, run->state.t, &run->error);
  double begin = hk_clock();
  const hk_instance *outer = hk_enter(output);
  if (status == HK_OK) status = output->plugin->output->frame(output->self, &view, &run->judgement.last_frame);
  status = hk_leave_with(output, outer, "frame", status);
  output->seconds += hk_clock() - begin;
  output->calls++;
  output->sampled++;
  return status;
}

hk_status hk_run_frame(void *context) {
  hk_run *run = context;
  const hk_function *on_frame = &run->scene->on_frame;
  double t = run->state.t;
  size_t got = 0;
  hk_status status = hk_figures_take(&run->loop, &run->judgement, run);
  if (status == HK_OK && on_frame->call) status = on_frame->call(on_frame, run, &t, 1, NULL, 0, &got, &run->error);
  for (size_t k = 0; k < run->outputs_open && status == HK_OK; k++)
    status = call_output(run, run->plugins.kind[HK_OUTPUT].item[k]);
  if (status == HK_OK) status = hk_measures_write(run->measures, t, &run->judgement.last_frame, &run->error);
  if (run->options.kept) run->options.kept(run->options.kept_context, &run->judgement.last_good, &run->state);
  hk_progress_show(&run->progress, &run->loop, &run->judgement.last_frame);
  return status;
}
