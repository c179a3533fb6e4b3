/* Cohesion of a liquid by particles: an energy of pairs, V_i V_j phi(r), that pulls between the kernel's radius R and
 * one and a half of it and pushes nearer,
 *     phi(r) = b W(r; R) - a W(r; 1.5 R),
 * W the kernel (sph_kernel.h). Of a liquid cut in two, what its pairs lose across the cut is twice the tension
 * (Fowler 1937, Proc. R. Soc. A 159; Tartakovsky and Panchenko 2016, J. Comput. Phys. 305, section 3), with the mean
 * over all directions n of the cut:
 *     tension = -1/4 sum_d V phi(d) <|d.n|>,   <|d.n|> = |d|/2 in space, 2 |d|/pi in a plane.
 * Of all such functions that one is taken which holds the liquid together with
 *     -1/(2 dim) sum_d V phi'(d) |d| = -tension/spacing,
 * as much as Laplace's pressure in the smallest drop that particles show: with less, drops grow, since what their
 * surface has falls as the square of the density; with more, sound has to be faster. Sums are those over the lattice of
 * the particles' spacing.
 *
 * Such energies make a lattice of particles a little of a solid, the more the narrower they are: without an inner
 * pressure, a lattice sheared by a spacing has up to 0.015 tension/spacing a volume with radii of 2 and 3 spacings,
 * with 3 and 4.5 up to 0.001, which is why they are wide. */
#ifndef HK_SPH_COHESION_H
#define HK_SPH_COHESION_H

#include "plugins/common/sph/sph_kernel.h"

#define HK_SPH_COHESION_WIDER 1.5 /* radius of what pulls, by the kernel's */

typedef struct hk_sph_cohesion {
  hk_sph_kernel wide, narrow;
  double pull, push; /* a and b, J/m^3 */
} hk_sph_cohesion;

/* tension: N/m; the others as of hk_sph_kernel_prepare. */
void hk_sph_cohesion_prepare(hk_sph_cohesion *, double spacing, double reach, int dimensions, double tension);

/* J/m^6: phi at r^2, m^2. */
HK_INLINE double hk_sph_cohesion_energy(const hk_sph_cohesion *c, double r2) {
  return c->push * hk_sph_value(&c->narrow, r2) - c->pull * hk_sph_value(&c->wide, r2);
}

/* J/m^8: -phi'/r. */
HK_INLINE double hk_sph_cohesion_slope(const hk_sph_cohesion *c, double r2) {
  return c->push * hk_sph_slope(&c->narrow, r2) - c->pull * hk_sph_slope(&c->wide, r2);
}

/* J/m^8: phi''. */
HK_INLINE double hk_sph_cohesion_curvature(const hk_sph_cohesion *c, double r2) {
  return c->push * hk_sph_curvature(&c->narrow, r2) - c->pull * hk_sph_curvature(&c->wide, r2);
}

#endif
