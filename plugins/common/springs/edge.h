/* Functions shared by forces along edges: the vector of an edge, the test whether an edge acts, and default rest
 * lengths. */
#ifndef HK_COMMON_EDGE_H
#define HK_COMMON_EDGE_H

#include "core/plugin.h"

/* The vector from the first end to the second, from x (n x 3), and its length; also for velocities. */
static inline double hk_edge_difference(const double *x, const uint32_t pair[2], double d[3]) {
  for (int c = 0; c < 3; c++) d[c] = x[3 * (size_t)pair[1] + c] - x[3 * (size_t)pair[0] + c];
  return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* An edge acts when the force acts on both its ends. */
static inline bool hk_edge_acts(const hk_view *view, const uint32_t pair[2]) {
  return !view->is_active || (view->is_active[pair[0]] && view->is_active[pair[1]]);
}

/* Sets rest lengths that the script does not give to the lengths at the start, m: to one for all, where they differ by
 * the rounding of the positions alone. HK_NO_MEMORY. */
hk_status hk_edge_rest(const hk_host *, const hk_view *view, const hk_tuples *edges, hk_per_tuple *rest);

/* The edges as pairs. */
static inline const uint32_t (*hk_pairs(const hk_tuples *edges))[2] { return (const uint32_t(*)[2])edges->index; }

#endif
