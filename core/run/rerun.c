/* The scene of a run, run again with other options: refined, perturbed, or with another method. */
#include "core/run/run.h"

static const double perturbation = 1e-14;

hk_run_options hk_rerun_options(const hk_run_options *first, uint64_t seed) {
  hk_run_options o = *first;
  o.perturb = perturbation;
  o.perturb_seed = seed;
  o.compare = HK_COMPARE_ALWAYS;
  o.no_output = o.bare = true;
  o.progress = -1;
  o.kept = NULL;
  return o;
}

double hk_energy_defect(const hk_summary *s) { return s->energy_drift * s->kinetic_max; }

/* Errors of forces shrink with the steps, or both runs would have them in common. */
static void sharpen(hk_run *again, size_t refine) {
  const hk_instances *forces = &again->plugins.kind[HK_FORCE];
  for (size_t k = 0; k < forces->count && refine > 0; k++) {
    const hk_instance *force = forces->item[k], *outer = hk_enter(force);
    if (force->plugin->force->sharpen) force->plugin->force->sharpen(force->self, 1 / (2 * (double)refine));
    hk_leave(force, outer);
  }
}

static hk_status advance(hk_run *again, double t, hk_error *error) {
  bool implicit = again->step.method->flags & HK_IMPLICIT;
  if (implicit && !(again->step.spectrum.w_max > 0))
    hk_step_estimate(&again->step, &again->dynamics); /* implicit runs have no estimate yet */
  hk_error_clear(&again->error);
  hk_status status = hk_run_advance(again, t, error);
  hk_judgement *j = &again->judgement;
  return status == HK_OK ? hk_trajectory_note(&j->trajectory, &again->state, again->record.frames, true, error)
                         : status;
}

hk_status hk_rerun_take(const hk_reopen *reopen, const hk_run_options *options, const hk_run *whole, double until,
                        hk_rerun *found, hk_error *error) {
  hk_run *again = NULL;
  hk_summary summary;
  hk_run_options o = *options;
  o.resume = NULL; /* runs are compared as a whole */
  *found = (hk_rerun){.energy_defect = NAN, .step = NAN};
  hk_status status = reopen->open(reopen->context, &o, &again, error);
  if (status == HK_OK) sharpen(again, options->refine);
  if (status == HK_OK) status = advance(again, until, error);
  if (status == HK_OK) {
    hk_run_summary(again, &summary);
    found->spectrum = again->step.spectrum;
    found->energy_defect = hk_energy_defect(&summary);
    found->kinetic = summary.kinetic_max;
    found->step = summary.dt_max / whole->record.dt_max;
    found->passed_by = hk_passed_by_error(&again->loop);
    found->tol = again->dynamics.system.tol;
    found->trajectory = again->judgement.trajectory;
    again->judgement.trajectory = (hk_trajectory){0};
  }
  if (again) hk_run_close(again, error);
  reopen->close(reopen->context, again);
  return status;
}
