/* The places at which surfaces touch at the end of a step, for pictures. */
#ifndef HK_CLOSED_POINTS_H
#define HK_CLOSED_POINTS_H

#include "plugins/common/collision/contact_point.h"
#include "plugins/common/impacts/impact.h"
#include "plugins/common/impacts/nearby.h"

/* Of the pairs that the last step looked at, those that are at x (n x 3) at most (1 + slack) of their thickness apart.
 */
static inline void hk_closed_points(const hk_nearby *nearby, const double *x, double slack,
                                    const hk_contact_points *points) {
  double corner[12];
  for (size_t d = 0; d < nearby->dues; d++) {
    const hk_surface_pair *pair = &nearby->pair[nearby->index[d]];
    hk_pair_gather(corner, pair, x);
    hk_contact_point_of_pair(pair->kind, corner, (1 + slack) * pair->offset, points);
  }
}

#endif
