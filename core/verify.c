#include "core/verify.h"
#include "core/engine.h"

#include <string.h>

static const double disturbance = 1e-10, margin = 2;

static double difference(hk_run *a, hk_run *b) {
  size_t n = a->model.n;
  double sum = 0;
  if (n == 0 || b->model.n != n || memcmp(a->id, b->id, n * sizeof *a->id) != 0) return NAN;
  for (size_t k = 0; k < 3 * n; k++) sum += (a->X[k] - b->X[k]) * (a->X[k] - b->X[k]);
  return sqrt(sum / (double)n);
}

/* The same step, refined; where an adaptive method was given one, it may take it for a fixed step. */
static hk_run_options finer(const hk_run *whole, const hk_run_options *first) {
  hk_run_options o = *first;
  double given = isnan(first->dt) ? whole->scene->dt : first->dt;
  bool adaptive = whole->method->flags & HK_ADAPTIVE;
  o.dt = adaptive ? given / 2 : given;
  o.tol = whole->system.tol / 10;
  o.refine = true;
  o.dt_most = whole->dt_max / 2;
  o.step_limit *= 4;
  o.disturb = disturbance;
  o.disturb_seed = 1;
  o.no_output = true;
  o.progress = -1;
  return o;
}

/* *gone: the energy that the second run has lost or gained, J. */
static hk_status run_again(const char *path, const hk_script_options *options, const hk_run_options *run, hk_run *whole,
                           double *found, double *gone, hk_error *error) {
  hk_script_options script_options = *options;
  hk_run_options fine = finer(whole, run);
  hk_script *script = NULL;
  hk_run *again = NULL;
  hk_summary second;
  script_options.run = &fine;
  hk_status status = hk_script_open(path, &script_options, &script, error);
  if (status == HK_OK) status = hk_run_open(hk_script_scene(script), &fine, &again, error);
  if (status == HK_OK) status = hk_run_advance(again, whole->system.t, error);
  if (status == HK_OK) {
    hk_run_summary(again, &second);
    *found = difference(whole, again);
    *gone = second.energy_drift * second.kinetic_max;
  }
  if (again) hk_run_close(again, error);
  hk_run_destroy(again);
  hk_script_close(script);
  return status;
}

static void add_reason(hk_summary *s, bool blind) {
  char why[400];
  size_t used = strlen(s->reason);
  if (isnan(s->verify_difference))
    snprintf(why, sizeof why, "the accuracy asked for, %g m, could not be checked", s->accuracy);
  else if (margin * s->verify_difference > s->accuracy)
    snprintf(why, sizeof why,
             "half the step from a start that is off by 1e-10 of the extent ends %.3g m away: the accuracy asked for, "
             "%g m, is not reached",
             s->verify_difference, s->accuracy);
  else if (!blind && s->exact_error > s->accuracy)
    snprintf(why, sizeof why, "the error of %.3g m is above the accuracy asked for, %g m", s->exact_error, s->accuracy);
  else
    return;
  snprintf(s->reason + used, sizeof s->reason - used, "%s%s", used ? "; " : "", why);
  s->verdict = HK_INACCURATE;
}

/* Damping that acts within less than a step is summed badly, whatever the motion: where the positions hold and what is
 * missing of the energy, a part of the work done, shrinks with the step, it says nothing about them. */
static bool settles(const hk_summary *s, double second) {
  double gone = fabs(s->energy_drift * s->kinetic_max);
  return margin * s->verify_difference <= s->accuracy && gone < 2 * fabs(s->energy_work) && fabs(second) < 0.6 * gone;
}

hk_status hk_verify(const char *path, const hk_script_options *options, const hk_run_options *run, hk_run *whole,
                    hk_summary *s, hk_error *error) {
  double found = NAN, gone = NAN;
  bool judged = s->verdict == HK_VERDICT_OK || s->verdict == HK_INACCURATE;
  hk_status status = run_again(path, options, run, whole, &found, &gone, error);
  s->verify_difference = found;
  if (!judged || !(s->accuracy > 0) || status == HK_INTERRUPTED) return status;
  whole->energy_settles = settles(s, gone);
  hk_judge(whole);
  hk_run_summary(whole, s);
  s->verify_difference = found;
  add_reason(s, run->blind);
  return status;
}
