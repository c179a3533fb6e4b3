/* Dormand and Prince's method of order 5 with the error of its embedded order 4, adaptive.
 *
 * The error norm is the largest of three RMS values, over x, v and the channels, each relative to tol times a scale of
 * its kind: the largest distance moved since the start of the course and the largest speed times the step for x; the
 * largest speed for v; the largest value for a channel. Scales of a whole kind, not of each component, because a
 * component near zero says nothing, and because a scene far from the origin must be as accurate as one at it. The work,
 * the last of y, follows and does not steer. Steps: PI control and the starting step of Hairer, Norsett and Wanner,
 * Solving ODEs I, II.4; the last two steps before t_stop are made equal. */
#include "plugins/common/runge_kutta.h"

#include <string.h>

typedef struct dopri5 {
  int64_t primed;      /* stage 7 of the last step is f at X */
  double last_error;   /* of the last accepted step, for the controller */
  double speed, reach; /* largest |v| and displacement scale seen, m/s and m */
  double *k;           /* 7 stages and one more */
  double *trial;       /* shaped as X */
} dopri5;

static const hk_field fields[] = {
    {"primed", HK_FIELD_INTEGER, 1, offsetof(dopri5, primed), 0},
    {"last_error", HK_FIELD_NUMBER, 1, offsetof(dopri5, last_error), 0},
    {"speed", HK_FIELD_NUMBER, 1, offsetof(dopri5, speed), 0},
    {"reach", HK_FIELD_NUMBER, 1, offsetof(dopri5, reach), 0},
    {"stages", HK_FIELD_STATE, HK_RK_STAGES + 1, offsetof(dopri5, k), 0},
    {"trial", HK_FIELD_STATE, 1, offsetof(dopri5, trial), HK_SCRATCH},
    {0},
};

enum { LAST = HK_RK_STAGES - 1 };

/* b - b^ of the embedded method. */
static const double error_weight[HK_RK_STAGES] = {71.0 / 57600,      0,          -71.0 / 16695, 71.0 / 1920,
                                                  -17253.0 / 339200, 22.0 / 525, -1.0 / 40};

static double amplification(double hw, double hg) { return hk_rk_amplification(&hk_dormand_prince, hw, hg); }

static void reset(void *self, hk_reason why) {
  dopri5 *m = self;
  (void)why;
  m->primed = 0;
  m->last_error = 0;
}

static double largest(const double *list, size_t count) {
  double m = 0;
  for (size_t e = 0; e < count; e++) m = fmax(m, fabs(list[e]));
  return m;
}

static double rms(const double *list, size_t count) {
  double sum = 0;
  for (size_t e = 0; e < count; e++) sum += list[e] * list[e];
  return count ? sqrt(sum / (double)count) : 0;
}

/* Extent of the positions about their mean: the length by which an error in x is large or small. */
static double extent(const double *x, size_t n) {
  double widest = 0;
  for (size_t c = 0; c < 3; c++) {
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < n; i++) {
      low = fmin(low, x[3 * i + c]);
      high = fmax(high, x[3 * i + c]);
    }
    if (high > low) widest = fmax(widest, high - low);
  }
  return widest;
}

static double ratio(double error, double scale) { return error == 0 ? 0 : error / scale; }

static double error_norm(dopri5 *m, const hk_system *s, double h) {
  size_t n3 = 3 * s->n, channels = s->size - 2 * n3 - 1;
  double *e = m->k + (size_t)HK_RK_STAGES * s->size;
  for (size_t q = 0; q < s->size; q++) {
    double sum = 0;
    for (int i = 0; i < HK_RK_STAGES; i++) sum += error_weight[i] * m->k[(size_t)i * s->size + q];
    e[q] = h * sum;
  }
  m->speed = fmax(m->speed, fmax(largest(s->X + n3, n3), h > 0 ? largest(m->trial + n3, n3) : 0));
  m->reach = fmax(m->reach, extent(m->trial, s->n));
  for (size_t q = 0; q < n3; q++) m->reach = fmax(m->reach, fabs(m->trial[q] - s->X[q]));
  double norm = fmax(ratio(rms(e, n3), s->tol * m->reach), ratio(rms(e + n3, n3), s->tol * m->speed));
  double scale = fmax(largest(s->X + 2 * n3, channels), largest(m->trial + 2 * n3, channels));
  return fmax(norm, ratio(rms(e + 2 * n3, channels), s->tol * scale));
}

/* h0 = 0.01 |X|/|f|, then from how f changes over it (II.4, starting step size, with the scales above). */
static double starting_step(dopri5 *m, hk_system *s, double t_stop) {
  size_t n3 = 3 * s->n;
  const double *f = m->k;
  double speed = largest(s->X + n3, n3), pull = largest(f + n3, n3), span = t_stop - s->t;
  double h0 = pull > 0 && speed > 0 ? 0.01 * speed / pull : 1e-3 * span;
  double y = largest(s->X + 2 * n3, s->size - 2 * n3 - 1), dy = largest(f + 2 * n3, s->size - 2 * n3 - 1);
  if (dy > 0 && y > 0) h0 = fmin(h0, 0.01 * y / dy);
  double *stage = m->k + (size_t)HK_RK_STAGES * s->size, *g = m->k + s->size;
  h0 = fmin(h0, span);
  for (size_t q = 0; q < s->size; q++) stage[q] = s->X[q] + h0 * f[q];
  if (s->rates(s, s->t + h0, stage, g) != HK_OK) return h0 / 10;
  double change = 0, rate = 0;
  for (size_t q = n3; q < s->size - 1; q++) {
    change = fmax(change, fabs(g[q] - f[q]) / h0);
    rate = fmax(rate, fabs(f[q]));
  }
  double sharp = rate > 0 ? change / rate : 0; /* 1/s, how fast f changes */
  double h1 = sharp > 0 ? pow(0.01 * s->tol, 0.2) / sharp : 100 * h0;
  return fmin(fmin(fmax(h1, h0), 100 * h0), span);
}

/* Not beyond t_stop, and not leaving a sliver before it. */
static double fit(double h, double left) { return h >= left ? left : h > left / 2 ? left / 2 : h; }

static hk_status first_stage(dopri5 *m, hk_system *s) {
  if (m->primed)
    memcpy(m->k, m->k + LAST * s->size, s->size * sizeof *m->k);
  else
    return s->rates(s, s->t, s->X, m->k);
  return HK_OK;
}

/* One attempt; HK_OK with a norm, INFINITY where the trial ran into numbers that are not finite. */
static hk_status attempt(dopri5 *m, hk_system *s, double h, double *norm) {
  hk_status status = hk_rk_stages(&hk_dormand_prince, s, h, m->k, 1);
  *norm = INFINITY;
  if (status != HK_OK) return status;
  memcpy(m->trial, s->X, s->size * sizeof *m->trial);
  hk_rk_advance(&hk_dormand_prince, s, h, m->k, m->trial);
  *norm = error_norm(m, s, h);
  if (isnan(*norm)) *norm = INFINITY;
  return HK_OK;
}

static hk_status step(void *self, hk_system *s, double t_stop, double h, hk_step *out) {
  dopri5 *m = self;
  double left = t_stop - s->t, norm;
  hk_status status = first_stage(m, s);
  if (status != HK_OK) return status;
  double wanted = isfinite(h) && h > 0 ? h : starting_step(m, s, t_stop);
  bool rejected = false;
  for (;;) {
    h = fit(wanted, left);
    if (h < 1e-14 * fmax(fabs(s->t), left))
      return s->host->fail(s->host, HK_NOT_CONVERGED, "at t = %.9g s no step meets the tolerance %g", s->t, s->tol);
    status = attempt(m, s, h, &norm);
    if (status != HK_OK) return status;
    if (norm <= 1) break;
    rejected = true;
    wanted = h * fmax(0.2, 0.9 * pow(norm, -0.2));
  }
  double factor = norm > 0 ? 0.9 * pow(norm, -0.17) * pow(fmax(m->last_error, 1e-4), 0.04) : 5;
  double next = h * fmin(rejected ? 1 : 5, fmax(0.2, factor));
  memcpy(s->X, m->trial, s->size * sizeof *s->X);
  m->last_error = norm;
  m->primed = 1;
  *out = (hk_step){h, h < wanted && next < wanted ? wanted : next, norm};
  return HK_OK;
}

static const hk_integrator integrator = {
    .order = 5, .stages = 6, .flags = HK_ADAPTIVE, .amplification = amplification, .step = step, .reset = reset};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_INTEGRATOR,
    .name = "dopri5",
    .summary = "Dormand and Prince's Runge-Kutta method 5(4), adaptive: steps follow the tolerance and land on frames",
    .reference = "Dormand and Prince 1980, RK5(4)7M; Hairer, Norsett and Wanner, Solving ODEs I, II.4-II.5",
    .instance_size = sizeof(dopri5),
    .fields = fields,
    .integrator = &integrator,
};
