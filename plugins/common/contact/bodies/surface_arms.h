/* Where impacts of surfaces are rubbed. */
#ifndef HK_SURFACE_ARMS_H
#define HK_SURFACE_ARMS_H

#include "plugins/common/contact/bodies/body_system.h"
#include "plugins/common/contact/surfaces/surfaces.h"

/* Gives impacts of rigid bodies, as hk_impact_set has left them, their arms, which serve until the next call; without
 * friction none. HK_NO_MEMORY. */
hk_status hk_surface_arms_find(hk_body_impacts *, const hk_surface_mesh *, const hk_contact_solver *,
                               const hk_step_move *);

#endif
