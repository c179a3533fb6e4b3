/* Replaces the particles of a run by those of a file, in the state and wherever indices are stored. */
#include "core/storage/files.h"

#include <stdlib.h>

/* The map from old to new indices; particles of the scene that the set lacks have none. */
static uint32_t *map_to(const hk_state *s, const hk_particle_set *set) {
  uint32_t *map = malloc((s->model.n + 1) * sizeof *map);
  size_t j = 0;
  for (size_t i = 0; map && i < s->model.n; i++) {
    while (j < set->n && set->id[j] < s->id[i]) j++;
    map[i] = j < set->n && set->id[j] == s->id[i] ? (uint32_t)j : UINT32_MAX;
  }
  return map;
}

hk_status hk_install(hk_loop *loop, hk_particle_set *set) {
  size_t n_old = loop->state->model.n;
  uint32_t *map = map_to(loop->state, set);
  if (!map) {
    hk_particle_set_free(set);
    return hk_error_set(loop->error, HK_NO_MEMORY, "no memory for the start state");
  }
  hk_status status = hk_state_adopt(loop->state, map, set, loop->error);
  if (status == HK_OK) status = hk_dynamics_remap(loop->dynamics, map, n_old);
  free(map);
  return status;
}
