/* Shapes of obstacles by their signed distance: the distance to the surface, negative inside, with the outward normal,
 * which is its gradient. Points are in the shape's own frame: the centre at the origin, axes along x, y, z; the axis of
 * a cylinder or capsule is z; a plane goes through the origin. */
#ifndef HK_SHAPE_H
#define HK_SHAPE_H

#include "plugins/common/obstacles/surface.h"

#include "core/plugin.h"

typedef enum hk_shape_kind {
  HK_SHAPE_PLANE,
  HK_SHAPE_SPHERE,
  HK_SHAPE_BOX,
  HK_SHAPE_CYLINDER,
  HK_SHAPE_CAPSULE,
  HK_SHAPE_MESH
} hk_shape_kind;

#define HK_SHAPE_NAMES "plane|sphere|box|cylinder|capsule|mesh"

typedef struct hk_shape {
  hk_shape_kind kind;
  double normal[3];          /* of a plane, of length 1 */
  double half[3];            /* m, half of the extents along x, y, z */
  bool hollow;               /* particles are kept inside: the distance and the normal are turned round */
  const hk_surface *surface; /* of a mesh */
} hk_shape;

/* m; n: the normal, of length 1 everywhere (where the distance has a kink, that of one side). */
double hk_shape_distance(const hk_shape *, const double p[3], double n[3]);
/* Whether the distance is a convex function: then the plane through the nearest point of the surface is never behind
 * the surface, seen from outside. */
static inline bool hk_shape_is_convex(const hk_shape *s) {
  return s->kind == HK_SHAPE_PLANE || (!s->hollow && s->kind != HK_SHAPE_MESH);
}
/* m, the largest of the extents; 0 for a plane. */
double hk_shape_size(const hk_shape *);

#endif
