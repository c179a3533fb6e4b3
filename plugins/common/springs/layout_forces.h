/* The forces of the springs of a layout (plugins/kit/springs/spring_kernel.h) as one function, compiled once for the
 * methods that call it; the force `springs` and plugins outside have the loops themselves. */
#ifndef HK_LAYOUT_FORCES_H
#define HK_LAYOUT_FORCES_H

#include "plugins/kit/springs/spring_layout.h"

/* F += the forces; *power += the power of the damping, when `power` is not NULL. x, v, F: n x 3; m, m/s, N, W. */
void hk_layout_forces(const hk_spring_layout *, const hk_host *host, const double *x, const double *v, double *F,
                      double *power);

#endif
