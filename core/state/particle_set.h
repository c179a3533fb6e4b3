/* Who takes the place of the particles in a run: after births and deaths, or from a file. */
#ifndef HK_MEMBERS_H
#define HK_MEMBERS_H

#include "core/run/engine.h"

typedef struct hk_particle_set {
  size_t n;
  double *X; /* (6 + width) n + 1 */
  double *mass;
  uint32_t *id; /* rising */
  uint32_t *group;
} hk_particle_set;

bool hk_particle_set_allocate(hk_particle_set *, size_t n, size_t width); /* false: no memory; free what there is */
void hk_particle_set_free(hk_particle_set *);
/* Old index i becomes map[i] (UINT32_MAX: gone). Takes the members' arrays, also when it fails, and remaps every list
 * of indices in the scene. */
hk_status hk_state_install(hk_run *, const uint32_t *map, hk_particle_set *members);

#endif
