/* The scene of a run, run again with other options: refined, perturbed, or with another method. */
#include "core/engine/contract/contract.h"
#include "core/numerics/step_choice/step_choice.h"
#include "core/run/run/run.h"

#include <string.h>

static const double perturbation = 1e-14;

hk_run_options hk_comparison_run_options(const hk_run_options *first, uint64_t seed) {
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
    const hk_approximation_facet *f = &hk_force_of(force->plugin)->approximation;
    if (f->sharpen) f->sharpen(force->self, 1 / (2 * (double)refine));
    hk_leave(force, outer);
  }
}

static hk_status advance(hk_run *again, double t, hk_error *error) {
  bool implicit = again->loop.method->flags & HK_IMPLICIT;
  if (implicit && !(again->step->spectrum.w_max > 0))
    hk_step_estimate(again->step, &again->dynamics); /* implicit runs have no estimate yet */
  hk_error_clear(&again->error);
  hk_status status = hk_run_advance(again, t, error);
  hk_judgement *j = &again->judgement;
  return status == HK_OK ? hk_trajectory_note(&j->trajectory, &again->state, again->record.frames, true, error)
                         : status;
}

/* NULL: the scripts have described the same; otherwise what differs. (Where particles differ, so do trajectories.) */
static const char *difference(const hk_scene *a, const hk_scene *b) {
  const hk_particles *p = &a->particles, *q = &b->particles;
  if (p->n != q->n) return "it has other particles";
  if (p->channels != q->channels) return "it has other channels";
  for (size_t k = 0; k < p->channels; k++)
    if (strcmp(p->channel[k].name, q->channel[k].name) != 0 || p->channel[k].size != q->channel[k].size)
      return "it has other channels";
  static const hk_kind kinds[] = {HK_FORCE, HK_CONSTRAINT, HK_CORRECTOR, HK_SOURCE};
  for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
    const hk_specs *f = &a->plugin[kinds[i]], *g = &b->plugin[kinds[i]];
    if (f->count != g->count) return "it has other forces, constraints, correctors or sources";
    for (size_t k = 0; k < f->count; k++)
      if (strcmp(f->item[k]->label, g->item[k]->label) != 0)
        return "it has other forces, constraints, correctors or sources";
  }
  return NULL;
}

static hk_status require_same(const hk_run *whole, const hk_run *again, hk_error *error) {
  const char *what = difference(whole->scene, again->scene);
  if (!what) return HK_OK;
  hk_warn(
      whole->loop.warnings,
      "the script describes another scene when it is run again (%s), so this run is compared with no other: a script "
      "must do the same each time",
      what);
  return hk_error_set(error, HK_BAD_PARAM, "the script describes another scene when it is run again: %s", what);
}

static void note_spectrum(hk_comparison_run *found, const hk_spectrum *s) {
  found->swings = s->w_reached;
  found->fastest = s->w_max;
  found->damped = hk_spectrum_floor(s, s->w_max);
  found->damping = s->g_max;
}

hk_status hk_comparison_run_take(const hk_scene_loader *loader, const hk_run_options *options, const hk_run *whole,
                                 double until, hk_comparison_run *found, hk_error *error) {
  hk_run *again = NULL;
  hk_summary summary;
  hk_run_options o = *options;
  o.resume = NULL; /* runs are compared as a whole */
  *found = (hk_comparison_run){.energy_defect = NAN, .step = NAN};
  hk_status status = loader->open(loader->context, &o, &again, error);
  if (status == HK_OK) status = require_same(whole, again, error);
  if (status == HK_OK) sharpen(again, options->refine);
  if (status == HK_OK) status = advance(again, until, error);
  if (status == HK_OK) {
    hk_run_summary(again, &summary);
    note_spectrum(found, &again->step->spectrum);
    found->energy_defect = hk_energy_defect(&summary);
    found->kinetic = summary.kinetic_max;
    found->step = summary.dt_max / whole->record.dt_max;
  }
  if (again) {
    found->steps = again->record.steps + again->record.rejected;
    found->reach = again->record.reach;
    found->missed = hk_missed_encounters_error(&again->loop);
    found->tol = again->dynamics.system.tol;
    found->trajectory = again->judgement.trajectory;
    again->judgement.trajectory = (hk_trajectory){0};
    hk_run_close(again, error);
  }
  loader->close(loader->context, again);
  return status;
}
