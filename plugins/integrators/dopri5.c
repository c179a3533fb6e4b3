/* Dormand and Prince's embedded pair of order 5(4), with its own choice of the step.
 *
 * The error of a step is the largest of the relative errors, in the 2-norm, of positions, velocities and each channel,
 * over `tol`; a step is taken when it is at most 1. Positions are measured against the scene's size, the RMS distance
 * of the particles from their mean or, if that is larger, V^2/A, the radius of curvature of a path, with V and A the
 * largest RMS speed and acceleration so far: neither depends on where the origin lies, and one particle alone has the
 * second. Velocities are measured against V, a channel against its larger RMS at the two ends of the step. The work
 * does not count. The next step follows from the last two errors (Hairer, Norsett and Wanner, Solving ODEs I, II.4;
 * Hairer and Wanner II, IV.2). The seventh stage is the first of the next step. */
#include "plugins/common/runge_kutta.h"

#include <float.h>
#include <string.h>

enum { STAGES = 7, LANES = 8 };

static const double error_weight[STAGES] = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                            -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
static const double safety = 0.9, least = 0.2, most = 10, beta = 0.04; /* bounds of the change of h; PI control */

typedef struct dopri5 {
  int64_t primed;             /* whether `first` is the slope at X */
  int64_t started;            /* whether a step has been taken */
  double proposal;            /* s, what it would take next */
  double last_error;          /* of the last step, for the control */
  double speed, acceleration; /* largest RMS so far */
  double *first;              /* slope at X */
  double *k;                  /* slopes, then the state of a stage */
  double *error;              /* shaped as X */
} dopri5;

static const hk_field fields[] = {
    {"primed", HK_FIELD_INTEGER, 1, offsetof(dopri5, primed), 0},
    {"started", HK_FIELD_INTEGER, 1, offsetof(dopri5, started), 0},
    {"proposal", HK_FIELD_NUMBER, 1, offsetof(dopri5, proposal), 0},
    {"last_error", HK_FIELD_NUMBER, 1, offsetof(dopri5, last_error), 0},
    {"speed", HK_FIELD_NUMBER, 1, offsetof(dopri5, speed), 0},
    {"acceleration", HK_FIELD_NUMBER, 1, offsetof(dopri5, acceleration), 0},
    {"first", HK_FIELD_STATE, 1, offsetof(dopri5, first), 0},
    {"stages", HK_FIELD_STATE, STAGES + 1, offsetof(dopri5, k), HK_SCRATCH},
    {"error", HK_FIELD_STATE, 1, offsetof(dopri5, error), HK_SCRATCH},
    {0},
};

static double amplification(double hw, double hg) { return hk_rk_amplification(&hk_dormand_prince, hw, hg); }

static void reset(void *self, hk_reason why) {
  (void)why;
  ((dopri5 *)self)->primed = 0;
}

/* Sums in lanes, for speed; the order is fixed. */
static double rms(const double *p, size_t count) {
  double sum[LANES] = {0}, total = 0;
  size_t e = 0;
  for (; e + LANES <= count; e += LANES)
    for (size_t l = 0; l < LANES; l++) sum[l] += p[e + l] * p[e + l];
  for (; e < count; e++) sum[0] += p[e] * p[e];
  for (size_t l = 0; l < LANES; l++) total += sum[l];
  return count ? sqrt(total / (double)count) : 0;
}

/* RMS of the coordinates about their means, relative to the first particle. */
static double spread(const double *x, size_t n) {
  double sum[3] = {0}, square[3] = {0}, total = 0;
  for (size_t i = 1; i < n; i++)
    for (size_t c = 0; c < 3; c++) {
      double d = x[3 * i + c] - x[c];
      sum[c] += d;
      square[c] += d * d;
    }
  for (size_t c = 0; c < 3 && n; c++) total += fmax(0, square[c] - sum[c] * sum[c] / (double)n) / (3 * (double)n);
  return sqrt(total);
}

static void notice(dopri5 *m, const double *v, const double *a, size_t count) {
  m->speed = fmax(m->speed, rms(v, count));
  m->acceleration = fmax(m->acceleration, rms(a, count));
}

static double extent(const double *x, size_t n, double V, double A) {
  return fmax(spread(x, n), A > 0 ? V * V / A : 0);
}

static double ratio(double value, double scale) { return value > 0 || isnan(value) ? value / scale : 0; }

/* NAN if one of them is. */
static double larger(double a, double b) { return isnan(a) || a > b ? a : b; }

/* Relative to tol; X_new is the state of the last stage. */
static double estimate(dopri5 *m, const hk_system *s, double h) {
  size_t v = 3 * s->n, y = 6 * s->n;
  const double *X = hk_rk_stage_state(&hk_dormand_prince, s, m->k), *E = m->error;
  memset(m->error, 0, s->size * sizeof *m->error);
  hk_rk_combine(&hk_dormand_prince, s, h, m->k, error_weight, STAGES, 0, m->error, m->error);
  double V = fmax(m->speed, rms(X + v, v));
  double A = fmax(m->acceleration, rms(hk_rk_slope(s, m->k, STAGES - 1), v));
  double worst = larger(ratio(rms(E, v), extent(X, s->n, V, A)), ratio(rms(E + v, v), V));
  for (size_t c = 0; c < s->model->channels; c++) {
    size_t begin = y + s->model->channel[c].offset * s->n, count = s->model->channel[c].size * s->n;
    double scale = fmax(rms(s->X + begin, count), rms(X + begin, count));
    worst = larger(worst, ratio(rms(E + begin, count), scale));
  }
  return worst / s->tol;
}

/* The largest rate (1/s) at which the system changes, from f here and after a small Euler step; then Hairer's rule that
 * (h rate)^5 is a hundredth of the tolerance, which so does not depend on the unit of time. */
static hk_status first_step(dopri5 *m, hk_system *s, double span, double *h) {
  size_t v = 3 * s->n;
  const hk_tableau *T = &hk_dormand_prince;
  double *X = hk_rk_stage_state(T, s, m->k), *a = hk_rk_slope(s, m->k, 0), *next = hk_rk_slope(s, m->k, 1);
  double L = extent(s->X, s->n, m->speed, m->acceleration), V = fmax(m->speed, sqrt(L * m->acceleration));
  double rate = fmax(ratio(m->speed, L), ratio(m->acceleration, V)), small = rate > 0 ? 0.01 / rate : 1e-3 * span;
  if (!(small < span)) small = span;
  hk_rk_combine(T, s, small, m->k, (const double[]){1}, 1, 1, s->X, X);
  hk_status status = s->accelerations(s, s->t + small, X, X + v, X + 2 * v, next, next + v);
  if (status != HK_OK) return status;
  for (size_t e = 0; e < v; e++) m->error[e] = next[e] - a[e];
  for (size_t e = v; e + v < s->size; e++) m->error[e] = 0;
  V = fmax(V, small * rms(next, v)); /* from rest */
  rate = fmax(rate, sqrt(ratio(rms(m->error, v), V * small)));
  *h = rate > 0 ? pow(0.01 * s->tol, 0.2) / rate : small;
  return HK_OK;
}

static hk_status begin(dopri5 *m, hk_system *s, double span, double *h) {
  size_t v = 3 * s->n;
  double *X = s->X, *a = hk_rk_slope(s, m->k, 0);
  hk_status status = HK_OK;
  if (!(*h > 0) || *h > span * (1 - 1e-12)) *h = span; /* rounding aside, no longer than h */
  if (m->primed)
    memcpy(a, m->first, (s->size - v) * sizeof *a);
  else
    status = s->accelerations(s, s->t, X, X + v, X + 2 * v, a, a + v);
  if (status != HK_OK) return status;
  notice(m, X + v, a, v);
  if (m->started) return HK_OK;
  double first = span;
  status = first_step(m, s, span, &first);
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
  if (lands && !retried && m->started) next = fmax(next, m->proposal); /* h was cut short */
  memcpy(s->X, X, s->size * sizeof *X);
  memcpy(m->first, a, (s->size - v) * sizeof *a);
  notice(m, X + v, a, v);
  m->primed = m->started = 1;
  m->last_error = fmax(error, 1e-4);
  m->proposal = next;
  *out = (hk_step){h, next, error};
}

static hk_status step(void *self, hk_system *s, double t_stop, double h, hk_step *out) {
  dopri5 *m = self;
  double span = t_stop - s->t, error = NAN;
  hk_status status = begin(m, s, span, &h);
  if (status != HK_OK) return status;
  if (h < span && 2 * h > span) h = span / 2; /* no tiny last step */
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

static const hk_integrator integrator = {
    .order = 5, .stages = 6, .flags = HK_ADAPTIVE, .amplification = amplification, .step = step, .reset = reset};

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
