/* Gravitation by the sum over all pairs. Each target's sum has an order that follows from the bodies alone, so it has
 * the same bits for any number of threads. */
#ifndef HK_DIRECT_SUM_H
#define HK_DIRECT_SUM_H

#include "plugins/common/gravity/gravity_bodies.h"

/* F += G m_i sum_j m_j d/s^3. False: with softening 0 two bodies are at one place; F is then not complete. */
bool hk_direct_forces(hk_gravity_bodies *, double G, double *F);
/* The first such pair, which `met` has one of. */
void hk_gravity_coincident(const hk_gravity_bodies *, uint32_t pair[2]);
/* Sets `met` from the first `parts` of `part`; whether there are none. */
bool hk_gravity_apart(hk_gravity_bodies *, size_t parts);
double hk_direct_energy(hk_gravity_bodies *, double G); /* J, -G sum m_i m_j/s over pairs */
/* pull[k] = G sum_j m_j/s^3 of body k, 1/s^2. */
void hk_direct_stiffness(hk_gravity_bodies *, double G, double *pull);

#endif
