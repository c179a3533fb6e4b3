/* Who takes the place of the particles in a run: after births and deaths, or from a file. */
#ifndef HK_MEMBERS_H
#define HK_MEMBERS_H

#include "core/engine.h"

typedef struct hk_members {
  size_t n;
  double *X; /* (6 + width) n + 1 */
  double *mass;
  uint32_t *id; /* rising */
  uint32_t *group;
} hk_members;

bool hk_members_allocate(hk_members *, size_t n, size_t width); /* false: no memory; free what there is */
void hk_members_free(hk_members *);
/* Old index i becomes map[i] (UINT32_MAX: gone). Takes the members' arrays, also when it fails, and remaps every list
 * of indices in the scene. */
hk_status hk_state_install(hk_run *, const uint32_t *map, hk_members *members);

#endif
