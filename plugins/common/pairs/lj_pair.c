#include "plugins/common/pairs/lj_pair.h"

static const double least = 1e-4; /* of sigma */

void hk_lj_pair_prepare(hk_lj_pair *p) {
  hk_pair_law end = hk_lj_bare(p, p->cutoff * p->cutoff);
  p->least2 = pow(least * p->sigma, 2);
  p->energy_cut = end.energy;
  p->force_cut = end.push * p->cutoff;
}

void hk_lj_pair_hessian(const hk_lj_pair *p, const double d[3], double r2, bool definite, double H[6]) {
  hk_pair_law u = hk_lj_pair_at(p, r2);
  double along = u.curvature, across = -u.push;
  if (definite) along = fmax(along, 0), across = fmax(across, 0);
  for (int a = 0, e = 0; a < 3; a++)
    for (int b = a; b < 3; b++, e++) H[e] = (r2 > 0 ? (along - across) * d[a] * d[b] / r2 : 0) + (a == b ? across : 0);
}
