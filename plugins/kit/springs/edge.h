/* Functions shared by forces along edges: the vector of an edge, the test whether an edge acts, and default rest
 * lengths. */
#ifndef HK_COMMON_EDGE_H
#define HK_COMMON_EDGE_H

#include "core/plugin.h"

#include <float.h>

/* Squared lengths below this (distances below 1e-145 m) count as zero, since their reciprocal exceeds the range of
 * doubles. */
#define HK_SPRING_TINY 1e-290 /* m^2 */

/* The vector from the first end to the second, from x (n x 3), and its length; also for velocities. */
static inline double hk_edge_difference(const double *x, const uint32_t pair[2], double d[3]) {
  for (int c = 0; c < 3; c++) d[c] = x[3 * (size_t)pair[1] + c] - x[3 * (size_t)pair[0] + c];
  return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* An edge acts when the force acts on both its ends. */
static inline bool hk_edge_acts(const hk_view *view, const uint32_t pair[2]) {
  return !view->is_active || (view->is_active[pair[0]] && view->is_active[pair[1]]);
}

/* Whether edge e of the length l, m, has a strain above that at which it breaks; `breaking` without numbers: none does.
 */
static inline bool hk_edge_breaks(const hk_per_tuple *rest, const hk_per_tuple *breaking, size_t e, double l) {
  double L = hk_tuple_value(rest, e);
  return breaking->count && l - L > hk_tuple_value(breaking, e) * L;
}

/* Sets rest lengths that the script does not give to the lengths at the start, m: to one for all, where they differ by
 * the rounding of the positions alone. HK_NO_MEMORY. */
static inline hk_status hk_edge_rest(const hk_host *, const hk_view *view, const hk_tuples *edges, hk_per_tuple *rest);

/* The edges as pairs. */
static inline const uint32_t (*hk_pairs(const hk_tuples *edges))[2] { return (const uint32_t(*)[2])edges->index; }

/* ---- how ---- */

/* Positions that a builder or a script computes are rounded some times each, so that lengths which are meant to be
 * equal differ by some units in the last place of the coordinates. */
static const double hk_edge_rounding = 16 * DBL_EPSILON;

static inline double hk_edge_largest(const hk_view *view, const uint32_t pair[2]) {
  double most = 0;
  for (int e = 0; e < 2; e++)
    for (int c = 0; c < 3; c++) most = fmax(most, fabs(view->x[3 * (size_t)pair[e] + c]));
  return most;
}

/* Whether the lengths differ by rounding alone; *length: the middle between the least and the largest. */
static inline bool hk_edges_are_equal(const hk_view *view, const hk_tuples *edges, double *length) {
  double least = INFINITY, most = 0, size = 0, d[3];
  for (size_t e = 0; e < edges->count; e++) {
    double l = hk_edge_difference(view->x, hk_tuple(edges, e), d);
    size = fmax(size, hk_edge_largest(view, hk_tuple(edges, e)));
    least = fmin(least, l);
    most = fmax(most, l);
    if (!(most - least <= hk_edge_rounding * size)) return false;
  }
  *length = least + (most - least) / 2;
  return edges->count > 0;
}

static inline hk_status hk_edge_rest(const hk_host *host, const hk_view *view, const hk_tuples *edges,
                                     hk_per_tuple *rest) {
  if (rest->count) return HK_OK;
  double d[3], common;
  bool equal = hk_edges_are_equal(view, edges, &common);
  size_t count = equal ? 1 : edges->count;
  double *length = host->allocate(host, (count + 1) * sizeof *length);
  if (!length) return host->fail(host, HK_NO_MEMORY, "no memory for the rest lengths");
  for (size_t e = 0; e < count; e++) length[e] = equal ? common : hk_edge_difference(view->x, hk_tuple(edges, e), d);
  *rest = (hk_per_tuple){count, length};
  return HK_OK;
}

#endif
