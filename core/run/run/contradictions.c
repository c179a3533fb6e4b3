/* What two runs of one method can have in common, so that they agree and are both wrong: swings that the method damps.
 */
#include "core/run/run/comparison.h"

static const double rounding = 1e-9, resolved = 1; /* h w of swings that steps h resolve */

/* The energy defect in J of a step of length 0, extrapolated from the two runs with an error proportional to
 * step^order. */
static double converged_defect_of_order(const hk_summary *s, const hk_comparison_run *second, int order) {
  double error_ratio = pow(second->step, order);
  return fabs((second->energy_defect - error_ratio * hk_energy_defect(s)) / (1 - error_ratio));
}

static double converged_defect(const hk_run *run, const hk_summary *s, const hk_comparison_run *second) {
  return fmin(converged_defect_of_order(s, second, 1), converged_defect_of_order(s, second, run->loop.method->order));
}

/* The work of damping that acts within less than a step is integrated inaccurately, even where the motion is accurate.
 * Where the positions of both runs agree, and the energy defect is a part of the work done and vanishes with the step,
 * the defect is no evidence against the positions. Nor is it where less energy was lost than damping is said to have
 * taken. */
bool hk_comparison_energy_converges(const hk_comparison *c) {
  const hk_summary *s = c->summary;
  bool vanishes =
      fmin(converged_defect(c->whole, s, &c->half), fabs(c->half.energy_defect)) < hk_limit.visible * c->half.kinetic;
  double defect = hk_energy_defect(s);
  bool overcounted = defect > 0 && defect < -s->energy_work;
  return c->error <= 1 && fabs(defect) < 2 * fabs(s->energy_work) && (vanishes || overcounted);
}

static double free_mass(const hk_run *run) {
  double sum = 0;
  for (size_t i = 0; i < run->state.model.n; i++) sum += run->state.inverse_mass[i] > 0 ? run->state.mass[i] : 0;
  return sum;
}

/* The logarithm of what `steps` steps of h s leave of the amplitude of the fastest mode beyond its own damping; 0 where
 * the method does not state its growth. */
static double loss(const hk_run *run, const hk_comparison_run *half, double h, double steps) {
  const hk_integrator *m = run->loop.method;
  double w = half->fastest, g = half->damped;
  if (!m->growth || !(w > 0)) return 0;
  return steps * (log(m->growth(run->loop.integrator->self, m->method, h * w, h * g, 0)) + fmin(h * g / 2, h * w));
}

/* Whether numerical damping alone halves the amplitude of the fastest mode within the run. Methods that estimate their
 * errors are excluded: their error estimates include this damping. */
static bool damps_fastest_mode(const hk_run *run, const hk_summary *s, const hk_comparison_run *half) {
  return !(run->record.worst_error > 0) && loss(run, half, s->dt_max, (double)s->steps) < log(0.5);
}

/* An energy defect that such a method keeps with a step of length 0 was the energy of oscillations that both runs have
 * damped, so their positions agree although the oscillations are lost. The result is the displacement in m (RMS) of the
 * particles by the end of the run if this energy were kinetic. */
double hk_comparison_damped_energy(const hk_comparison *c) {
  const hk_run *run = c->whole;
  const hk_summary *s = c->summary;
  double defect = converged_defect(run, s, &c->half);
  double energy = fabs(s->energy_first) + fabs(s->energy_last) + s->kinetic_max;
  if (isnan(defect) || defect < rounding * energy || fabs(s->energy_work) > 0.5 * defect) return 0;
  return damps_fastest_mode(run, s, &c->half) ? sqrt(2 * defect / free_mass(run)) * s->t : 0;
}

bool hk_comparison_damped_modes(const hk_comparison *c) {
  const hk_run *run = c->whole;
  return run->loop.method->flags & HK_IMPLICIT && run->record.dt_max * c->half.swings > resolved;
}

bool hk_comparison_may_lose_swings(const hk_comparison *c) {
  return loss(c->whole, &c->half, c->summary->dt_max / 2, 2 * (double)c->summary->steps) < log(0.5);
}
