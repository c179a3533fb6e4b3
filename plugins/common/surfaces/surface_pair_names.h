/* The two members of a pair in words, by the ids of particles: "particle 3", "edge 3 4", "triangle 3 4 5". */
#ifndef HK_SURFACE_PAIR_NAMES_H
#define HK_SURFACE_PAIR_NAMES_H

#include "plugins/common/surfaces/surfaces.h"

typedef struct hk_surface_pair_names {
  char one[48], other[48];
} hk_surface_pair_names;

hk_surface_pair_names hk_surface_pair_name(const hk_surface_pair *, const uint32_t *id);

#endif
