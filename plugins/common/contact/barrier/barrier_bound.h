/* How stiff contact may become, for the stable step of explicit methods. */
#ifndef HK_BARRIER_BOUND_H
#define HK_BARRIER_BOUND_H

#include "plugins/common/contact/barrier/barrier_contacts.h"

/* Adds to block[i] as hk_force.stiffness_bound asks. Of K: of every particle of the surfaces, with contacts all around
 * that are compressed to u = 1/10, or as far as the closest one now. */
void hk_barrier_bound(hk_barrier_contacts *, const hk_view *view, hk_stiffness_part, double (*block)[6]);

#endif
