/* Newton's iteration for all impacts at once. */
#ifndef HK_BODY_NEWTON_H
#define HK_BODY_NEWTON_H

#include "plugins/common/contact/bodies/body_system.h"

/* Solves all impacts of a level together that take part and have been met: `speeds`: their velocities, y = v; else y =
 * x. *solved: to the tolerance (m or m/s); else nothing was changed. */
hk_status hk_body_newton(hk_body_impacts *, hk_contact_solver *, bool speeds, double tolerance, double *y,
                         bool *solved);

#endif
