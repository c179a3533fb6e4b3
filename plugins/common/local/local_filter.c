/* With A what the short steps take (x being the eigenvalues of h^2 A), B and D the stiffness and damping of the rest, a
 * step is leapfrog's with
 *     h^2 K = psi(x) h^2 B + 2 (1 - c(x)),   h D = psi(x) h D + 2 eta (1 - c(x)),   psi(x) = 2 (1 - c(x)) / x,
 * which is similar to a symmetric matrix, as psi > 0; the last term bounds the damping of A, which is at most eta h A.
 * Leapfrog is stable while h^2 K + 4 h D <= 4, that is, in the sense of symmetric matrices, for all x
 *     psi ((h w)^2 + 4 h g) <= 2 (1 + c) - 8 eta (1 - c). */
#include "plugins/common/local/local_filter.h"

double hk_local_filter(int p, double x) {
  double z = hk_local_delta(p) - x / hk_local_omega(p);
  double c = z > 1 ? cosh(p * acosh(z)) : cos(p * acos(fmax(-1, z)));
  return c / cosh(hk_local_damping);
}

/* The least of it lies in the first swing of c, below x = 20; the later ones are alike, with more room. */
double hk_local_room(double eta) {
  double least = 1;
  for (double x = 0.125; x < 20; x += 0.125) {
    double c = hk_local_filter(HK_LOCAL_LEAST, x);
    least = fmin(least, ((1 + c) / (1 - c) - 4 * eta) * x / 4);
  }
  return fmax(0, least);
}
