/* A mesh that ends at the faces of the grid has triangles without an area there. So the grid goes on beyond the box,
 * and the faces of the box are a surface like any other. */
#include "core/scene/meshes/meshes.h"

#include <string.h>

enum { BATCH = 64 };

/* From the nearest face, m; below 0 beyond it. */
static double distance(const hk_boxed_shape *b, const double x[3]) {
  double least = INFINITY;
  for (int c = 0; c < 3; c++) least = fmin(least, fmin(x[c] - b->low[c], b->high[c] - x[c]));
  return least;
}

static void evaluate_some(const hk_boxed_shape *b, const double (*x)[3], size_t count, double *value) {
  double place[BATCH][3], inner[BATCH];
  size_t from[BATCH], within = 0;
  for (size_t k = 0; k < count; k++) {
    value[k] = distance(b, x[k]);
    if (value[k] < 0) continue;
    memcpy(place[within], x[k], sizeof place[within]);
    from[within++] = k;
  }
  if (within) hk_implicit_evaluate(b->shape, (const double(*)[3])place, within, inner);
  for (size_t k = 0; k < within; k++)
    if (!(inner[k] >= value[from[k]])) value[from[k]] = inner[k]; /* also NAN */
}

void hk_boxed_shape_evaluate(const void *boxed, const double (*x)[3], size_t count, double *value) {
  for (size_t k = 0; k < count; k += BATCH)
    evaluate_some(boxed, x + k, count - k < BATCH ? count - k : BATCH, value + k);
}

void hk_boxed_shape_bounds(const void *boxed, const double low[3], const double high[3], double range[2]) {
  const hk_boxed_shape *b = boxed;
  double least = INFINITY, most = INFINITY, l[3], h[3], inner[2];
  bool meets = true;
  for (int c = 0; c < 3; c++) {
    l[c] = fmax(low[c], b->low[c]), h[c] = fmin(high[c], b->high[c]);
    meets = meets && l[c] <= h[c];
    least = fmin(least, fmin(low[c] - b->low[c], b->high[c] - high[c]));
    most = fmin(most, fmin(fmin(high[c] - b->low[c], b->high[c] - low[c]), (b->high[c] - b->low[c]) / 2));
  }
  range[0] = least, range[1] = most;
  if (!meets) return;
  hk_implicit_bounds(b->shape, l, h, inner);
  double beyond = least < 0 ? fmin(most, 0) : -INFINITY; /* the shape has no part in what is beyond a face */
  range[0] = fmin(range[0], inner[0]), range[1] = fmax(fmin(range[1], inner[1]), beyond);
}
