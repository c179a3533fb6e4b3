/* The point in which two features are in contact, for pictures. */
#ifndef HK_CONTACT_POINT_H
#define HK_CONTACT_POINT_H

#include "plugins/common/collision/distance.h"

#include "core/plugin/contact.h"

/* Adds the middle between the nearest points of the pair x[12] if these are at most `reach` apart, and the direction
 * from the second feature to the first; none where the two are in one place. */
void hk_contact_point_of_pair(hk_pair_kind, const double x[12], double reach, const hk_contact_points *);

#endif
