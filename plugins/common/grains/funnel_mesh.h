/* The funnel of soft_walls as a surface, for outputs: two cones about an upright axis that meet in the neck. */
#ifndef HK_FUNNEL_MESH_H
#define HK_FUNNEL_MESH_H

#include "plugins/common/obstacles/obstacle.h"

enum { HK_FUNNEL_RINGS = 3, HK_FUNNEL_SIDES = 64 };

typedef struct hk_funnel_mesh {
  double vertex[HK_FUNNEL_RINGS * HK_FUNNEL_SIDES][3];
  uint32_t face[2 * (HK_FUNNEL_RINGS - 1) * HK_FUNNEL_SIDES][3];
  hk_surface surface; /* of these lists; it knows no distances */
  hk_obstacle obstacle;
} hk_funnel_mesh;

/* From the height `low`, at most that of the neck, to `high`, at least that. `funnel`: x, y and z of the middle of the
 * neck, its radius, slope. */
void hk_funnel_mesh_make(hk_funnel_mesh *, const double funnel[5], double low, double high);

#endif
