/* See channels.h. Invariant: `factor` belongs to `block` and g, or g is 0. */
#include "plugins/common/integrate/channels.h"

#include <float.h>
#include <string.h>

enum { RENEWALS = 3 }; /* of the blocks in a stage: what they leave out is not found by making them again */

static const double slow = 0.2, hopeless = 2, rounding = 16 * DBL_EPSILON;

/* A number that is much smaller than the others of all particles is judged against this part of theirs. */
static const double smallest = 1e-6;

static double *at(const hk_channels *c, double *list, size_t i) { return list + i * c->width * c->width; }

static size_t place(const hk_channels *c, size_t k, size_t i) { return c->first[k] + c->step[k] * i; }

static hk_status reserve(hk_channels *c) {
  size_t numbers = c->n * c->width, squares = numbers * c->width;
  c->first = c->host->allocate(c->host, 2 * c->width * sizeof *c->first);
  c->block = c->host->allocate(c->host, 2 * squares * sizeof *c->block);
  c->pivot = c->host->allocate(c->host, numbers * sizeof *c->pivot);
  c->scratch = c->host->allocate(c->host, (3 * c->n + 3 * (numbers + 1)) * sizeof *c->scratch);
  if (!c->first || !c->block || !c->pivot || !c->scratch)
    return c->host->fail(c->host, HK_NO_MEMORY, "no memory for the Jacobians of %zu channel numbers", numbers);
  c->step = c->first + c->width;
  c->factor = c->block + squares;
  return HK_OK;
}

hk_status hk_channels_open(hk_channels *c, const hk_host *host, const hk_view *view) {
  hk_channels_close(c);
  *c = (hk_channels){.host = host, .n = view->n};
  for (size_t q = 0; q < view->model->channels; q++) c->width += view->model->channel[q].size;
  if (c->width == 0 || c->n == 0) return HK_OK;
  hk_status status = reserve(c);
  if (status != HK_OK) return status;
  for (size_t q = 0, k = 0; q < view->model->channels; q++)
    for (size_t e = 0; e < view->model->channel[q].size; e++, k++) {
      c->first[k] = view->model->channel[q].offset * c->n + e;
      c->step[k] = view->model->channel[q].size;
    }
  return HK_OK;
}

void hk_channels_close(hk_channels *c) {
  if (!c->host) return;
  c->host->release(c->host, c->first);
  c->host->release(c->host, c->block);
  c->host->release(c->host, c->pivot);
  c->host->release(c->host, c->scratch);
  *c = (hk_channels){0};
}

void hk_channels_forget(hk_channels *c) {
  c->known = false;
  c->g = 0;
}

/* ---- blocks ---- */

/* Gaussian elimination with row pivoting, in place. */
static void decompose(double *a, size_t *pivot, size_t w) {
  for (size_t k = 0; k < w; k++) {
    size_t best = k;
    for (size_t r = k + 1; r < w; r++)
      if (fabs(a[r * w + k]) > fabs(a[best * w + k])) best = r;
    pivot[k] = best;
    for (size_t e = 0; best != k && e < w; e++) {
      double kept = a[k * w + e];
      a[k * w + e] = a[best * w + e];
      a[best * w + e] = kept;
    }
    if (a[k * w + k] == 0) a[k * w + k] = DBL_EPSILON; /* singular: a long change, which the iteration judges */
    for (size_t r = k + 1; r < w; r++) {
      double m = a[r * w + k] /= a[k * w + k];
      for (size_t e = k + 1; e < w; e++) a[r * w + e] -= m * a[k * w + e];
    }
  }
}

static void substitute(const hk_channels *c, size_t i, double *x) {
  const double *a = at(c, c->factor, i);
  const size_t *pivot = c->pivot + i * c->width;
  size_t w = c->width;
  for (size_t k = 0; k < w; k++) {
    double kept = x[place(c, pivot[k], i)];
    x[place(c, pivot[k], i)] = x[place(c, k, i)];
    x[place(c, k, i)] = kept;
  }
  for (size_t k = 0; k < w; k++)
    for (size_t e = 0; e < k; e++) x[place(c, k, i)] -= a[k * w + e] * x[place(c, e, i)];
  for (size_t k = w; k-- > 0;) {
    for (size_t e = k + 1; e < w; e++) x[place(c, k, i)] -= a[k * w + e] * x[place(c, e, i)];
    x[place(c, k, i)] /= a[k * w + k];
  }
}

void hk_channels_factorize(hk_channels *c, double g) {
  size_t w = c->width;
  if (!c->known || c->g == g) return;
  c->g = g;
  for (size_t i = 0; i < c->n; i++) {
    const double *block = at(c, c->block, i);
    double *a = at(c, c->factor, i);
    for (size_t e = 0; e < w * w; e++) a[e] = (e % (w + 1) == 0) - g * block[e];
    decompose(a, c->pivot + i * w, w);
  }
}

void hk_channels_solve(const hk_channels *c, const double *b, double *x) {
  if (x != b) memcpy(x, b, c->n * c->width * sizeof *x);
  for (size_t i = 0; c->g > 0 && i < c->n; i++) substitute(c, i, x);
}

static double largest(const hk_channels *c, const double *y, size_t k) {
  double most = 0;
  for (size_t i = 0; i < c->n; i++) most = fmax(most, fabs(y[place(c, k, i)]));
  return most;
}

static double largest_of_all(const hk_channels *c, const double *y) {
  double most = 0;
  for (size_t e = 0; e < c->n * c->width; e++) most = fmax(most, fabs(y[e]));
  return most;
}

/* The difference by which a number is perturbed: half of its digits. */
static double difference(double y, double size, size_t i) {
  double d = sqrt(DBL_EPSILON) * fmax(fabs(y), size);
  return i % 2 ? -d : d;
}

hk_status hk_channels_differentiate(hk_channels *c, hk_system *s, double t, double *X, const double *dy) {
  size_t w = c->width, v = 3 * s->n, numbers = c->n * w;
  double *a = c->scratch, *rates = a + v, *y = rates + numbers + 1, *from = y + numbers + 1;
  if (numbers == 0) return HK_OK;
  memcpy(y, X + 2 * v, (numbers + 1) * sizeof *y);
  hk_status status = HK_OK;
  if (dy)
    memcpy(from, dy, numbers * sizeof *dy);
  else
    status = s->accelerations(s, t, X, X + v, y, a, from);
  double floor = smallest * largest_of_all(c, y);
  if (!(floor > 0)) floor = 1;
  for (size_t k = 0; k < w && status == HK_OK; k++) {
    double size = fmax(smallest * largest(c, y, k), smallest * floor);
    for (size_t i = 0; i < c->n; i++) y[place(c, k, i)] += difference(y[place(c, k, i)], size, i);
    status = s->accelerations(s, t, X, X + v, y, a, rates);
    for (size_t i = 0; i < c->n; i++) {
      double kept = X[2 * v + place(c, k, i)], d = y[place(c, k, i)] - kept;
      for (size_t r = 0; r < w; r++) at(c, c->block, i)[r * w + k] = (rates[place(c, r, i)] - from[place(c, r, i)]) / d;
      y[place(c, k, i)] = kept;
    }
  }
  hk_channels_forget(c);
  c->known = status == HK_OK;
  return status;
}

/* ---- the iteration ---- */

/* The largest change d relative to what is allowed. */
static double excess(const hk_channels *c, const hk_stage *stage, const double *d, const double *y, const double *base,
                     double tolerance) {
  double floor = smallest * largest_of_all(c, y), worst = 0;
  for (size_t k = 0; k < c->width; k++) {
    double size = fmax(floor, largest(c, y, k)), moved = 0, off = 0;
    for (size_t i = 0; i < c->n; i++) {
      size_t e = place(c, k, i);
      moved = fmax(moved, fabs(y[e] - d[e] - base[e]));
      off = fmax(off, fabs(d[e]));
      if (isnan(d[e])) return NAN;
    }
    double allowed = tolerance * moved;
    if (stage->channels > 0) allowed = fmin(allowed, stage->channels * size);
    allowed += rounding * size;
    if (off > 0) worst = fmax(worst, off / allowed);
  }
  return worst;
}

hk_status hk_channels_improve(hk_channels *c, hk_system *s, const hk_stage *stage, const double *dy, double tolerance,
                              bool moved, bool *settled) {
  size_t v = 3 * s->n, numbers = c->n * c->width;
  double *y = stage->X + 2 * v, *left = c->scratch + v, *d = left + numbers + 1;
  const double *base = stage->base + 2 * v;
  y[numbers] = base[numbers] + stage->g * dy[numbers]; /* the work, on which nothing depends */
  *settled = numbers == 0;
  if (numbers == 0) return HK_OK;
  if (moved) {
    c->last = 0;
    c->rate = 1;
    c->renewals = 0;
  }
  for (bool fresh = false;; fresh = true) {
    for (size_t e = 0; e < numbers; e++) left[e] = y[e] - base[e] - stage->g * dy[e];
    hk_channels_factorize(c, stage->g);
    hk_channels_solve(c, left, d);
    double off = excess(c, stage, d, y, base, tolerance);
    if (isnan(off)) return HK_NOT_FINITE;
    double rate = c->last > 0 ? off / c->last : 0;
    *settled = off * fmin(1, fmax(rate, c->rate)) <= 1;
    if (*settled || fresh || rate <= slow || c->renewals == RENEWALS) {
      if (rate > hopeless && !*settled && !fresh) return HK_NOT_CONVERGED;
      if (c->last > 0) c->rate = fmax(0.3 * c->rate, rate);
      c->last = fresh ? 0 : off;
      for (size_t e = 0; e < numbers; e++) y[e] -= d[e];
      return HK_OK;
    }
    hk_status status = hk_channels_differentiate(c, s, stage->t, stage->X, dy);
    if (status != HK_OK) return status;
    c->rate = 1;
    c->renewals++;
  }
}
