/* The figures of a run, gathered once; summary_text.c and the JSON writer print the same ones. */
#include "core/run/engine.h"
#include "core/dynamics/constraint_matrix.h"

#include <stdlib.h>

static void add_time(hk_run *run, size_t *count, const hk_instance *instance) {
  if (!instance || !instance->started) return;
  double seconds = instance->seconds;
  if (instance->sampled && instance->calls > instance->sampled)
    seconds *= (double)instance->calls / (double)instance->sampled;
  run->plugin_time[(*count)++] =
      (hk_plugin_time){hk_kind_name(instance->plugin->kind), instance->plugin->name, instance->label, seconds};
}

static size_t plugin_times(hk_run *run) {
  const hk_scene *scene = run->scene;
  const hk_instances *lists[] = {&scene->force, &scene->constraint, &scene->corrector, &scene->source, &scene->output};
  size_t room = 2, count = 0;
  for (size_t l = 0; l < 5; l++) room += lists[l]->count;
  free(run->plugin_time);
  run->plugin_time = calloc(room, sizeof *run->plugin_time);
  if (!run->plugin_time) return 0;
  for (size_t l = 0; l < 5; l++)
    for (size_t k = 0; k < lists[l]->count; k++) add_time(run, &count, lists[l]->item[k]);
  double forces = 0;
  for (size_t k = 0; k < count; k++)
    if (run->plugin_time[k].kind == hk_kind_name(HK_FORCE)) forces += run->plugin_time[k].seconds;
  add_time(run, &count, scene->integrator);
  run->plugin_time[count - 1].seconds = fmax(0, run->loop_s - forces); /* what the steps cost beside the forces */
  add_time(run, &count, scene->solver);
  return count;
}

static double momentum_drift(const hk_run *run) {
  bool kept = run->pins == 0 && !run->corrected && !run->sourced && run->momentum_scale > 0;
  for (size_t k = 0; k < run->scene->force.count; k++)
    kept = kept && run->scene->force.item[k]->plugin->force->flags & HK_CONSERVES_MOMENTUM;
  if (!kept) return NAN;
  double sum = 0;
  for (int c = 0; c < 3; c++)
    sum +=
        (run->last_frame.momentum[c] - run->momentum_first[c]) * (run->last_frame.momentum[c] - run->momentum_first[c]);
  return sqrt(sum) / run->momentum_scale;
}

static void energies(hk_run *run, hk_summary *s) {
  double kinetic, potential;
  hk_run_energy(run, &kinetic, &potential, &s->energy_work);
  s->energy_first = run->energy_first;
  s->energy_last = kinetic + potential;
  s->kinetic_max = fmax(run->kinetic_max, kinetic);
  bool known = hk_system_has_energy(run) && !run->corrected && !run->sourced && s->kinetic_max > 0;
  s->energy_drift = known ? (s->energy_last - s->energy_first - s->energy_work) / s->kinetic_max : NAN;
  if (!hk_system_has_energy(run)) s->energy_work = NAN;
}

/* Constraints have an instance of the solver of their own. */
void hk_solver_libraries(const hk_run *run, char *text, size_t size) {
  const hk_instance *solver = run->scene->solver;
  if (!(solver && solver->started)) solver = run->constraints ? run->constraints->linear.solver : NULL;
  *text = 0;
  if (solver && solver->plugin->solver->describe) solver->plugin->solver->describe(solver->self, text, size);
}

void hk_run_summary(hk_run *run, hk_summary *s) {
  *s = (hk_summary){.scene = run->scene->name, .integrator = run->scene->integrator->plugin->name};
  s->verdict = run->verdict;
  if (run->scene->solver && run->scene->solver->started) s->solver = run->scene->solver->plugin->name;
  s->solver_chosen = run->solver_chosen;
  hk_solver_libraries(run, s->solver_libraries, sizeof s->solver_libraries);
  snprintf(s->reason, sizeof s->reason, "%s", run->reason);
  s->t = run->verdict == HK_DIVERGED ? run->last_good.t : run->system.t;
  s->end = run->end;
  s->fps = run->scene->fps;
  s->n = run->model.n;
  s->steps = run->steps;
  s->frames = run->frame;
  s->force_evaluations = run->evaluations;
  s->jacobian_evaluations = run->jacobians;
  s->factorizations = run->factorizations;
  s->linear_iterations = run->linear_iterations;
  s->dt_min = run->steps ? run->dt_min : NAN;
  s->dt_max = run->steps ? run->dt_max : NAN;
  s->dt_limit = run->dt_limit;
  s->dt_chosen = run->dt_chosen;
  s->start_wall_s = run->first_step_at > 0 ? run->first_step_at - run->opened_at : NAN;
  s->wall_s = hk_clock() - run->opened_at;
  s->step_wall_s = run->loop_s;
  energies(run, s);
  s->momentum_drift = momentum_drift(run);
  s->constraint_violation = run->violation_max;
  bool found;
  double now = hk_strain_largest(run, NULL, &found);
  s->max_strain = !found ? NAN : fabs(now) > fabs(run->strain_max) || !isfinite(now) ? now : run->strain_max;
  s->accuracy = isnan(run->options.accuracy) ? run->scene->accuracy : run->options.accuracy;
  if (!(s->accuracy > 0)) s->accuracy = NAN;
  s->exact_error = run->verdict == HK_DIVERGED ? NAN : hk_exact_error(run);
  s->verify_difference = NAN;
  s->plugins = plugin_times(run);
  s->plugin = run->plugin_time;
  s->measures = run->scene->measures;
  s->measure_name = run->measure_name;
  s->measure = run->measure;
  s->warnings = run->warnings;
  s->warning = run->warning;
}
