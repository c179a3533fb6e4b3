/* The places at which surfaces touch at the end of a step, for pictures. */
#ifndef HK_CLOSED_POINTS_H
#define HK_CLOSED_POINTS_H

#include "plugins/common/impacts/nearby.h"

#include "core/plugin/contact.h"

/* Of the pairs that the last step looked at, those that are at x (n x 3) at most (1 + slack) of their thickness apart.
 */
void hk_closed_points(const hk_nearby *, const double *x, double slack, const hk_contact_points *);

#endif
