/* Opening and closing a run. Opening builds from the inside out: state, pins, plugins, constraints, step, outputs;
 * whatever was built when something fails is taken down by hk_run_destroy, which therefore accepts a half-built run. */
#include "core/run/engine.h"
#include "core/base/memory.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void take_warning(hk_shared *shared, const char *text) { hk_run_warn(shared->context, "%s", text); }

static hk_status start_threads(hk_run *run) {
  hk_scene *scene = run->scene;
  long online = sysconf(_SC_NPROCESSORS_ONLN);
  int threads = scene->threads > 0 ? scene->threads : online > 0 ? (int)online : 1;
  if (!scene->shared.threads) scene->shared.threads = hk_threads_create(threads);
  if (!scene->shared.threads) return hk_error_set(&run->error, HK_FAILED, "cannot start %d threads", threads);
  scene->shared.error = &run->error;
  scene->shared.seed = scene->seed;
  scene->shared.warn = take_warning;
  return HK_OK;
}

static hk_status start_instance(hk_run *run, hk_instance *instance) {
  hk_view view = run->view;
  view.host = &instance->host;
  hk_status status = hk_instance_select(instance, &run->model, &run->error);
  if (status == HK_OK) status = hk_instance_set_time(instance, run->system.t, &run->error);
  view.active = instance->active;
  view.is_active = instance->is_active;
  if (instance->is_active) view.acting = instance->acting;
  return status == HK_OK ? hk_instance_start(instance, &view, run->system.size, &run->error) : status;
}

static hk_status start_list(hk_run *run, const hk_instances *list) {
  hk_status status = HK_OK;
  for (size_t k = 0; k < list->count && status == HK_OK; k++) status = start_instance(run, list->item[k]);
  return status;
}

static hk_status check_groups(hk_run *run) {
  for (size_t k = 0; k < run->scene->force.count; k++) {
    const hk_instance *force = run->scene->force.item[k];
    bool found = !force->group;
    for (size_t g = 0; g < run->scene->groups && !found; g++)
      found = strcmp(run->scene->group_name[g], force->group) == 0;
    if (!found)
      return hk_error_set(&run->error, HK_BAD_PARAM, "%s: %s: group: no particle is in a group '%s'", force->where,
                          force->label, force->group);
  }
  return HK_OK;
}

static hk_status start_plugins(hk_run *run) {
  hk_scene *scene = run->scene;
  hk_status status = check_groups(run);
  if (status == HK_OK) status = start_list(run, &scene->force);
  hk_state_view(run); /* selections are known now */
  if (status == HK_OK) status = start_list(run, &scene->constraint);
  if (status == HK_OK) status = start_list(run, &scene->corrector);
  if (status == HK_OK) status = start_list(run, &scene->source);
  if (status == HK_OK) status = start_instance(run, scene->integrator);
  if (status == HK_OK && !run->options.no_output) status = start_list(run, &scene->output);
  if (status == HK_OK) hk_elements_refresh(run);
  return status;
}

static hk_status open_outputs(hk_run *run) {
  hk_status status = hk_measures_open(run);
  size_t count = run->options.no_output ? 0 : run->scene->output.count;
  while (status == HK_OK && run->outputs_open < count) {
    hk_instance *output = run->scene->output.item[run->outputs_open];
    hk_view view = run->view;
    view.host = &output->host;
    if (output->plugin->output->open) status = output->plugin->output->open(output->self, &view, &run->last_frame);
    if (status == HK_OK) run->outputs_open++;
  }
  return status;
}

static hk_status show_start(hk_run *run) {
  if (run->resumed) return open_outputs(run);
  hk_status status = hk_frame_figures(run, &run->last_frame); /* an output's open sees the figures of the start */
  if (status == HK_OK) status = open_outputs(run);
  return status == HK_OK ? hk_loop_frame(run) : status;
}

static hk_status build(hk_run *run) {
  hk_scene *scene = run->scene;
  hk_status status = start_threads(run);
  if (status == HK_OK) status = hk_overrides_apply(run);
  if (status == HK_OK) status = hk_folder_open(run);
  if (status == HK_OK) status = hk_state_open(run);
  if (status == HK_OK) status = hk_system_open(run);
  if (status == HK_OK) status = start_plugins(run);
  if (status == HK_OK && scene->constraint.count) status = hk_constraints_open(run);
  if (status == HK_OK && scene->start_file) status = hk_state_start_file(run);
  if (status != HK_OK) return status;
  for (size_t k = 0; k < scene->force.count; k++)
    run->force_acts[k] = run->system.t >= scene->force.item[k]->from && run->system.t < scene->force.item[k]->to;
  hk_state_view(run);
  hk_elements_refresh(run);
  if (run->options.perturb > 0) hk_state_perturb(run);
  status = hk_pins_impose(run, run->system.t, run->X, run->X + 3 * run->model.n);
  if (status == HK_OK && run->constraints && !run->resumed)
    status = hk_constraints_project(run, run->system.t, run->X, run->X + 3 * run->model.n);
  run->measure = calloc(scene->measures + 1, sizeof *run->measure);
  run->measure_name = calloc(scene->measures + 1, sizeof *run->measure_name);
  if (!run->measure || !run->measure_name) return hk_error_set(&run->error, HK_NO_MEMORY, "no memory for the measures");
  for (size_t k = 0; k < scene->measures; k++) run->measure_name[k] = scene->measure[k].name;
  run->last_frame.measures = scene->measures;
  run->last_frame.measure_name = run->measure_name;
  run->last_frame.measure = run->measure;
  if (status == HK_OK) status = hk_step_choose(run);
  return status == HK_OK ? show_start(run) : status;
}

hk_status hk_run_open(hk_scene *scene, const hk_run_options *options, hk_run **made, hk_error *error) {
  hk_run *run = calloc(1, sizeof *run);
  if (!run) return hk_error_set(error, HK_NO_MEMORY, "no memory for a run");
  run->opened_at = run->progress_at = hk_clock();
  run->scene = scene;
  run->options = *options;
  run->end = isnan(options->until) ? scene->duration : options->until;
  run->dt_limit = run->limit_now = NAN;
  run->dt_min = INFINITY;
  scene->run = run;
  hk_status status = build(run);
  if (status != HK_OK) {
    hk_error_set(error, status, "%s", run->error.text);
    hk_run_close(run, NULL);
    hk_run_destroy(run);
    return status;
  }
  *made = run;
  return HK_OK;
}

hk_status hk_run_advance(hk_run *run, double t, hk_error *error) {
  if (run->closed || run->verdict != HK_RUNNING) return hk_error_set(error, HK_FAILED, "this run has ended");
  hk_status status = hk_loop_to(run, t);
  if (status == HK_NOT_FINITE || status == HK_NOT_CONVERGED) {
    hk_diagnose(run, status);
    run->verdict = HK_DIVERGED;
    return hk_error_set(error, status, "%s", run->reason);
  }
  if (status != HK_OK) {
    run->verdict = HK_STOPPED;
    snprintf(run->reason, sizeof run->reason, "%s", run->error.text);
    hk_error_set(error, status, "%s", run->error.text);
  }
  return status;
}

hk_status hk_run_close(hk_run *run, hk_error *error) {
  if (run->closed) return HK_OK;
  run->closed = true;
  hk_status first = HK_OK;
  run->error = (hk_error){0};
  if (run->verdict == HK_RUNNING && run->first_step_at > 0) hk_judge(run);
  double begin = hk_clock();
  for (size_t k = 0; k < run->outputs_open; k++) {
    hk_instance *output = run->scene->output.item[k];
    double start = hk_clock();
    hk_status status =
        output->plugin->output->close ? output->plugin->output->close(output->self, run->verdict) : HK_OK;
    output->seconds += hk_clock() - start;
    if (first == HK_OK) first = status;
  }
  hk_status status = hk_measures_close(run);
  if (first == HK_OK) first = status;
  run->output_s += hk_clock() - begin;
  hk_progress(run, true);
  return first == HK_OK ? HK_OK : hk_error_set(error, first, "%s", run->error.text);
}

void hk_run_destroy(hk_run *run) {
  if (!run) return;
  hk_constraints_close(run);
  hk_jacobian_close(run);
  hk_pins_close(run);
  hk_system_close(run);
  hk_under_resolved_close(run);
  hk_folder_close(run);
  hk_state_close(run);
  hk_snapshot_free(&run->last_good);
  for (size_t k = 0; k < run->warnings; k++) free(run->warning[k]);
  free(run->warning);
  free(run->measure);
  free(run->measure_name);
  free(run->x_before);
  free(run->plugin_time);
  hk_threads_destroy(run->scene->shared.threads);
  run->scene->shared.threads = NULL;
  run->scene->shared.error = NULL;
  run->scene->run = NULL;
  free(run);
}

const hk_view *hk_run_view(hk_run *run) { return &run->view; }
double hk_run_end(const hk_run *run) { return run->end; }

double hk_run_measure(const hk_run *run, const char *name) {
  for (size_t k = 0; k < run->scene->measures; k++)
    if (strcmp(run->measure_name[k], name) == 0) return run->measure[k];
  return NAN;
}

hk_status hk_run_energy(hk_run *run, double *kinetic, double *potential, double *work) {
  *kinetic = hk_system_kinetic(run, run->X);
  *potential = hk_system_potential(run, run->system.t, run->X);
  *work = run->X[run->system.size - 1];
  return HK_OK;
}

static const char *force_label(const void *context, size_t k) {
  const hk_run *run = context;
  return k < run->scene->force.count ? run->scene->force.item[k]->label : NULL;
}

static hk_status no_force(hk_run *run, const char *label, hk_error *error) {
  const char *near = hk_nearest_name(label, force_label, run);
  if (near) return hk_error_set(error, HK_BAD_PARAM, "there is no force '%s'; did you mean '%s'?", label, near);
  return hk_error_set(error, HK_BAD_PARAM, "there is no force '%s'", label);
}

hk_status hk_run_force(hk_run *run, const char *label, uint32_t id, double force[3], hk_error *error) {
  uint32_t index;
  size_t k = 0, n = run->model.n;
  while (k < run->scene->force.count && strcmp(run->scene->force.item[k]->label, label) != 0) k++;
  if (k == run->scene->force.count) return no_force(run, label, error);
  if (!hk_run_index(run, id, &index)) return hk_error_set(error, HK_BAD_PARAM, "there is no particle %u", id);
  double *F = calloc(3 * n, sizeof *F);
  if (!F) return hk_error_set(error, HK_NO_MEMORY, "no memory for the forces");
  hk_view view = run->force_view[k];
  view.t = run->system.t;
  view.x = run->X;
  view.v = run->X + 3 * n;
  view.y = run->view.y;
  view.power = NULL;
  hk_instance *instance = run->scene->force.item[k];
  hk_status status = run->force_acts[k] ? instance->plugin->force->add(instance->self, &view, F) : HK_OK;
  if (status != HK_OK) hk_error_set(error, status, "%s", run->error.text);
  memcpy(force, F + 3 * index, 3 * sizeof *force);
  free(F);
  return status;
}

hk_status hk_run_strain(hk_run *run, const char *label, double *largest, hk_error *error) {
  bool found;
  *largest = hk_strain_largest(run, label, &found);
  return found ? HK_OK : no_force(run, label, error);
}
