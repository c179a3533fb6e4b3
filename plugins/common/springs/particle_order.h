/* An order of particles in which particles joined by edges are near each other, so that their data share caches when
 * ids do not follow positions. */
#ifndef HK_PARTICLE_ORDER_H
#define HK_PARTICLE_ORDER_H

#include "core/plugin.h"

/* place[i], 0 <= place[i] < n: clusters of CLUSTER joined particles, each beside one that it touches. Linear in n and
 * in the number of edges; false when there is no memory. */
bool hk_particle_order(const hk_host *host, size_t n, const hk_tuples *edges, uint32_t *place);

#endif
