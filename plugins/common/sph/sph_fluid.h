/* The equation of state of a weakly compressible liquid: J/kg as a function of the compression s = density / density at
 * rest, with the speed of sound c at rest. e(1) = e'(1) = 0, e''(1) = c^2.
 *   tait:      p = density0 c^2/7 (s^7 - 1) (Monaghan 1994, J. Comput. Phys. 110, equation 3.2),
 *              e = c^2/7 (s^6/6 + 1/s - 7/6), from which the factor (s - 1)^2 is taken out so that nothing cancels;
 *   quadratic: e = c^2/2 (s - 1)^2, p = density0 c^2 s^2 (s - 1), the least work. */
#ifndef HK_SPH_FLUID_H
#define HK_SPH_FLUID_H

#include "core/plugin/widest.h"

#include <stdbool.h>

typedef enum hk_sph_law { HK_SPH_QUADRATIC, HK_SPH_TAIT } hk_sph_law;
#define HK_SPH_LAWS "quadratic|tait"

/* e / c^2 */
static inline double hk_sph_energy(hk_sph_law law, double s) {
  double u = s - 1;
  if (law == HK_SPH_QUADRATIC) return u * u / 2;
  return u * u / (42 * s) * (6 + s * (5 + s * (4 + s * (3 + s * (2 + s)))));
}

/* de/ds / c^2 = p / (density0 c^2 s^2) */
HK_INLINE double hk_sph_energy_slope(hk_sph_law law, double s) {
  double s2 = s * s;
  return law == HK_SPH_QUADRATIC ? s - 1 : (s2 * s2 * s2 * s - 1) / (7 * s2);
}

/* d2e/ds2 / c^2 */
static inline double hk_sph_energy_curvature(hk_sph_law law, double s) {
  double s3 = s * s * s;
  return law == HK_SPH_QUADRATIC ? 1 : (5 * s3 * s + 2 / s3) / 7;
}

#endif
