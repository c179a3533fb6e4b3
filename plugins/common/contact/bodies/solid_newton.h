/* All impacts at once where they are many and of rigid bodies that nothing joins. */
#ifndef HK_SOLID_NEWTON_H
#define HK_SOLID_NEWTON_H

#include "plugins/common/contact/bodies/body_newton.h"

enum { HK_MANY_IMPACTS = 12 /* fewer the iteration for the law itself solves as fast */ };

/* Solves the impacts of a level that take part and have been met, as convex programs in the coordinates of the bodies
 * (cones/solid_program.h). *solved: false where they are few, or not all of such bodies and of what stands still, or
 * where the iteration did not end; nothing was changed then. `at`: n x 3, the place of the last linearisation. */
hk_status hk_solid_newton(hk_body_impacts *, hk_contact_solver *, const hk_body_newton_task *, const double *at,
                          bool *solved);

#endif
