/* Advancing a run, closing it, and the queries about its state and results. */
#include "core/engine/text/text.h"
#include "core/numerics/constraints/constraints.h"
#include "core/run/run/run.h"

#include <stdlib.h>
#include <string.h>

hk_status hk_run_advance(hk_run *run, double t, hk_error *error) {
  hk_judgement *j = &run->judgement;
  if (run->closed || j->verdict != HK_RUNNING) return hk_error_set(error, HK_FAILED, "this run has ended");
  hk_status status = hk_loop_to(&run->loop, t);
  if (status == HK_NOT_FINITE || status == HK_NOT_CONVERGED) {
    hk_diagnose(&run->loop, j, status);
    j->verdict = HK_DIVERGED;
    return hk_error_set(error, status, "%s", j->reason);
  }
  if (status != HK_OK) {
    j->verdict = HK_STOPPED;
    snprintf(j->reason, sizeof j->reason, "%s", run->error.text);
    hk_error_set(error, status, "%s", run->error.text);
  }
  return status;
}

static sig_atomic_t interruptions(const hk_run *run) {
  return run->options.interrupted ? *run->options.interrupted : 0;
}

bool hk_run_interrupted_again(void *self) {
  const hk_run *run = self;
  return interruptions(run) > run->interruptions;
}

static hk_status close_outputs(hk_run *run) {
  hk_status first = HK_OK;
  run->interruptions = interruptions(run);
  for (size_t k = 0; k < run->outputs_open; k++) {
    hk_instance *output = run->plugins.kind[HK_OUTPUT].item[k];
    double begin = hk_clock();
    const hk_instance *outer = hk_enter(output);
    hk_status status =
        output->plugin->output->close ? output->plugin->output->close(output->self, run->judgement.verdict) : HK_OK;
    status = hk_leave_with(output, outer, "close", status);
    output->seconds += hk_clock() - begin;
    if (first == HK_OK) first = status;
  }
  hk_status status = hk_measures_close(&run->measures, &run->error);
  return first == HK_OK ? status : first;
}

hk_status hk_run_close(hk_run *run, hk_error *error) {
  if (run->closed) return HK_OK;
  run->closed = true;
  run->error = (hk_error){0};
  hk_status judged = HK_OK;
  if (run->judgement.verdict == HK_RUNNING && run->loop.first_step_at > 0)
    judged = hk_judge(&run->loop, &run->judgement, &run->asked);
  double begin = hk_clock();
  hk_status status = close_outputs(run);
  run->loop.output_seconds += hk_clock() - begin;
  hk_progress_end(&run->progress);
  if (judged != HK_OK) status = judged;
  return status == HK_OK ? HK_OK : hk_error_set(error, status, "%s", run->error.text);
}

void hk_run_summary(hk_run *run, hk_summary *s) { hk_summary_take(&run->loop, &run->judgement, &run->asked, s); }

hk_status hk_run_write_state(hk_run *run, const char *path, hk_error *error) {
  const hk_state *s = &run->state;
  hk_snapshot now = {.t = s->t, .n = s->model.n, .size = s->size, .X = s->X, .id = s->id, .mass = s->mass};
  const hk_snapshot *written = run->judgement.verdict == HK_DIVERGED ? &run->judgement.last_good : &now;
  return hk_state_table_write(written, s, path, error);
}

const hk_view *hk_run_view(hk_run *run) { return &run->state.view; }
double hk_run_end(const hk_run *run) { return run->asked.end; }

bool hk_run_index(const hk_run *run, uint32_t id, uint32_t *index) { return hk_state_index(&run->state, id, index); }

void hk_run_energy(hk_run *run, double *kinetic, double *potential, double *work) {
  const hk_state *s = &run->state;
  *kinetic = hk_state_kinetic(s, s->X);
  *potential = hk_query_potential(&run->dynamics, s->t, s->X);
  *work = hk_loop_work(s, &run->record);
}

/* ---- forces of one plugin: of a force, or of a constraint ---- */

static const char *label_at(const void *context, size_t k) {
  const hk_instances *list = context;
  return k < list->count ? list->item[k]->label : NULL;
}

/* The number of instances: no one has the label. */
static size_t labelled(const hk_instances *list, const char *label) {
  size_t k = 0;
  while (k < list->count && strcmp(list->item[k]->label, label) != 0) k++;
  return k;
}

static hk_status no_label(const hk_run *run, hk_kind kind, const char *label, hk_error *error) {
  const char *what = kind == HK_FORCE ? "force" : "constraint";
  const char *near = hk_nearest_name(label, label_at, &run->plugins.kind[kind]);
  if (near) return hk_error_set(error, HK_BAD_PARAM, "there is no %s '%s'; did you mean '%s'?", what, label, near);
  return hk_error_set(error, HK_BAD_PARAM, "there is no %s '%s'", what, label);
}

static hk_status no_memory(hk_error *error) { return hk_error_set(error, HK_NO_MEMORY, "no memory for the forces"); }

/* Impulses are given between steps, and no multiplier of a state carries those of a corrector that does not tell them.
 */
static void warn_of_impulses(hk_run *run) {
  const hk_instances *correctors = &run->plugins.kind[HK_CORRECTOR];
  for (size_t k = 0; k < correctors->count; k++) {
    const hk_instance *c = correctors->item[k];
    if (!(c->plugin->corrector->flags & HK_TAKES_BODIES) || c->plugin->corrector->mean_forces) continue;
    hk_warn(&run->warnings,
            "%s%s'%s' presses by impulses, which the forces of constraints that are asked for do not contain: while it "
            "touches what they join, they are too small; a force that keeps apart in its place is contained",
            c->spec->where, *c->spec->where ? ": " : "", c->label);
  }
}

/* Those of all equations, to be freed; NULL: the error is set. */
static double *multipliers(hk_run *run, hk_error *error) {
  warn_of_impulses(run);
  size_t begin, all;
  hk_constraint_range(&run->dynamics, run->plugins.kind[HK_CONSTRAINT].count - 1, &begin, &all);
  double *lambda = malloc((all + 1) * sizeof *lambda);
  if (!lambda) {
    no_memory(error);
    return NULL;
  }
  hk_error before = run->error;
  hk_status status = hk_constraint_multipliers(&run->dynamics, lambda);
  if (status != HK_OK) *error = run->error;
  run->error = before;
  if (status == HK_OK) return lambda;
  free(lambda);
  return NULL;
}

static hk_status force_of_constraint(hk_run *run, size_t k, uint32_t index, double force[3], hk_error *error) {
  double *lambda = multipliers(run, error);
  if (!lambda) return error->status;
  hk_constraint_force_on(&run->dynamics, k, lambda, index, force);
  free(lambda);
  return HK_OK;
}

hk_status hk_run_forces(hk_run *run, size_t k, double *force, hk_error *error) {
  size_t n = run->state.model.n;
  memset(force, 0, 3 * n * sizeof *force);
  if (!run->dynamics.force_acts[k] || hk_query_force(&run->dynamics, k, run->state.X, n, force)) return HK_OK;
  return hk_error_set(error, HK_FAILED, "the force '%s' failed", run->plugins.kind[HK_FORCE].item[k]->label);
}

static hk_status force_of_force(hk_run *run, size_t k, uint32_t index, double force[3], hk_error *error) {
  double *F = malloc(3 * run->state.model.n * sizeof *F);
  if (!F) return no_memory(error);
  hk_status status = hk_run_forces(run, k, F, error);
  memcpy(force, F + 3 * index, 3 * sizeof *force);
  free(F);
  return status;
}

hk_status hk_run_force(hk_run *run, const char *label, uint32_t id, double force[3], hk_error *error) {
  const hk_instances *forces = &run->plugins.kind[HK_FORCE], *constraints = &run->plugins.kind[HK_CONSTRAINT];
  size_t k = labelled(forces, label), constraint = labelled(constraints, label);
  uint32_t index;
  if (k == forces->count && constraint == constraints->count) return no_label(run, HK_FORCE, label, error);
  if (!hk_run_index(run, id, &index)) return hk_error_set(error, HK_BAD_PARAM, "there is no particle %u", id);
  return k < forces->count ? force_of_force(run, k, index, force, error)
                           : force_of_constraint(run, constraint, index, force, error);
}

hk_status hk_run_equations(hk_run *run, const char *label, size_t *count, hk_error *error) {
  const hk_instances *constraints = &run->plugins.kind[HK_CONSTRAINT];
  size_t k = labelled(constraints, label), begin, end;
  if (k == constraints->count) return no_label(run, HK_CONSTRAINT, label, error);
  hk_constraint_range(&run->dynamics, k, &begin, &end);
  *count = end - begin;
  return HK_OK;
}

hk_status hk_run_constraint_forces(hk_run *run, const char *label, double *force, hk_error *error) {
  const hk_instances *constraints = &run->plugins.kind[HK_CONSTRAINT];
  size_t k = labelled(constraints, label), begin, end;
  if (k == constraints->count) return no_label(run, HK_CONSTRAINT, label, error);
  double *lambda = multipliers(run, error);
  if (!lambda) return error->status;
  hk_constraint_range(&run->dynamics, k, &begin, &end);
  memcpy(force, lambda + begin, (end - begin) * sizeof *force);
  free(lambda);
  return HK_OK;
}

hk_status hk_run_bar_forces(hk_run *run, const hk_pair_forces *into, hk_error *error) {
  if (run->plugins.kind[HK_CONSTRAINT].count == 0) return HK_OK;
  double *lambda = multipliers(run, error);
  if (!lambda) return error->status;
  hk_constraint_bar_forces(&run->dynamics, lambda, into);
  free(lambda);
  return HK_OK;
}

hk_status hk_run_strain(hk_run *run, const char *label, double *largest, hk_error *error) {
  bool found;
  *largest = hk_query_strain(&run->dynamics, label, &found);
  if (found) return HK_OK;
  if (label) return no_label(run, HK_FORCE, label, error);
  return hk_error_set(error, HK_BAD_PARAM, "no force of the scene has elements that could be strained");
}
