/* Viscosity and pressure together. One after the other, a projection moves what is almost solid as if it were liquid:
 * what flows past a solid pushed it along, in a cavity of 64 mm by 2 mm in a minute with steps of 0.3 s. Where the
 * viscosity is not the same everywhere, so that the two do not commute, velocities u = V(u* - sum of grad q_k),  V: the
 * viscous step from there, are found with pressures that are added up, laplacian q_k = div V(u* - sum of grad q
 * before), Uzawa's iteration with the pressure of a projection method (Guermond, Minev, Shen 2006, An overview of
 * projection methods for incompressible flows, section 3), here by generalised conjugate residuals (Eisenstat, Elman,
 * Schultz 1983, SIAM J. Numer. Anal. 20, 345) with the last direction kept, until the next pressure would move nothing
 * stiff by 1e-3 of a cell in the step, or eight times. That one is applied as it is, so that nothing is left of the
 * divergence. */
#ifndef HK_VISCOUS_FLOW_H
#define HK_VISCOUS_FLOW_H

#include "plugins/common/liquid_viscosity/liquid_viscosity.h"

/* hk_liquid_shear and hk_liquid_project for a step of h, s; guess: as for the latter. The same errors. */
hk_status hk_viscous_flow(hk_liquid *, hk_liquid_viscosity *, double h, double *guess);
#endif
