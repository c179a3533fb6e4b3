/* How the curve along which surfaces intersect becomes shorter: contour minimisation (Volino and Magnenat-Thalmann
 * 2006, "Resolving surface collisions through intersection contour minimization", SIGGRAPH), along the exact gradient
 * of its length. */
#ifndef HK_SHORTENING_H
#define HK_SHORTENING_H

#include "plugins/common/contact/untangling/contours.h"

/* The direction in which the edge has to move relative to the triangle that it pierces for the curve to become shorter,
 * and the weights of the point on both: minus the gradient of its length. False: the two are parallel. */
bool hk_shortening(const hk_surface_mesh *, const double *x, const hk_contour_point *, double w[5],
                   double direction[3]);

#endif
