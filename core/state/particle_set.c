/* Replacement of the particles of the state by a set of particles: the state takes ownership of the arrays, surviving
 * particles keep their pins, and edges and triangles with dead particles are removed. */
#include "core/state/state.h"

#include <stdlib.h>
#include <string.h>

void hk_particle_set_free(hk_particle_set *set) {
  free(set->X);
  free(set->mass);
  free(set->id);
  free(set->group);
  *set = (hk_particle_set){0};
}

bool hk_particle_set_allocate(hk_particle_set *set, size_t n, size_t width) {
  if (!set->X || n > set->room) {
    size_t room = set->X ? n + n / 8 : n; /* what has changed before changes again */
    hk_particle_set_free(set);
    set->room = room;
    set->X = calloc((6 + width) * room + 1, sizeof *set->X);
    set->mass = calloc(room + 1, sizeof *set->mass);
    set->id = malloc((room + 1) * sizeof *set->id);
    set->group = malloc((room + 1) * sizeof *set->group);
  }
  set->n = n;
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

/* Pins and inverse masses as they were, with those of newborns, which are free. */
static bool adopt_pins(hk_state *s, const uint32_t *map, const hk_particle_set *set) {
  if (set->room > s->room) {
    double *inverse_mass = realloc(s->inverse_mass, (set->room + 1) * sizeof *inverse_mass);
    if (inverse_mass) s->inverse_mass = inverse_mass;
    uint8_t *pin = realloc(s->pin, (set->room + 1) * sizeof *pin);
    if (pin) s->pin = pin;
    if (!inverse_mass || !pin) return false;
  }
  size_t kept = hk_array_move(s->pin, s->pin, sizeof *s->pin, map, s->model.n);
  memset(s->pin + kept, HK_FREE, set->n - kept);
  return true;
}

hk_status hk_state_adopt(hk_state *s, const uint32_t *map, hk_particle_set *set, hk_error *error) {
  if (!adopt_pins(s, map, set)) {
    hk_error_set(error, HK_NO_MEMORY, "no memory for %zu particles", set->n);
    hk_particle_set_free(set);
    return HK_NO_MEMORY;
  }
  hk_particle_set_free(&s->spare);
  s->spare = (hk_particle_set){s->model.n, s->room, s->X, s->mass, s->id, s->group};
  s->X = set->X;
  s->mass = set->mass;
  s->id = set->id;
  s->group = set->group;
  s->room = set->room;
  s->model.n = set->n;
  *set = (hk_particle_set){0};
  s->model.edges.count = remap_tuples(&s->edge[0][0], s->model.edges.count, 2, map);
  s->model.triangles.count = remap_tuples(&s->triangle[0][0], s->model.triangles.count, 3, map);
  hk_state_refresh(s);
  return HK_OK;
}
