/* Impulses on the mean velocities of a step after Bridson, Fedkiw and Anderson 2002, sections 6 and 7, one pair after
 * the other. An impulse I along n changes the normal speed by I times the pair's mobility, for any masses; the paper's
 * bound of the repulsion, (0.1 d/h - u) in its formula for equal masses, is then kept exactly. */
#ifndef HK_PROXIMITY_H
#define HK_PROXIMITY_H

#include "plugins/common/contact/impulses/gauss_seidel.h"

typedef struct hk_proximity {
  double h;         /* s */
  double stiffness; /* N/m, of the repulsion */
  double friction, restitution;
  const double *inverse_mass;
} hk_proximity;

/* Pairs that are nearer than their thickness at the start, by d: an approach is stopped, and they are pushed apart with
 * the impulse h k d, but to a speed of no more than 0.1 d/h. Changes u, n x 3; returns the sum of the impulses, N s. */
double hk_proximity_repel(const hk_proximity *, const hk_contact_solver *, double *u);
/* Pairs that would pass: an approach is turned by the restitution. */
double hk_proximity_collide(const hk_proximity *, const hk_contact_solver *, double *u);

#endif
