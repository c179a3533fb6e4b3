/* What comes into a liquid, goes out of it, and leaks through what should hold it. */
#ifndef HK_LIQUID_BALANCE_H
#define HK_LIQUID_BALANCE_H

#include "plugins/common/liquid/liquid.h"

/* kg, since the start. All is saved in checkpoints. */
typedef struct hk_liquid_balance {
  int64_t number;       /* of particles that are the liquid */
  double held;          /* of these: what there was, and came, less what went */
  double came, went;    /* by births and deaths, and of particles that became the liquid or ceased to be it */
  double leaked;        /* through obstacles */
  double leaked_before; /* the last step, which may be made again */
} hk_liquid_balance;

/* Takes note of the particles that are the liquid now; counted, n: the mass that was counted of each, 0: none, as of a
 * newborn. With `first` they are what there is at the start. */
void hk_liquid_balance_count(hk_liquid_balance *, const hk_liquid_particles *, size_t n, bool first, double *counted);
/* Adds what hk_liquid_move took through obstacles; again: in a step that is made for the second time. */
void hk_liquid_balance_leak(hk_liquid_balance *, const hk_liquid *, const hk_liquid_particles *, bool again);
/* Whether the straight way of a particle, as the obstacle sees it, goes in on one side and out on the other. */
bool hk_liquid_passes(const hk_obstacle *, const double from[3], const double to[3]);
/* m^3, of the space below the surface and outside of walls at the start of the last step, to the order 2 of a cut by a
 * plane; drops of less than half a cell are not in it. NAN: no step was made. */
double hk_liquid_volume(const hk_liquid *);

#endif
