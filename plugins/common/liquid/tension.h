/* Surface tension of a liquid, as the pressure at its free surface, sigma times the curvature. The projection has none
 * there, so the velocities get what such a pressure gives beforehand, -h/rho times its differences across faces: with
 * what the projection adds that is the ghost-fluid method with the jump interpolated to the surface (Kang, Fedkiw, Liu
 * 2000, A boundary condition capturing method for multiphase incompressible flow, section 3.2, with nothing above the
 * liquid). The curvature is the divergence of the normals of smoothed filled parts, in cells about the surface, carried
 * from there to the surface as that of parallel surfaces. At walls the surface stands at a right angle. */
#ifndef HK_TENSION_H
#define HK_TENSION_H

#include "plugins/common/liquid/liquid.h"

typedef struct hk_tension {
  double tension; /* N/m */
  double *part;   /* in cells: filled parts, smoothed; then their logarithms */
  double *other;  /* scratch of the same shape */
  double *bend;   /* in cells: curvature of the surface nearest to it, 1/m, positive where the liquid is round */
  uint8_t *known; /* in cells: whether it has one */
} hk_tension;

/* Gives velocities what the tension gives in a step of h, s; after hk_liquid_find_surface and before the projection.
 * HK_NO_MEMORY: with a message. */
hk_status hk_liquid_draw_in(hk_liquid *, hk_tension *, double h);
void hk_tension_close(hk_tension *, const hk_host *);

#endif
