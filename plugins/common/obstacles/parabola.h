/* The way of a particle past one obstacle, in the obstacle's frame: a parabola, and where it first meets the surface.
 *
 * Outside a convex shape the distance is never below its tangent: along p(t) = p + w t + a t^2/2 it is at least
 * g + (n.w) t + (n.a) t^2/2, with g and n those of a point on the way. So the first root of that quadratic is a safe
 * step; from there it goes on. For a plane the first step is exact, for other shapes steps converge as Newton's do,
 * from outside, and no obstacle is too thin for them. In shapes that
 * are not convex the way is halved until the distance, which changes by no more than the way, shows it to be clear, or
 * until a piece is shorter than 1e-4 of the shape. */
#ifndef HK_PARABOLA_H
#define HK_PARABOLA_H

#include "plugins/common/obstacles/shape.h"

typedef struct hk_parabola {
  double p[3], w[3], a[3]; /* m, m/s, m/s^2 */
  double span;             /* s, t runs from 0 to here */
} hk_parabola;

void hk_parabola_at(const hk_parabola *, double t, double p[3], double w[3]);
/* The time at which the way first meets what is nearer than `radius`, moving towards it, up to `tolerance` (m);
 * INFINITY: it does not. */
double hk_parabola_contact(const hk_parabola *, const hk_shape *, double radius, double tolerance);
/* Whether a particle at p moves towards the surface, or lies still on it and is pressed to it. */
bool hk_parabola_closes(const hk_parabola *, const double w[3], const double n[3]);

#endif
