/* Other particles in the state. After births and deaths those that live on are moved within its arrays, which have room
 * for some more; a set of particles from a file replaces the arrays. Surviving particles keep their pins, and edges and
 * triangles with dead particles are removed. */
#include "core/numerics/population/population.h"

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

static void remap_edges(hk_state *s, const uint32_t *map) {
  s->model.edges.count = remap_tuples(&s->edge[0][0], s->model.edges.count, 2, map);
  s->model.triangles.count = remap_tuples(&s->triangle[0][0], s->model.triangles.count, 3, map);
}

/* Pins as they were; particles beyond them are free. */
static void move_pins(hk_state *s, const uint32_t *map, size_t n) {
  size_t kept = hk_array_move(s->pin, s->pin, sizeof *s->pin, map, s->model.n);
  memset(s->pin + kept, HK_FREE, n - kept);
}

static bool grow(void *array, size_t bytes) {
  void *old, *grown;
  memcpy(&old, array, sizeof old);
  grown = realloc(old, bytes);
  if (grown) memcpy(array, &grown, sizeof grown);
  return grown;
}

static bool grow_numbers(hk_state *s, double **array, size_t count) {
  double *grown = *array ? hk_memory_get(&s->numbers, count * sizeof *grown) : NULL;
  if (!grown) return !*array;
  memcpy(grown, *array, hk_memory_size(*array));
  hk_memory_put(&s->numbers, *array);
  *array = grown;
  return true;
}

bool hk_state_reserve(hk_state *s, size_t n) {
  size_t room = n + n / 8;
  if (n <= s->room) return true;
  size_t size = (6 + s->width) * room + 1;
  bool fine = grow_numbers(s, &s->X, size) && grow_numbers(s, &s->spare, size) && grow_numbers(s, &s->mass, room + 1) &&
              grow_numbers(s, &s->inverse_mass, room + 1) && grow(&s->id, (room + 1) * sizeof *s->id) &&
              grow(&s->group, (room + 1) * sizeof *s->group) && grow(&s->pin, (room + 1) * sizeof *s->pin) &&
              (!s->by_id || grow(&s->by_id, (room + 1) * sizeof *s->by_id));
  if (fine) s->room = room;
  hk_state_point(s); /* some arrays may have moved even so */
  return fine;
}

/* Who is left in the order of ids, and behind them the particles that are new. */
static void move_order(hk_state *s, const uint32_t *map, size_t n) {
  size_t kept = 0;
  for (size_t k = 0; k < s->model.n; k++)
    if (map[s->by_id[k]] != UINT32_MAX) s->by_id[kept++] = map[s->by_id[k]];
  for (; kept < n; kept++) s->by_id[kept] = (uint32_t)kept;
}

/* Moves the block of X that begins at `offset` numbers per particle. */
static void move_block(hk_state *s, size_t offset, size_t width, const uint32_t *map, size_t n) {
  hk_array_move(s->X + offset * n, s->X + offset * s->model.n, width * sizeof *s->X, map, s->model.n);
}

void hk_state_move(hk_state *s, const uint32_t *map, size_t n) {
  size_t old = s->model.n, blocks = 2 + s->model.channels;
  double work = s->X[s->size - 1];
  for (size_t b = 0; b < blocks; b++) {
    size_t k = n > old ? blocks - 1 - b : b; /* a block moves to where another one has left */
    if (k < 2)
      move_block(s, 3 * k, 3, map, n);
    else
      move_block(s, 6 + s->channel[k - 2].offset, s->channel[k - 2].size, map, n);
  }
  hk_array_move(s->mass, s->mass, sizeof *s->mass, map, old);
  hk_array_move(s->inverse_mass, s->inverse_mass, sizeof *s->inverse_mass, map, old);
  hk_array_move(s->id, s->id, sizeof *s->id, map, old);
  hk_array_move(s->group, s->group, sizeof *s->group, map, old);
  move_pins(s, map, n);
  if (s->by_id) move_order(s, map, n);
  remap_edges(s, map);
  s->model.n = n;
  hk_state_point(s);
  s->X[s->size - 1] = work;
}

hk_status hk_state_adopt(hk_state *s, const uint32_t *map, hk_particle_set *set, hk_error *error) {
  if (!hk_state_reserve(s, set->n)) {
    hk_error_set(error, HK_NO_MEMORY, "no memory for %zu particles", set->n);
    hk_particle_set_free(set);
    return HK_NO_MEMORY;
  }
  hk_state_move(s, map, set->n);
  memcpy(s->X, set->X, s->size * sizeof *s->X);
  memcpy(s->mass, set->mass, set->n * sizeof *s->mass);
  memcpy(s->id, set->id, set->n * sizeof *s->id);
  memcpy(s->group, set->group, set->n * sizeof *s->group);
  hk_particle_set_free(set);
  hk_state_refresh(s);
  return HK_OK;
}
