/* Forces on each particle alone: with the loop over some particles, a force has `add` and `add_part`. */
#ifndef HK_PARTICLE_SUMS_H
#define HK_PARTICLE_SUMS_H

#include "plugins/common/parts/part_lists.h"

/* Adds to F the force on those that it acts on from `begin` to below `end` (view->active[begin] ..., or these particles
 * where there is no list), and returns their power, W. */
typedef double (*hk_range_body)(const void *force, const hk_view *view, size_t begin, size_t end, double *F);

/* F += one part, as hk_force.add_part does it, or HK_ALL_PARTS, on several threads, as hk_force.add; view->power gets
 * their power, the same bits for any number of threads. `force`: the argument of `body`. */
void hk_particle_sums_add(const hk_view *view, size_t part, hk_range_body body, const void *force, double *F);

/* Particle number k of those that a force acts on. */
static inline size_t hk_acting_particle(const hk_view *view, size_t k) { return view->active ? view->active[k] : k; }

#endif
