/* Pressures that keep the density of a liquid by particles, by relaxed Jacobi iterations on its multipliers (Bender and
 * Koschier 2015, Divergence-free smoothed particle hydrodynamics, section 3), or where they also pull by conjugate gradients: impulses
 *     m_i dv_i = -(d rho/dx_i)^T a,   a >= 0 where they only push,
 * with which the density does not rise above that at rest within a step, rho + h d rho/dt <= rho0, or does not rise at
 * all where it is reached, d rho/dt <= 0. Walls that move answer (sph_bodies.h). Momentum of liquid and walls together
 * is kept, as impulses on a pair are opposite, and lie along its line.
 *
 * A liquid that fills all of its room has no arrangement but the lattice in which no density is above that at rest, so
 * pressures that only push would grow for ever. There they pull as well, and keep densities at their mean: what a
 * constant pressure would have to do is left out. */
#ifndef HK_SPH_PRESSURE_H
#define HK_SPH_PRESSURE_H

#include "plugins/common/sph/sph_bodies.h"
#include "plugins/common/sph/sph_list.h"

typedef struct hk_sph_pressure {
  hk_sph *sph;
  const hk_view *view; /* positions that the sums are of; velocities are not read */
  hk_sph_rows near;
  hk_sph_list *list;
  hk_sph_bodies *bodies;
  const double *before; /* n x 3, m/s, without the impulses */
  double (*v)[4];       /* n, m/s, with them, and 0 */
  double *a;      /* n, m^5/(kg s), multipliers by the mass that counts; kept from step to step as the first guess */
  double *excess, *residual, *direction, *trial; /* n, room of `pulls` */
  bool pulls;     /* the liquid fills its room */
  double h;       /* s: of the step for which densities are kept; 0: rates are */
  double longest; /* s: a density that is off is made good within this, also by a shorter step */
  size_t iterations;
  bool changed;   /* a solve has changed a velocity */
  double off;     /* what is left, by the density at rest, mean of what is under pressure: excess, or h0 d rho/dt */
  double density; /* kg/m^3, that is kept: at rest, or the mean where it pulls */
} hk_sph_pressure;

/* The list of the liquid, at the positions of the view, and what bodies answer, where the correction has them. */
hk_status hk_sph_pressure_begin(hk_sph_pressure *, const hk_view *view, const hk_correction *);
double hk_sph_pressure_mean(const hk_sph_pressure *); /* kg/m^3, of the liquid */
/* After it: the liquid turned out to fill its room. */
void hk_sph_pressure_pull(hk_sph_pressure *);
/* Changes v (n x 3) of the liquid until what is left is below `tolerance`, by the density at rest, within the time
 * `scale`, s, or `most` iterations are done. */
void hk_sph_pressure_solve(hk_sph_pressure *, double *v, double scale, double tolerance, size_t most);

#endif
