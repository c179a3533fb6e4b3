/* Replacement of the particles of the state by a set of particles: the state takes ownership of the arrays, surviving
 * particles keep their pins, and edges and triangles with dead particles are removed. */
#include "core/state/state.h"

#include <stdlib.h>

void hk_particle_set_free(hk_particle_set *set) {
  free(set->X);
  free(set->mass);
  free(set->id);
  free(set->group);
  *set = (hk_particle_set){0};
}

bool hk_particle_set_allocate(hk_particle_set *set, size_t n, size_t width) {
  set->n = n;
  set->X = calloc((6 + width) * n + 1, sizeof *set->X);
  set->mass = calloc(n + 1, sizeof *set->mass);
  set->id = malloc((n + 1) * sizeof *set->id);
  set->group = malloc((n + 1) * sizeof *set->group);
  return set->X && set->mass && set->id && set->group;
}

/* Keeps the tuples without dead members; returns their number. */
static size_t remap_tuples(uint32_t *tuple, size_t count, size_t arity, const uint32_t *map) {
  size_t kept = 0;
  for (size_t k = 0; k < count; k++) {
    bool alive = true;
    for (size_t c = 0; c < arity; c++) alive = alive && map[tuple[arity * k + c]] != UINT32_MAX;
    for (size_t c = 0; alive && c < arity; c++) tuple[arity * kept + c] = map[tuple[arity * k + c]];
    kept += alive;
  }
  return kept;
}

hk_status hk_state_adopt(hk_state *s, const uint32_t *map, hk_particle_set *set, hk_error *error) {
  double *inverse_mass = malloc((set->n + 1) * sizeof *inverse_mass);
  uint8_t *pin = calloc(set->n + 1, sizeof *pin);
  if (!inverse_mass || !pin) {
    free(inverse_mass);
    free(pin);
    hk_error_set(error, HK_NO_MEMORY, "no memory for %zu particles", set->n);
    hk_particle_set_free(set);
    return HK_NO_MEMORY;
  }
  for (size_t i = 0; i < s->model.n; i++)
    if (map[i] != UINT32_MAX) pin[map[i]] = s->pin[i];
  hk_particle_set old = {0, s->X, s->mass, s->id, s->group};
  free(s->inverse_mass);
  free(s->pin);
  s->inverse_mass = inverse_mass;
  s->pin = pin;
  s->X = set->X;
  s->mass = set->mass;
  s->id = set->id;
  s->group = set->group;
  s->model.n = set->n;
  hk_particle_set_free(&old);
  *set = (hk_particle_set){0};
  s->model.edges.count = remap_tuples(&s->edge[0][0], s->model.edges.count, 2, map);
  s->model.triangles.count = remap_tuples(&s->triangle[0][0], s->model.triangles.count, 3, map);
  hk_state_refresh(s);
  return HK_OK;
}
