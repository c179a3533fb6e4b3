/* The places at which surfaces pass through each other, for pictures. */
#ifndef HK_CROSSING_POINTS_H
#define HK_CROSSING_POINTS_H

#include "plugins/common/contact/untangling/contours.h"

#include "core/plugin/contact.h"

/* Of the edges and triangles of the curves, those that still intersect at x (n x 3): where, and the triangle's normal.
 */
void hk_crossing_points(const hk_contours *, const hk_surface_mesh *, const double *x, const hk_contact_points *);

#endif
