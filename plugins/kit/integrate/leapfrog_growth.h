/* The growth factor of a step of leapfrog: that of its roots lambda = 1 + u on (x, h v, h^2 a), a = -w^2 x - g v.
 * Stable while (h w)^2 + 4 h g <= 4. */
#ifndef HK_LEAPFROG_GROWTH_H
#define HK_LEAPFROG_GROWTH_H

#include "plugins/kit/integrate/growth_factor.h"

#include <complex.h>
#include <math.h>

/* hb: where velocities turn, see hk_integrator.growth. Without damping the product of the roots is 1. */
static inline double hk_leapfrog_growth(double hw, double hg, double hb) {
  double z = hw * hw;
  double complex d = hg + hb * I;
  if (hb != 0) return hk_complex_polynomial_growth(3, (const double complex[]){z, 2 * z + d, 1 + z + 1.5 * d, 1});
  if (hg == 0) return hw <= 2 ? 1 : z / 2 - 1 + sqrt(z * (z / 4 - 1));
  return hk_polynomial_growth(3, (const double[]){z, 2 * z + hg, 1 + z + 1.5 * hg, 1});
}

#endif
