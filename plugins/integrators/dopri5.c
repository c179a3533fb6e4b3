/* Dormand and Prince's embedded pair of order 5(4), with its own choice of the step.
 *
 * A step is accepted when its error (step_control.h) is at most `tol`. The length of the next step is computed from the
 * last two errors (Hairer, Norsett and Wanner, Solving ODEs I, II.4; Hairer and Wanner II, IV.2). The slope of the
 * seventh stage is that of the next step's first stage.
 *
 * For scenes of which nothing is known, as its error is its own choice, and as the reference of others. Where the step
 * is known others are cheaper: a curtain of 16 x 16 particles, 0.5 s to 1e-5 m, takes it 4,310 evaluations, rk4 2,400,
 * leapfrog 931 (hooke bench scripts/scenes/curtain.lua N=16 --until 0.5 --target 1e-5).
 */
#include "plugins/common/integrate/runge_kutta.h"
#include "plugins/common/integrate/step_control.h"

#include <float.h>
#include <string.h>

enum { STAGES = 7 };

static const double error_weight[STAGES] = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                            -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
/* Safety factor, bounds of the factor by which h changes, and the exponent of the PI control. */
static const double safety = 0.9, least = 0.2, most = 10, beta = 0.04;

typedef struct dopri5 {
  int64_t primed;    /* whether `first` is the slope at X */
  int64_t started;   /* whether a step has been taken */
  double proposal;   /* s, proposed length of the next step */
  double last_error; /* error of the last step, for the PI control */
  hk_scales scales;
  double *first; /* slope at X */
  double *k;     /* slopes, then the state of a stage */
  double *error; /* shaped as X */
} dopri5;

static const hk_field fields[] = {
    {"primed", .integer = HK_AT(dopri5, primed)},
    {"started", .integer = HK_AT(dopri5, started)},
    {"proposal", .number = HK_AT(dopri5, proposal)},
    {"last_error", .number = HK_AT(dopri5, last_error)},
    {"speed", .number = HK_AT(dopri5, scales.speed)},
    {"acceleration", .number = HK_AT(dopri5, scales.acceleration)},
    {"first", .state = HK_AT(dopri5, first), .width = 1},
    {"stages", .state = HK_AT(dopri5, k), .width = STAGES + 1, .flags = HK_SCRATCH},
    {"error", .state = HK_AT(dopri5, error), .width = 1, .flags = HK_SCRATCH},
    {0},
};

static void reset(void *self, hk_reason why) {
  (void)why;
  ((dopri5 *)self)->primed = 0;
}

/* The estimated error of the step, relative to tol. */
static double estimate(dopri5 *m, const hk_system *s, double h) {
  const double *X = hk_rk_stage_state(&hk_dormand_prince, s, m->k);
  memset(m->error, 0, s->size * sizeof *m->error);
  hk_rk_combine(&hk_dormand_prince, s, h, m->k, error_weight, STAGES, 0, m->error, m->error);
  return hk_scales_error(&m->scales, s, h, X, hk_rk_slope(s, m->k, STAGES - 1), m->error) / s->tol;
}

/* The first step. The largest rate (1/s) at which the system changes is estimated from f at X and after a small Euler
 * step; h then follows from Hairer's rule that (h rate)^5 is a hundredth of the tolerance, so that the choice does not
 * depend on the unit of time. */
static hk_status first_step(dopri5 *m, hk_system *s, double span, double *h) {
  size_t v = 3 * s->n;
  const hk_tableau *T = &hk_dormand_prince;
  double *X = hk_rk_stage_state(T, s, m->k), *a = hk_rk_slope(s, m->k, 0), *next = hk_rk_slope(s, m->k, 1);
  double V, rate = hk_scales_rate(&m->scales, hk_scales_extent(&m->scales, s, s->X), &V);
  rate = fmax(rate, hk_channel_rate(s, s->X + 2 * v, a + v));
  double small = rate > 0 ? 0.01 / rate : 1e-3 * span;
  if (!(small < span)) small = span;
  hk_rk_combine(T, s, small, m->k, (const double[]){1}, 1, 1, s->X, X);
  hk_status status = s->accelerations(s, s->t + small, X, X + v, X + 2 * v, next, next + v);
  if (status != HK_OK) return status;
  for (size_t e = 0; e < v; e++) m->error[e] = next[e] - a[e];
  for (size_t e = v; e + v < s->size; e++) m->error[e] = 0;
  V = fmax(V, small * hk_rms_free(s, next)); /* for a start from rest */
  rate = fmax(rate, sqrt(hk_ratio(hk_rms_free(s, m->error), V * small)));
  *h = rate > 0 ? pow(0.01 * s->tol, 0.2) / rate : small;
  return HK_OK;
}

static hk_status begin(dopri5 *m, hk_system *s, double span, double *h) {
  size_t v = 3 * s->n;
  double *X = s->X, *a = hk_rk_slope(s, m->k, 0);
  hk_status status = HK_OK;
  if (!(*h > 0) || *h > span * (1 - 1e-12)) *h = span; /* exceeds h by rounding only */
  if (m->primed)
    memcpy(a, m->first, (s->size - v) * sizeof *a);
  else
    status = s->accelerations(s, s->t, X, X + v, X + 2 * v, a, a + v);
  if (status != HK_OK) return status;
  hk_scales_notice(&m->scales, s, X + v, a);
  if (m->started) return HK_OK;
  double first = span;
  status = hk_scales_foresee(&m->scales, s, span, hk_rk_stage_state(&hk_dormand_prince, s, m->k), m->error);
  if (status == HK_OK) status = first_step(m, s, span, &first);
  *h = fmin(*h, first);
  return status;
}

static void accept(dopri5 *m, hk_system *s, double h, bool lands, bool retried, double error, hk_step *out) {
  size_t v = 3 * s->n;
  const double *X = hk_rk_stage_state(&hk_dormand_prince, s, m->k), *a = hk_rk_slope(s, m->k, STAGES - 1);
  double last = m->started ? m->last_error : 1e-4;
  double change = safety * pow(last, beta) / pow(error, 0.2 - 0.75 * beta);
  double next = h * fmin(most, fmax(least, change));
  if (retried) next = fmin(next, h);
  if (lands && !retried && m->started) next = fmax(next, m->proposal); /* h was shortened to end at t_stop */
  memcpy(s->X, X, s->size * sizeof *X);
  memcpy(m->first, a, (s->size - v) * sizeof *a);
  hk_scales_notice(&m->scales, s, X + v, a);
  m->primed = m->started = 1;
  m->last_error = fmax(error, 1e-4);
  m->proposal = next;
  *out = (hk_step){h, next, error};
}

static hk_status step(void *self, const void *method, hk_system *s, double t_stop, double h, hk_step *out) {
  dopri5 *m = self;
  double span = t_stop - s->t, error = NAN;
  (void)method;
  hk_status status = begin(m, s, span, &h);
  if (status != HK_OK) return status;
  if (h < span && 2 * h > span) h = span / 2; /* avoids a very short last step */
  for (bool retried = false;; retried = true) {
    status = hk_rk_stages(&hk_dormand_prince, s, h, m->k, 1);
    if (status == HK_OK)
      error = estimate(m, s, h);
    else if (status == HK_NOT_FINITE || status == HK_NOT_CONVERGED)
      error = NAN;
    else
      return status;
    if (error <= 1) {
      accept(m, s, h, h >= span, retried, error, out);
      return HK_OK;
    }
    h *= error < INFINITY ? fmax(least, safety * pow(error, -0.2)) : least;
    if (!(h > 8 * DBL_EPSILON * fmax(fabs(s->t), span)))
      return s->host->fail(s->host, HK_NOT_CONVERGED,
                           "no step from t = %.17g s meets the tolerance %g: tried down to %g s, where the error is %g "
                           "times as large; give a larger tol, or look for a force that jumps",
                           s->t, s->tol, h, error);
  }
}

static const hk_integrator integrator = {.size = sizeof(hk_integrator),
                                         .order = 5,
                                         .stages = 6,
                                         .flags = HK_ADAPTIVE,
                                         .method = &hk_dormand_prince,
                                         .step = step,
                                         .reset = reset,
                                         .growth = hk_rk_growth};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "dopri5",
    .summary =
        "Dormand and Prince's Runge-Kutta method of order 5 with an error estimate of order 4; chooses its steps, "
        "six evaluations each",
    .reference =
        "Dormand and Prince 1980, J. Comput. Appl. Math. 6; Hairer, Norsett and Wanner, Solving ODEs I, II.4-5",
    .instance_size = sizeof(dopri5),
    .fields = fields,
    .integrator = &integrator,
};
