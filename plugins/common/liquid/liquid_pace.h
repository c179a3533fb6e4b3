/* How fast a liquid is, and the longest step that it allows. */
#ifndef HK_LIQUID_PACE_H
#define HK_LIQUID_PACE_H

#include "plugins/common/liquid/liquid.h"

typedef struct hk_liquid_pace {
  double pull[3]; /* m/s^2, mean acceleration by forces, of the start: what obstacles give in a step would go to
                     infinity with shorter ones */
  double passed;  /* cells that a particle passed in a step, the most so far */
} hk_liquid_pace;

/* Cells that the fastest particle passes in a step of h, s. */
double hk_liquid_courant(const hk_liquid *, const hk_liquid_particles *, double h);
/* pull from n x 3 accelerations of the scene, m/s^2; or, as long as it is 0, from velocities, n x 3, before and after a
 * step of h, s. */
void hk_liquid_pull(hk_liquid_pace *, const hk_liquid_particles *, const double *acceleration);
void hk_liquid_pull_between(hk_liquid_pace *, const hk_liquid_particles *, const double *before, double h);
/* s, in which neither a particle in free fall, nor a wave on the liquid's depth, sqrt(g d), passes more than `courant`
 * cells; nor, with a tension above 0, N/m, the shortest waves by it half a period: sqrt(rho h^3 / (4 pi sigma)) with
 * nothing above the liquid (Brackbill, Kothe, Zemach 1992, eq. 61). INFINITY: it is at rest, and nothing pulls. */
double hk_liquid_longest_step(const hk_liquid *, const hk_liquid_pace *, const hk_liquid_particles *, double courant,
                              double tension);
/* The part that hk_liquid_even gets for a step of h, s: 1 for what passes half a cell or more. By steps, not by time,
 * it had no limit for short ones: cells are denser and thinner by chance, and beside the surface the denser alone are
 * evened, so that a viscous current over a floor was 7 % slower with 8 times the steps (3 % now). off: the error of
 * the volume by the largest that may be, NAN: not known; near 1 the part is 1, as a source may bring more than goes by
 * time. */
double hk_liquid_part_to_even(const hk_liquid *, const hk_liquid_pace *, const hk_liquid_particles *, double h,
                              double off);

#endif
