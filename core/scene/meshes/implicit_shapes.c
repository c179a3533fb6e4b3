/* Implicit shapes: values at places, some at a time, and bounds in boxes. A box of places leaves out the blobs that do
 * not reach it, so that many blobs cost what is near. */
#include "core/scene/meshes/meshes.h"

enum { BATCH = 64 };

/* ---- blobs ---- */

static const double reach = 2; /* radii */

static double falloff(double square) { /* s^2 */
  return square < 1 ? 1 + square * (-22.0 / 9 + square * (17.0 / 9 - 4.0 / 9 * square)) : 0;
}

/* The squares of the least and the largest distance between a place and a box. */
static void distances(const double x[3], const double low[3], const double high[3], double square[2]) {
  square[0] = square[1] = 0;
  for (int c = 0; c < 3; c++) {
    double near = x[c] < low[c] ? low[c] - x[c] : x[c] > high[c] ? x[c] - high[c] : 0;
    double far = fmax(fabs(x[c] - low[c]), fabs(x[c] - high[c]));
    square[0] += near * near, square[1] += far * far;
  }
}

static void evaluate_blobs(const hk_implicit_shape *s, const double (*x)[3], size_t count, double *value) {
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, square[2];
  for (size_t k = 0; k < count; k++) {
    value[k] = -0.5;
    for (int c = 0; c < 3; c++) low[c] = fmin(low[c], x[k][c]), high[c] = fmax(high[c], x[k][c]);
  }
  for (size_t b = 0; b < s->count; b++) {
    const hk_blob *blob = &s->blob[b];
    double most = reach * blob->radius;
    distances(blob->centre, low, high, square);
    if (square[0] >= most * most) continue;
    for (size_t k = 0; k < count; k++) {
      double sum = 0;
      for (int c = 0; c < 3; c++) sum += (x[k][c] - blob->centre[c]) * (x[k][c] - blob->centre[c]);
      value[k] += blob->weight * falloff(sum / (most * most));
    }
  }
}

static void bound_blobs(const hk_implicit_shape *s, const double low[3], const double high[3], double range[2]) {
  double size = 1;
  range[0] = range[1] = -0.5;
  for (size_t b = 0; b < s->count; b++) {
    const hk_blob *blob = &s->blob[b];
    double square[2], radius2 = reach * blob->radius * reach * blob->radius;
    distances(blob->centre, low, high, square);
    double most = blob->weight * falloff(square[0] / radius2), least = blob->weight * falloff(square[1] / radius2);
    range[0] += fmin(most, least), range[1] += fmax(most, least);
    size += fabs(blob->weight);
  }
  range[0] -= 1e-14 * size, range[1] += 1e-14 * size; /* rounding */
}

/* ---- parts ---- */

/* The larger of two, rounded off over a difference of `blend`. */
static double blended(double a, double b, double blend) {
  double more = blend - fabs(a - b);
  return fmax(a, b) + (more > 0 ? more * more / (4 * blend) : 0);
}

static double joined(const hk_implicit_shape *s, double a, double b) {
  if (s->kind == HK_IMPLICIT_UNION) return blended(a, b, s->blend);
  return -blended(-a, s->kind == HK_IMPLICIT_DIFFERENCE ? b : -b, s->blend);
}

static void evaluate_some(const hk_implicit_shape *s, const double (*x)[3], size_t count, double *value) {
  double other[BATCH];
  if (s->kind == HK_IMPLICIT_BLOBS) {
    evaluate_blobs(s, x, count, value);
  } else if (s->kind == HK_IMPLICIT_FUNCTION) {
    s->evaluate(s->context, s->function, x, count, value);
    for (size_t k = 0; k < count; k++) value[k] = s->below ? s->level - value[k] : value[k] - s->level;
  } else {
    evaluate_some(&s->part[0], x, count, value);
    for (size_t p = 1; p < s->count; p++) {
      evaluate_some(&s->part[p], x, count, other);
      for (size_t k = 0; k < count; k++) value[k] = joined(s, value[k], other[k]);
    }
  }
}

void hk_implicit_evaluate(const hk_implicit_shape *s, const double (*x)[3], size_t count, double *value) {
  for (size_t k = 0; k < count; k += BATCH) evaluate_some(s, x + k, count - k < BATCH ? count - k : BATCH, value + k);
}

bool hk_implicit_has_function(const hk_implicit_shape *s) {
  bool has = s->kind == HK_IMPLICIT_FUNCTION;
  for (size_t k = 0; k < s->count && s->part; k++) has = has || hk_implicit_has_function(&s->part[k]);
  return has;
}

/* What joins two values rises with the first, and with the second or, of a difference, against it. */
void hk_implicit_bounds(const hk_implicit_shape *s, const double low[3], const double high[3], double range[2]) {
  double other[2];
  if (s->kind == HK_IMPLICIT_BLOBS) {
    bound_blobs(s, low, high, range);
    return;
  }
  hk_implicit_bounds(&s->part[0], low, high, range);
  for (size_t p = 1; p < s->count; p++) {
    bool against = s->kind == HK_IMPLICIT_DIFFERENCE;
    hk_implicit_bounds(&s->part[p], low, high, other);
    range[0] = joined(s, range[0], other[against ? 1 : 0]);
    range[1] = joined(s, range[1], other[against ? 0 : 1]);
  }
}

/* Beyond its box a shape of blobs is -1/2, and each rounded edge adds at most blend / 4: a union of too soft ones is
 * inside everywhere, and has no box. */
bool hk_implicit_box(const hk_implicit_shape *s, double low[3], double high[3]) {
  double l[3], h[3];
  bool there = false;
  if (s->kind == HK_IMPLICIT_UNION && s->blend * (double)(s->count - 1) >= 2) return false;
  for (int c = 0; c < 3; c++) low[c] = INFINITY, high[c] = -INFINITY;
  for (size_t k = 0; k < s->count; k++) {
    bool known = s->kind == HK_IMPLICIT_BLOBS || hk_implicit_box(&s->part[k], l, h);
    for (int c = 0; c < 3 && s->kind == HK_IMPLICIT_BLOBS; c++) {
      l[c] = s->blob[k].centre[c] - reach * s->blob[k].radius;
      h[c] = s->blob[k].centre[c] + reach * s->blob[k].radius;
    }
    if (!known && s->kind == HK_IMPLICIT_UNION) return false;
    if (!known && (s->kind == HK_IMPLICIT_INTERSECTION || k > 0)) continue;
    if (!known) return false;
    there = true;
    for (int c = 0; c < 3; c++) low[c] = fmin(low[c], l[c]), high[c] = fmax(high[c], h[c]);
    if (s->kind == HK_IMPLICIT_DIFFERENCE) return true;
  }
  return there;
}
