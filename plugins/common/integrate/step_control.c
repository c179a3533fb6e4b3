/* See step_control.h. Sums are computed in LANES partial sums, for speed; their order is fixed. */
#include "plugins/common/integrate/step_control.h"

#include <float.h>
#include <string.h>

enum { LANES = 8, WAIT = 10 };

static const double at_rest = 1e-6;  /* a speed that counts as rest: this part of the extent per step */
static const double smallest = 1e-6; /* a number of a channel that counts as 0: this part of the channel's largest */

bool hk_jump_met(int64_t *wait, double error) {
  if (*wait > 0 || !isfinite(error)) return false;
  *wait = WAIT;
  return true;
}

void hk_jump_passed(int64_t *wait) { *wait -= *wait > 0; }

double hk_shortest_step(const hk_system *s, double span) { return 8 * DBL_EPSILON * fmax(fabs(s->t), span); }

double hk_inner_product(const double *a, const double *b, size_t count) {
  double sum[LANES] = {0}, total = 0;
  size_t e = 0;
  for (; e + LANES <= count; e += LANES)
    for (size_t l = 0; l < LANES; l++) sum[l] += a[e + l] * b[e + l];
  for (size_t l = 0; e < count; e++, l++) sum[l] += a[e] * b[e]; /* zeros behind them would change no sum */
  for (size_t l = 0; l < LANES; l++) total += sum[l];
  return total;
}

double hk_ratio(double value, double scale) { return value > 0 || isnan(value) ? value / scale : 0; }

double hk_rms_free(const hk_system *s, const double *p) {
  double sum = 0;
  size_t moving = 0;
  for (size_t i = 0; i < s->n; i++) {
    bool moves = s->model->inverse_mass[i] > 0;
    double square = p[3 * i] * p[3 * i] + p[3 * i + 1] * p[3 * i + 1] + p[3 * i + 2] * p[3 * i + 2];
    sum += moves ? square : 0;
    moving += moves;
  }
  return moving ? sqrt(sum / (3 * (double)moving)) : 0;
}

double hk_rms_moving(const hk_system *s, const double *v) {
  double sum = 0;
  size_t moving = 0;
  for (size_t i = 0; i < s->n; i++) {
    double square = v[3 * i] * v[3 * i] + v[3 * i + 1] * v[3 * i + 1] + v[3 * i + 2] * v[3 * i + 2];
    sum += square;
    moving += s->model->inverse_mass[i] > 0 || square > 0;
  }
  return moving ? sqrt(sum / (3 * (double)moving)) : 0;
}

void hk_scales_notice(hk_scales *c, const hk_system *s, const double *v, const double *a) {
  c->speed = fmax(c->speed, hk_rms_free(s, v));
  c->acceleration = fmax(c->acceleration, hk_rms_free(s, a));
}

/* RMS of the coordinates about their means, of all particles or of those that move; differences from the first of them
 * avoid cancellation. */
static double spread_of(const hk_system *s, const double *x, bool all) {
  double sum[3] = {0}, square[3] = {0}, total = 0;
  const double *first = NULL;
  size_t count = 0;
  for (size_t i = 0; i < s->n; i++) {
    const double *at = x + 3 * i;
    if (!all && !(s->model->inverse_mass[i] > 0)) continue;
    if (!first) first = at;
    count++;
    for (size_t c = 0; c < 3; c++) {
      double d = at[c] - first[c];
      sum[c] += d;
      square[c] += d * d;
    }
  }
  double n = (double)count;
  for (size_t c = 0; c < 3 && count; c++) total += fmax(0, square[c] - sum[c] * sum[c] / n) / (3 * n);
  return sqrt(total);
}

/* Of what moves: an obstacle that is pinned far away makes no error of a cloth smaller. Of what moves in one place
 * alone, such as the bob of a pendulum, what holds it tells the size. */
static double spread(const hk_system *s, const double *x) {
  double moving = spread_of(s, x, false);
  return moving > 0 ? moving : spread_of(s, x, true);
}

static double extent(const hk_system *s, const double *x, double V, double A) {
  return fmax(spread(s, x), A > 0 ? V * V / A : 0);
}

hk_status hk_scales_foresee(hk_scales *c, hk_system *s, double span, double *X, double *rates) {
  size_t v = 3 * s->n;
  if (c->speed > 0 || c->acceleration > 0 || spread(s, s->X) > 0) return HK_OK;
  memcpy(X, s->X, s->size * sizeof *X);
  hk_status status = s->rates(s, s->t + span, X, rates);
  if (status != HK_OK) return status;
  c->acceleration = hk_rms_free(s, rates + v);
  c->speed = fmax(hk_rms_free(s, X + v), c->acceleration * span);
  return HK_OK;
}

double hk_scales_extent(const hk_scales *c, const hk_system *s, const double *x) {
  return extent(s, x, c->speed, c->acceleration);
}

double hk_scales_rate(const hk_scales *c, double L, double *speed) {
  double V = fmax(c->speed, sqrt(L * c->acceleration));
  *speed = V;
  return fmax(L > 0 ? c->speed / L : 0, V > 0 ? c->acceleration / V : 0);
}

/* The maximum; NAN if one of them is. */
static double larger(double a, double b) { return isnan(a) || a > b ? a : b; }

double hk_scales_speed(const hk_scales *c, double extent, double h) { return fmax(c->speed, at_rest * extent / h); }

/* The largest RMS of a particle's three components; NAN if one is. */
static double worst_particle(const double *E, size_t n) {
  double most = 0;
  bool bad = false;
  for (size_t i = 0; i < n; i++) {
    double square = E[3 * i] * E[3 * i] + E[3 * i + 1] * E[3 * i + 1] + E[3 * i + 2] * E[3 * i + 2];
    bad |= isnan(square);
    most = square > most ? square : most;
  }
  return bad ? NAN : sqrt(most / 3);
}

/* The largest magnitude of one number of a channel over all particles. */
static double peak(const double *y, size_t count, size_t stride) {
  double most = 0;
  for (size_t e = 0; e < count; e += stride) most = larger(most, fabs(y[e]));
  return most;
}

double hk_channel_error(const hk_channel *channel, size_t n, const double *from, const double *to, const double *E) {
  size_t begin = (6 + channel->offset) * n, size = channel->size, count = size * n;
  double worst = 0, whole = fmax(peak(from + begin, count, 1), peak(to + begin, count, 1));
  for (size_t k = begin; k < begin + size && n; k++) {
    double scale = fmax(peak(from + k, count - (k - begin), size), peak(to + k, count - (k - begin), size));
    worst = larger(worst, hk_ratio(peak(E + k, count - (k - begin), size), fmax(scale, smallest * whole)));
  }
  return worst;
}

double hk_channel_rate(const hk_system *s, const double *y, const double *dy) {
  double rate = 0;
  for (size_t c = 0; c < s->model->channels; c++) {
    const hk_channel *channel = &s->model->channel[c];
    size_t begin = channel->offset * s->n, count = channel->size * s->n;
    double floor = smallest * peak(y + begin, count, 1);
    for (size_t k = 0; k < channel->size && floor > 0; k++) {
      double scale = fmax(floor, peak(y + begin + k, count - k, channel->size));
      rate = fmax(rate, peak(dy + begin + k, count - k, channel->size) / scale);
    }
  }
  return rate;
}

double hk_scales_error(const hk_scales *c, const hk_system *s, double h, const double *X, const double *a,
                       const double *E) {
  size_t v = 3 * s->n;
  double V = fmax(c->speed, hk_rms_free(s, X + v)), A = fmax(c->acceleration, hk_rms_free(s, a));
  double L = extent(s, X, V, A);
  if (!(L > 0)) L = V * h; /* a particle alone that no force has bent from its way */
  double worst =
      larger(hk_ratio(worst_particle(E, s->n), L), hk_ratio(worst_particle(E + v, s->n), fmax(V, at_rest * L / h)));
  for (size_t k = 0; k < s->model->channels; k++)
    worst = larger(worst, hk_channel_error(&s->model->channel[k], s->n, s->X, X, E));
  return worst;
}

static void euler(const hk_system *s, double h, const double *a, double *X) {
  size_t v = 3 * s->n;
  for (size_t e = 0; e < v; e++) X[e] = s->X[e] + h * s->X[v + e];
  for (size_t e = v; e < s->size; e++) X[e] = s->X[e] + h * a[e - v];
}

/* The rate of accelerations is that of f in the Euler step, so that a start from rest has one, too. */
hk_status hk_scales_first(hk_scales *c, hk_system *s, double span, const double *a, double *X, double *next,
                          double *rate, double *small) {
  size_t v = 3 * s->n;
  double V;
  *rate = fmax(hk_scales_rate(c, hk_scales_extent(c, s, s->X), &V), hk_channel_rate(s, s->X + 2 * v, a + v));
  *small = *rate > 0 ? 0.01 / *rate : 1e-3 * span;
  if (!(*small < span)) *small = span;
  euler(s, *small, a, X);
  hk_status status = s->accelerations(s, s->t + *small, X, X + v, X + 2 * v, next, next + v);
  if (status != HK_OK) return status;
  V = fmax(V, *small * hk_rms_free(s, next)); /* for a start from rest */
  for (size_t e = 0; e < v; e++) next[e] -= a[e];
  *rate = fmax(*rate, sqrt(hk_ratio(hk_rms_free(s, next), V * *small)));
  return HK_OK;
}
