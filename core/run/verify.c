/* Checking a run by a second, finer run: the method is described in run.h. */
#include "core/run/run.h"

#include <string.h>

enum { FINER_REFINEMENT = 16 };
static const double perturbation = 1e-10, margin = 2, rounding = 1e-9,
                    visible = 0.1; /* of the kinetic energy, as in verdict.c */

static double difference(hk_run *a, hk_run *b) {
  size_t n = a->state.model.n;
  double sum = 0;
  if (n == 0 || b->state.model.n != n || memcmp(a->state.id, b->state.id, n * sizeof *a->state.id) != 0) return NAN;
  for (size_t k = 0; k < 3 * n; k++) sum += (a->state.X[k] - b->state.X[k]) * (a->state.X[k] - b->state.X[k]);
  return sqrt(sum / (double)n);
}

/* The options of the second run: the same dt with the refined division of frames, finer still where a function of time
 * changes between the steps. An adaptive method gets half of a dt that was given, which it may use as a fixed step. */
static hk_run_options finer(hk_run *whole, const hk_run_options *first) {
  hk_run_options o = *first;
  double given = isnan(first->dt) ? whole->scene->dt : first->dt;
  bool adaptive = whole->step.method->flags & HK_ADAPTIVE;
  o.dt = adaptive ? given / 2 : given;
  o.tol = whole->dynamics.system.tol / 10;
  o.refine = hk_varies_between_steps(&whole->loop) ? FINER_REFINEMENT : 1;
  o.dt_most = whole->record.dt_max / (2 * (double)o.refine);
  o.step_limit *= 4 * o.refine;
  o.perturb = perturbation;
  o.perturb_seed = 1;
  o.no_output = true;
  o.progress = -1;
  return o;
}

/* The energy drift in J, an excess being positive. */
static double energy_defect(const hk_summary *s) { return s->energy_drift * s->kinetic_max; }

typedef struct second_run {
  double difference;    /* m, RMS of the positions */
  double energy_defect; /* J, see energy_defect() */
  double kinetic;       /* J, the largest kinetic energy */
  double step;          /* longest step relative to that of the first run */
  hk_spectrum spectrum;
} second_run;

static hk_status run_again(const hk_reopen *reopen, const hk_run_options *run, hk_run *whole, second_run *found,
                           hk_error *error) {
  hk_run_options fine = finer(whole, run);
  hk_run *again = NULL;
  hk_summary second;
  hk_status status = reopen->open(reopen->context, &fine, &again, error);
  if (status == HK_OK && !(again->step.spectrum.w_max > 0))
    hk_step_estimate(&again->step, &again->dynamics); /* implicit runs have no estimate yet */
  if (status == HK_OK) found->spectrum = again->step.spectrum;
  if (status == HK_OK) status = hk_run_advance(again, whole->state.t, error);
  if (status == HK_OK) {
    hk_run_summary(again, &second);
    found->difference = difference(whole, again);
    found->energy_defect = energy_defect(&second);
    found->kinetic = second.kinetic_max;
    found->step = second.dt_max / whole->record.dt_max;
  }
  if (again) hk_run_close(again, error);
  reopen->close(reopen->context, again);
  return status;
}

static void add_reason(hk_summary *s, double displacement, bool ignore_exact) {
  char why[400];
  size_t used = strlen(s->reason);
  if (isnan(s->verify_difference))
    snprintf(why, sizeof why, "the accuracy asked for, %g m, could not be checked", s->accuracy);
  else if (margin * s->verify_difference > s->accuracy)
    snprintf(why, sizeof why,
             "half the step from a start that is off by 1e-10 of the extent ends %.3g m away: the accuracy asked for, "
             "%g m, is not reached",
             s->verify_difference, s->accuracy);
  else if (displacement > s->accuracy)
    snprintf(
        why, sizeof why,
        "the steps damp fast swings, whose energy is missing with half the step, too: as a speed it would have taken "
        "the particles %.3g m by the end, above the accuracy asked for, %g m",
        displacement, s->accuracy);
  else if (!ignore_exact && s->exact_error > s->accuracy)
    snprintf(why, sizeof why, "the error of %.3g m is above the accuracy asked for, %g m", s->exact_error, s->accuracy);
  else
    return;
  snprintf(s->reason + used, sizeof s->reason - used, "%s%s", used ? "; " : "", why);
  s->verdict = HK_INACCURATE;
  s->verdict_name = hk_verdict_name(s->verdict);
}

/* The energy defect in J of a step of length 0, extrapolated from the two runs with an error proportional to
 * step^order. */
static double converged_defect_of_order(const hk_summary *s, const second_run *second, int order) {
  double error_ratio = pow(second->step, order);
  return fabs((second->energy_defect - error_ratio * energy_defect(s)) / (1 - error_ratio));
}

static double converged_defect(const hk_run *run, const hk_summary *s, const second_run *second) {
  return fmin(converged_defect_of_order(s, second, 1), converged_defect_of_order(s, second, run->step.method->order));
}

/* The work of damping that acts within less than a step is integrated inaccurately, even where the motion is accurate.
 * Where the positions of both runs agree, and the energy defect is a part of the work done and vanishes with the step,
 * the defect is no evidence against the positions. */
static bool energy_converges(const hk_run *run, const hk_summary *s, const second_run *second) {
  bool defect_vanishes =
      fmin(converged_defect(run, s, second), fabs(second->energy_defect)) < visible * second->kinetic;
  return margin * s->verify_difference <= s->accuracy && fabs(energy_defect(s)) < 2 * fabs(s->energy_work) &&
         defect_vanishes;
}

static double free_mass(const hk_run *run) {
  double sum = 0;
  for (size_t i = 0; i < run->state.model.n; i++) sum += run->state.inverse_mass[i] > 0 ? run->state.mass[i] : 0;
  return sum;
}

/* Whether numerical damping alone halves the amplitude of the fastest mode within the run. Methods that estimate their
 * errors are excluded: their error estimates include this damping. */
static bool damps_fastest_mode(const hk_run *run, const hk_summary *s, const hk_spectrum *spectrum) {
  const hk_integrator *m = run->step.method;
  double h = s->dt_max, w = spectrum->w_max, g = hk_spectrum_floor(spectrum, w);
  if (run->record.worst_error > 0 || !m->amplification || !(w > 0)) return false;
  return (double)s->steps * (log(m->amplification(run->step.parameters, h * w, h * g)) + fmin(h * g / 2, h * w)) <
         log(0.5);
}

/* An energy defect that such a method keeps with a step of length 0 was the energy of oscillations that both runs have
 * damped, so their positions agree although the oscillations are lost. The result is the displacement in m (RMS) of the
 * particles by the end of the run if this energy were kinetic. */
static double lost_energy_displacement(const hk_run *run, const hk_summary *s, const second_run *second) {
  double defect = converged_defect(run, s, second);
  double energy = fabs(s->energy_first) + fabs(s->energy_last) + s->kinetic_max;
  if (isnan(defect) || defect < rounding * energy || fabs(s->energy_work) > 0.5 * defect) return 0;
  return damps_fastest_mode(run, s, &second->spectrum) ? sqrt(2 * defect / free_mass(run)) * s->t : 0;
}

hk_status hk_verify(const hk_reopen *reopen, const hk_run_options *run, hk_run *whole, hk_summary *s, hk_error *error) {
  second_run second = {.difference = NAN, .energy_defect = NAN, .step = NAN};
  bool judged = s->verdict == HK_VERDICT_OK || s->verdict == HK_INACCURATE;
  hk_status status = run_again(reopen, run, whole, &second, error);
  s->verify_difference = second.difference;
  if (!judged || !(s->accuracy > 0)) return status;
  whole->judgement.energy_converges = energy_converges(whole, s, &second);
  hk_judge(&whole->loop, &whole->judgement, &whole->asked);
  hk_run_summary(whole, s);
  s->verify_difference = second.difference;
  add_reason(s, lost_energy_displacement(whole, s, &second), run->ignore_exact);
  return status;
}
