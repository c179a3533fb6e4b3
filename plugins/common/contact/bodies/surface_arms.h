/* Where impacts of surfaces are rubbed, and what resists their rolling and spinning. */
#ifndef HK_SURFACE_ARMS_H
#define HK_SURFACE_ARMS_H

#include "plugins/common/contact/bodies/body_system.h"
#include "plugins/common/contact/surfaces/surfaces.h"

/* Gives impacts of rigid bodies, as hk_impact_set has left them, their arms, which serve until the next call; without
 * friction none. HK_NO_MEMORY. */
hk_status hk_surface_arms_find(hk_body_impacts *, const hk_surface_mesh *, const hk_contact_solver *,
                               const hk_step_move *);

/* Gives impacts of rigid bodies with each other and with what is pinned moments of rolling and spinning friction
 * (body_moments.h); the lengths are in m, and with both 0 there are none. HK_NO_MEMORY. */
hk_status hk_surface_moments_find(hk_body_impacts *, const hk_contact_solver *, const hk_step_move *, double rolling,
                                  double spinning);

#endif
