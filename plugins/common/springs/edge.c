#include "plugins/common/springs/edge.h"

#include <float.h>

/* Positions that a builder or a script computes are rounded some times each, so that lengths which are meant to be
 * equal differ by some units in the last place of the coordinates. */
static const double rounding = 16 * DBL_EPSILON;

static double largest(const hk_view *view, const uint32_t pair[2]) {
  double most = 0;
  for (int e = 0; e < 2; e++)
    for (int c = 0; c < 3; c++) most = fmax(most, fabs(view->x[3 * (size_t)pair[e] + c]));
  return most;
}

/* Whether the lengths differ by rounding alone; *length: the middle between the least and the largest. */
static bool are_equal(const hk_view *view, const hk_tuples *edges, double *length) {
  double least = INFINITY, most = 0, size = 0, d[3];
  for (size_t e = 0; e < edges->count; e++) {
    double l = hk_edge_difference(view->x, hk_tuple(edges, e), d);
    size = fmax(size, largest(view, hk_tuple(edges, e)));
    least = fmin(least, l);
    most = fmax(most, l);
    if (!(most - least <= rounding * size)) return false;
  }
  *length = least + (most - least) / 2;
  return edges->count > 0;
}

hk_status hk_edge_rest(const hk_host *host, const hk_view *view, const hk_tuples *edges, hk_per_tuple *rest) {
  if (rest->count) return HK_OK;
  double d[3], common;
  bool equal = are_equal(view, edges, &common);
  size_t count = equal ? 1 : edges->count;
  double *length = host->allocate(host, (count + 1) * sizeof *length);
  if (!length) return host->fail(host, HK_NO_MEMORY, "no memory for the rest lengths");
  for (size_t e = 0; e < count; e++) length[e] = equal ? common : hk_edge_difference(view->x, hk_tuple(edges, e), d);
  *rest = (hk_per_tuple){count, length};
  return HK_OK;
}
