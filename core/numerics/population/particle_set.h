/* A set of particles that replaces those of the state, after births and deaths or from a file. */
#ifndef HK_PARTICLE_SET_H
#define HK_PARTICLE_SET_H

#include "core/engine/state/state.h"

typedef struct hk_particle_set {
  size_t n;
  double *X; /* (6 + width) n + 1 */
  double *mass;
  uint32_t *id; /* those of the state in its order, then others, increasing */
  uint32_t *group;
} hk_particle_set;

/* false: no memory; the set must be freed all the same */
bool hk_particle_set_allocate(hk_particle_set *, size_t n, size_t width);
void hk_particle_set_free(hk_particle_set *);
bool hk_state_reserve(hk_state *, size_t n); /* makes room for n particles; false: no memory, nothing has changed */
/* Moves old index i to map[i] (UINT32_MAX: removed), in the same order, in a state of n particles for which there is
 * room. The caller sets the rest of them, and remaps the indices in pins, plugins and matrices. */
void hk_state_move(hk_state *, const uint32_t *map, size_t n);
/* Replaces the particles by those of the set, old index i by map[i], and frees the set's arrays, also when it fails. */
hk_status hk_state_adopt(hk_state *, const uint32_t *map, hk_particle_set *, hk_error *error);

#endif
