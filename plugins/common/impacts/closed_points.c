#include "plugins/common/impacts/closed_points.h"

#include "plugins/common/collision/contact_point.h"
#include "plugins/common/impacts/impact.h"

void hk_closed_points(const hk_nearby *nearby, const double *x, double slack, const hk_contact_points *points) {
  double corner[12];
  for (size_t d = 0; d < nearby->dues; d++) {
    const hk_surface_pair *pair = &nearby->pair[nearby->index[d]];
    hk_pair_gather(corner, pair, x);
    hk_contact_point_of_pair(pair->kind, corner, (1 + slack) * pair->offset, points);
  }
}
