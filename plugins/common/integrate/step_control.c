/* See step_control.h. Sums are computed in LANES partial sums, for speed; their order is fixed. */
#include "plugins/common/integrate/step_control.h"

#include <string.h>

enum { LANES = 8 };

static const double at_rest = 1e-6; /* a speed that counts as rest: this part of the extent per step */

double hk_rms(const double *p, size_t count) {
  double sum[LANES] = {0}, total = 0;
  size_t e = 0;
  for (; e + LANES <= count; e += LANES)
    for (size_t l = 0; l < LANES; l++) sum[l] += p[e + l] * p[e + l];
  for (; e < count; e++) sum[0] += p[e] * p[e];
  for (size_t l = 0; l < LANES; l++) total += sum[l];
  return count ? sqrt(total / (double)count) : 0;
}

double hk_ratio(double value, double scale) { return value > 0 || isnan(value) ? value / scale : 0; }

void hk_scales_notice(hk_scales *c, const hk_system *s, const double *v, const double *a) {
  c->speed = fmax(c->speed, hk_rms(v, 3 * s->n));
  c->acceleration = fmax(c->acceleration, hk_rms(a, 3 * s->n));
}

/* RMS of the coordinates about their means; differences from the first particle avoid cancellation. */
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

static double extent(const double *x, size_t n, double V, double A) {
  return fmax(spread(x, n), A > 0 ? V * V / A : 0);
}

hk_status hk_scales_foresee(hk_scales *c, hk_system *s, double span, double *X, double *rates) {
  size_t v = 3 * s->n;
  if (c->speed > 0 || c->acceleration > 0 || spread(s->X, s->n) > 0) return HK_OK;
  memcpy(X, s->X, s->size * sizeof *X);
  hk_status status = s->rates(s, s->t + span, X, rates);
  if (status != HK_OK) return status;
  c->acceleration = hk_rms(rates + v, v);
  c->speed = fmax(hk_rms(X + v, v), c->acceleration * span);
  return HK_OK;
}

double hk_scales_extent(const hk_scales *c, const hk_system *s, const double *x) {
  return extent(x, s->n, c->speed, c->acceleration);
}

double hk_scales_rate(const hk_scales *c, double L, double *speed) {
  double V = fmax(c->speed, sqrt(L * c->acceleration));
  *speed = V;
  return fmax(L > 0 ? c->speed / L : 0, V > 0 ? c->acceleration / V : 0);
}

/* The maximum; NAN if one of them is. */
static double larger(double a, double b) { return isnan(a) || a > b ? a : b; }

double hk_scales_speed(const hk_scales *c, double extent, double h) { return fmax(c->speed, at_rest * extent / h); }

double hk_scales_error(const hk_scales *c, const hk_system *s, double h, const double *X, const double *a,
                       const double *E) {
  size_t v = 3 * s->n, y = 6 * s->n;
  double V = fmax(c->speed, hk_rms(X + v, v)), A = fmax(c->acceleration, hk_rms(a, v));
  double L = extent(X, s->n, V, A);
  double worst = larger(hk_ratio(hk_rms(E, v), L), hk_ratio(hk_rms(E + v, v), fmax(V, at_rest * L / h)));
  for (size_t k = 0; k < s->model->channels; k++) {
    size_t begin = y + s->model->channel[k].offset * s->n, count = s->model->channel[k].size * s->n;
    double scale = fmax(hk_rms(s->X + begin, count), hk_rms(X + begin, count));
    worst = larger(worst, hk_ratio(hk_rms(E + begin, count), scale));
  }
  return worst;
}
