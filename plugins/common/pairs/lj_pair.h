/* The Lennard-Jones pair with a shifted force, U(r) = V(r) - V(c) - (r - c) V'(c), V = 4 epsilon ((sigma/r)^12 -
 * (sigma/r)^6) (Allen and Tildesley 1987, equation 5.10a). Nearer than sigma/10000, where U is 4e48 epsilon, it is
 * continued as a parabola, so that everything is finite. */
#ifndef HK_LJ_PAIR_H
#define HK_LJ_PAIR_H

#include <math.h>
#include <stdbool.h>

typedef struct hk_lj_pair {
  double epsilon, sigma, cutoff; /* J, m, m */
  double force_cut, energy_cut;  /* N, J: -V' and V at the cut-off */
  double least2;                 /* m^2, where the parabola begins */
} hk_lj_pair;

typedef struct hk_pair_law {
  double energy, push, curvature; /* J, N/m, N/m: U, -U'/r, U'' */
} hk_pair_law;

void hk_lj_pair_prepare(hk_lj_pair *); /* from epsilon, sigma, cutoff */
/* The Hessian of U, xx, xy, xz, yy, yz, zz; with `definite` its part above 0. */
void hk_lj_pair_hessian(const hk_lj_pair *, const double d[3], double r2, bool definite, double H[6]);

static inline hk_pair_law hk_lj_bare(const hk_lj_pair *p, double r2) {
  double u = 1 / r2, s2 = p->sigma * p->sigma * u, s6 = s2 * s2 * s2, s12 = s6 * s6, e = p->epsilon;
  return (hk_pair_law){4 * e * (s12 - s6), 24 * e * (2 * s12 - s6) * u, 24 * e * (26 * s12 - 7 * s6) * u};
}

/* Below the cut-off. On the parabola U' is proportional to r. */
static inline hk_pair_law hk_lj_pair_at(const hk_lj_pair *p, double r2) {
  double end2 = fmax(r2, p->least2), r = sqrt(end2);
  hk_pair_law u = hk_lj_bare(p, end2);
  u.energy += (r - p->cutoff) * p->force_cut - p->energy_cut;
  u.push -= p->force_cut / r;
  if (r2 < end2) u.energy += u.push * (end2 - r2) / 2, u.curvature = -u.push;
  return u;
}

#endif
