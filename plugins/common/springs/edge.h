/* What forces along edges share: the vector of an edge, which edges act, and rest lengths that the script left out. */
#ifndef HK_COMMON_EDGE_H
#define HK_COMMON_EDGE_H

#include "core/plugin.h"

/* From the first end to the second of x, n x 3, and its length; likewise for velocities. */
static inline double hk_edge_difference(const double *x, const uint32_t pair[2], double d[3]) {
  for (int c = 0; c < 3; c++) d[c] = x[3 * (size_t)pair[1] + c] - x[3 * (size_t)pair[0] + c];
  return sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
}

/* An edge acts when both its ends are among the particles that the force is for. */
static inline bool hk_edge_acts(const hk_view *view, const uint32_t pair[2]) {
  return !view->is_active || (view->is_active[pair[0]] && view->is_active[pair[1]]);
}

/* Fills rest lengths that were left out with those of the start, m. HK_NO_MEMORY. */
hk_status hk_edge_rest(const hk_host *, const hk_view *view, const hk_tuples *edges, hk_per_tuple *rest);

/* The edges as pairs. */
static inline const uint32_t (*hk_pairs(const hk_tuples *edges))[2] { return (const uint32_t(*)[2])edges->index; }

#endif
