/* Replaces the particles of a run by those of a file, in the state and wherever indices are stored. */
#include "core/numerics/population/population.h"
#include "core/run/storage/files.h"

#include <stdlib.h>

/* The map from old to new indices; particles of the scene that the set lacks have none. False: the set is not in the
 * state's order, with those that the scene does not know behind the others. */
static bool find_map(const hk_state *s, const hk_particle_set *set, uint32_t *map) {
  size_t next = 0;
  uint32_t i, born = 0;
  for (i = 0; i < s->model.n; i++) map[i] = UINT32_MAX;
  for (size_t j = 0; j < set->n; j++) {
    bool old = hk_state_index(s, set->id[j], &i);
    if (old ? born > 0 || i < next : set->id[j] <= born) return false;
    if (old)
      map[i] = (uint32_t)j, next = (size_t)i + 1;
    else
      born = set->id[j];
  }
  return true;
}

hk_status hk_install(hk_loop *loop, hk_particle_set *set) {
  size_t n_old = loop->state->model.n;
  uint32_t *map = malloc((n_old + 1) * sizeof *map);
  if (!map || !find_map(loop->state, set, map)) {
    hk_particle_set_free(set);
    hk_error_set(loop->error, map ? HK_IO : HK_NO_MEMORY,
                 map ? "the particles of the start state are not in the order of the scene's"
                     : "no memory for the start state");
    free(map);
    return loop->error->status;
  }
  hk_status status = hk_state_adopt(loop->state, map, set, loop->error);
  if (status == HK_OK) status = hk_dynamics_remap(loop->dynamics, map, n_old);
  free(map);
  return status;
}
