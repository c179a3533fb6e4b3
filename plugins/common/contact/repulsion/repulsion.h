/* The force of a pair of surfaces whose gap is less than a reach r, by x = r - gap:
 *     E = k x^4/(12 r^2),   f = k x^3/(3 r^2),   N = f max(0, 1 - b dgap/dt),   T = -mu N u/sqrt(u^2 + s^2),
 * N along the normal and T across it, against the velocity u of one nearest point relative to the other. k is the
 * stiffness -df/dgap where surfaces touch; E has three continuous derivatives. Damping is Hunt's and Crossley's (1975):
 * slow impacts keep the part 1 - 2/3 b v of their speed v. Energies of two edges fade where these become parallel (Li
 * and others 2020, section 5), as their nearest points are not unique there; points and triangles take over. */
#ifndef HK_REPULSION_H
#define HK_REPULSION_H

#include "core/plugin.h"
#include "plugins/common/contact/geometry/feature_pair.h"

typedef struct hk_repulsion {
  double reach, stiffness; /* m, N/m */
  double damping;          /* b, s/m */
  double friction, slip;   /* mu; s, m/s */
} hk_repulsion;

/* A pair at the positions x and velocities v of its points. */
typedef struct hk_repelled {
  hk_feature_pair pair;
  double x[12], v[12];
  double mollified; /* m^4: the limit of the edges' mollifier; 0: none */
} hk_repelled;

double hk_repulsion_energy(const hk_repulsion *, const hk_repelled *);
/* F[3 i + c], N; returns false, and 0, where the pair is out of reach. *power: W, of damping and friction. */
bool hk_repulsion_force(const hk_repulsion *, const hk_repelled *, double F[12], double *power);
/* K = -dF/dx and D = -dF/dv, 12 x 12, row-major. `want`: HK_WANT_... False, and nothing set: out of reach. */
bool hk_repulsion_blocks(const hk_repulsion *, const hk_repelled *, unsigned want, double K[144], double D[144]);
/* N: the size of f at this gap. */
double hk_repulsion_size(const hk_repulsion *, double gap);

#endif
