/* With A what the short steps take (x being the eigenvalues of h^2 A), B and D the stiffness and damping of the rest, a
 * step is leapfrog's with
 *     h^2 K = psi(x) h^2 B + 2 (1 - c(x)),   h D = psi(x) h D + 2 eta (1 - c(x)),   psi(x) = 2 (1 - c(x)) / x,
 * which is similar to a symmetric matrix, as psi > 0; the last term bounds the damping of A in the mode,
 * which is at most eta h A with eta = min(retardation/h, h damping/x). Leapfrog is stable while h^2 K + 4 h D <= 4,
 * that is, in the sense of symmetric matrices, for all x psi ((h w)^2 + 4 h g) <= 2 (1 + c) - 8 eta (1 - c). The room
 * is that over psi; it is less for fewer short steps, so that the softest component counts. */
#include "plugins/common/local/local_filter.h"

double hk_local_filter(int p, double s, double x) {
  double z = hk_local_delta(p, s) - x / hk_local_omega(p, s);
  double c = z > 1 ? cosh(p * acosh(z)) : cos(p * acos(fmax(-1, z)));
  return c / cosh(s);
}

/* Beyond the first swing of c, whose least is all that counts, c is taken to be its least, and so it is beyond the
 * range of p, where components take more short steps. */
enum { SWING = 20 };

static double room_at(const hk_local_modes *m, int p, double s, double h, double x) {
  double c = x < fmin(SWING, hk_local_range(p, s)) ? hk_local_filter(p, s, x) : -1 / cosh(s);
  double eta = fmin(m->retardation / h, h * m->damping / x);
  return ((1 + c) / (1 - c) - 4 * eta) * x / 4;
}

double hk_local_room(const hk_local_modes *m, double s, double h) {
  int p = hk_local_count(h * h * m->softest, s);
  double most = h * h * m->stiffest, room = fmin(1, room_at(m, p, s, h, most));
  for (double x = 0.25; x < fmin(SWING + 0.5, most); x += 0.25) room = fmin(room, room_at(m, p, s, h, x));
  return room;
}
