#include "core/verify.h"
#include "core/engine.h"

#include <string.h>

static const double disturbance = 1e-10;

static double difference(hk_run *a, hk_run *b) {
  size_t n = a->model.n;
  double sum = 0;
  if (n == 0 || b->model.n != n || memcmp(a->id, b->id, n * sizeof *a->id) != 0) return NAN;
  for (size_t k = 0; k < 3 * n; k++) sum += (a->X[k] - b->X[k]) * (a->X[k] - b->X[k]);
  return sqrt(sum / (double)n);
}

/* A fixed-step method halves; an adaptive one that was given a step may have taken it for a fixed one. */
static hk_run_options finer(const hk_run *whole, const hk_run_options *first) {
  hk_run_options o = *first;
  bool adaptive = whole->method->flags & HK_ADAPTIVE;
  double given = isnan(first->dt) ? whole->scene->dt : first->dt;
  o.dt = adaptive ? given / 2 : whole->dt_max / 2;
  o.tol = whole->system.tol / 10;
  o.step_limit *= 4;
  o.disturb = disturbance;
  o.disturb_seed = 1;
  o.no_output = true;
  o.progress = -1;
  return o;
}

static hk_status run_again(const char *path, const hk_script_options *options, const hk_run_options *run, hk_run *whole,
                           double *found, hk_error *error) {
  hk_script_options script_options = *options;
  hk_run_options fine = finer(whole, run);
  hk_script *script = NULL;
  hk_run *again = NULL;
  script_options.run = &fine;
  hk_status status = hk_script_open(path, &script_options, &script, error);
  if (status == HK_OK) status = hk_run_open(hk_script_scene(script), &fine, &again, error);
  if (status == HK_OK) status = hk_run_advance(again, whole->system.t, error);
  if (status == HK_OK) *found = difference(whole, again);
  if (again) hk_run_close(again, error);
  hk_run_destroy(again);
  hk_script_close(script);
  return status;
}

static void judge(hk_summary *s, bool blind) {
  char why[400];
  size_t used = strlen(s->reason);
  if (isnan(s->verify_difference))
    snprintf(why, sizeof why, "the accuracy asked for, %g m, could not be checked", s->accuracy);
  else if (2 * s->verify_difference > s->accuracy)
    snprintf(why, sizeof why,
             "half the step from a start that is off by 1e-10 of the extent ends %.3g m away: the "
             "accuracy asked for, %g m, is not reached",
             s->verify_difference, s->accuracy);
  else if (!blind && s->exact_error > s->accuracy)
    snprintf(why, sizeof why, "the error of %.3g m is above the accuracy asked for, %g m", s->exact_error, s->accuracy);
  else
    return;
  snprintf(s->reason + used, sizeof s->reason - used, "%s%s", used ? "; " : "", why);
  s->verdict = HK_INACCURATE;
}

hk_status hk_verify(const char *path, const hk_script_options *options, const hk_run_options *run, hk_run *whole,
                    hk_summary *s, hk_error *error) {
  hk_status status = run_again(path, options, run, whole, &s->verify_difference, error);
  bool judged = s->verdict == HK_VERDICT_OK || s->verdict == HK_INACCURATE;
  if (s->accuracy > 0 && judged && status != HK_INTERRUPTED) judge(s, run->blind);
  return status;
}
