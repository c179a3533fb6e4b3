/* Pressures that keep the density of a liquid by particles, by relaxed Jacobi iterations on its multipliers (Bender and
 * Koschier 2015, Divergence-free smoothed particle hydrodynamics, section 3): impulses
 *     m_i dv_i = -(d rho/dx_i)^T a,   a >= 0,
 * with which the density does not rise above that at rest within a step, rho + h d rho/dt <= rho0, or does not rise at
 * all where it is reached, d rho/dt <= 0. Momentum and angular momentum of liquid and walls together are kept, as
 * impulses lie along the lines of pairs; walls do not move by them. */
#ifndef HK_SPH_PRESSURE_H
#define HK_SPH_PRESSURE_H

#include "plugins/common/sph/sph_list.h"

typedef struct hk_sph_pressure {
  hk_sph *sph;
  const hk_view *view; /* positions that the sums are of; velocities are not read */
  hk_sph_rows near;
  hk_sph_list *list;
  const double *before; /* n x 3, m/s, without the impulses */
  double (*v)[4];       /* n, m/s, with them, and 0 */
  double *a;      /* n, m^5/(kg s), multipliers by the mass that counts; kept from step to step as the first guess */
  double h;       /* s: of the step for which densities are kept; 0: rates are */
  double longest; /* s: a density that is off is made good within this, also by a shorter step */
  size_t iterations;
  bool changed; /* a solve has changed a velocity */
  double off;   /* what is left, by the density at rest, mean of what is under pressure: excess, or h0 d rho/dt */
} hk_sph_pressure;

/* The list of the liquid, at the positions of the view. */
hk_status hk_sph_pressure_begin(hk_sph_pressure *, const hk_view *view);
/* Changes v (n x 3) of the liquid until what is left is below `tolerance`, by the density at rest, within the time
 * `scale`, s, or `most` iterations are done. */
void hk_sph_pressure_solve(hk_sph_pressure *, double *v, double scale, double tolerance, size_t most);

#endif
