/* One hinge: two triangles that share an edge. Its members are a, b, c, d: the edge runs from a to b, and c and d are
 * the corners opposite to it. */
#ifndef HK_HINGE_H
#define HK_HINGE_H

#include "core/plugin.h"

/* What a hinge is in a plane: lengths and areas alone, without its angle. */
typedef struct hk_hinge_shape {
  double length;  /* |b - a|, m */
  double area[2]; /* of a b c and of a b d, m^2 */
  double foot[2]; /* where c and d stand over the edge, in parts of it from a */
} hk_hinge_shape;

hk_hinge_shape hk_hinge_shape_of(const double *x, const uint32_t member[4]);

/* The angle between the triangles' normals, rad, in (-pi, pi]: 0 where they are flat, positive where d lies below the
 * side of a b c from which a, b, c run against the clock. Its gradient is infinite where a triangle has no area: then
 * false, with angle and gradient 0. `gradient` may be NULL. */
bool hk_hinge_angle(const double *x, const uint32_t member[4], double *angle, double (*gradient)[3]);

/* Whether the angle is less than a right one either way, at a small part of its price. */
bool hk_hinge_is_open(const double *x, const uint32_t member[4]);

/* H = d^2 angle/dx^2, 12 x 12, row-major; 0 where a triangle has no area. */
void hk_hinge_hessian(const double *x, const uint32_t member[4], double *H);

#endif
