/* Gravitation of bodies that all attract each other, each pair once. */
#ifndef HK_MUTUAL_SUM_H
#define HK_MUTUAL_SUM_H

#include "plugins/common/gravity/gravity_bodies.h"

/* pull[c][k] = sum m_j d/s^3 of all others, scaled, in 1/m^2 kg, for each body k. False: there are too few bodies for
 * it, some do not attract, or a sum is not finite, as where with softening 0 two bodies are at one place; `pull` is
 * void then, and hk_direct_forces takes every pair twice, which names them. */
bool hk_mutual_pull(hk_gravity_bodies *);

#endif
