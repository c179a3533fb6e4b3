/* The kernel of liquids by particles, Wendland's C2: W(r) = amplitude (1 - t)^4 (1 + 4 t), t = r/R, 0 for r >= R
 * (Wendland 1995, Adv. Comput. Math. 4; Dehnen and Aly 2012, Mon. Not. R. Astron. Soc. 425, table 1), in 1/m^3.
 *
 * The amplitude is not that of the integral, 21/(2 pi R^3), but that of the sum over a cubic lattice of the particles'
 * spacing, in a plane a square one that is one spacing deep: a liquid at rest on its lattice has its density exactly.
 * With R of 3 spacings that is 0.3 % less in space, and 0.5 % less in a plane. */
#ifndef HK_SPH_KERNEL_H
#define HK_SPH_KERNEL_H

#include "core/plugin/widest.h"

#include <math.h>

typedef struct hk_sph_kernel {
  double radius, radius2, inverse; /* R, m; m^2; 1/m */
  double amplitude;                /* 1/m^3, W(0) */
  double steepness;                /* 20 amplitude / R^2, 1/m^5, -W'/r at 0 */
  double second;                   /* sum of (-W'/r) r^2 V / d over the lattice, about 1: with it differences between
                                      pairs become a Laplacian */
  double fourth;                   /* m^2: sum of (-W'/r) r^4 V / (d (d + 2)) over the lattice, about R^2/9: the mean of
                                      (-W'/r) x^2 y^2, with which forces between pairs become a Laplacian */
} hk_sph_kernel;

/* spacing > 0, m; reach: R by the spacing, above 1; dimensions: 2 or 3 = d. */
void hk_sph_kernel_prepare(hk_sph_kernel *, double spacing, double reach, int dimensions);

/* r/R, at most 1; by a comparison, of which compilers make vectors where fmin stays a call. */
HK_INLINE double hk_sph_part(const hk_sph_kernel *k, double r2) {
  double t = sqrt(r2) * k->inverse;
  return t < 1 ? t : 1;
}

/* 1/m^3; at r^2, m^2. */
HK_INLINE double hk_sph_value(const hk_sph_kernel *k, double r2) {
  double t = hk_sph_part(k, r2), u = (1 - t) * (1 - t);
  return k->amplitude * u * u * (1 + 4 * t);
}

/* 1/m^5: -W'/r = 20 amplitude / R^2 (1 - t)^3, which is finite where two particles meet; grad W = -slope d. */
HK_INLINE double hk_sph_slope(const hk_sph_kernel *k, double r2) {
  double u = 1 - hk_sph_part(k, r2);
  return k->steepness * u * u * u;
}

/* 1/m^5: W'' = 20 amplitude / R^2 (1 - t)^2 (4 t - 1). */
HK_INLINE double hk_sph_curvature(const hk_sph_kernel *k, double r2) {
  double t = hk_sph_part(k, r2);
  return k->steepness * (1 - t) * (1 - t) * (4 * t - 1);
}

#endif
