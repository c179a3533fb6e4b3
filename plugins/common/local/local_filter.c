/* With A what the short steps take (x being the eigenvalues of h^2 A), B and D the stiffness and damping of the rest, a
 * step is leapfrog's with
 *     h^2 K = psi(x) h^2 B + 2 (1 - c(x)),   h D = psi(x) h D + 2 eta (1 - c(x)),   psi(x) = 2 (1 - c(x)) / x,
 * which is similar to a symmetric matrix, as psi > 0; the last term bounds the damping of A in the mode,
 * which is at most eta h A with eta = min(retardation/h, h damping/x). Leapfrog is stable while h^2 K + 4 h D <= 4,
 * that is, in the sense of symmetric matrices, for all x psi ((h w)^2 + 4 h g) <= 2 (1 + c) - 8 eta (1 - c). The room
 * is that over psi, and least for the fewest short steps. */
#include "plugins/common/local/local_filter.h"

double hk_local_filter(int p, double x) {
  double z = hk_local_delta(p) - x / hk_local_omega(p);
  double c = z > 1 ? cosh(p * acosh(z)) : cos(p * acos(fmax(-1, z)));
  return c / cosh(hk_local_damping);
}

/* (1 + c)/(1 - c), or, beyond the first swing of c, whose least is all that counts, its least. */
static double ratio(double x) {
  double c = x < 20 ? hk_local_filter(HK_LOCAL_LEAST, x) : -1 / cosh(hk_local_damping);
  return (1 + c) / (1 - c);
}

static double room_at(const hk_local_modes *m, double h, double x) {
  double eta = fmin(m->retardation / h, h * m->damping / x);
  return (ratio(x) - 4 * eta) * x / 4;
}

double hk_local_room(const hk_local_modes *m, double h) {
  double most = h * h * m->stiffest, least = fmin(1, room_at(m, h, most));
  for (double x = 0.25; x < fmin(most, 20); x += 0.25) least = fmin(least, room_at(m, h, x));
  return least;
}
