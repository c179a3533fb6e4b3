/* Births and deaths. A source requests them during `emit`, and they take effect when it returns: dead particles are
 * removed, the others keep their order, and new particles are appended with new ids. Invariant: before and after a
 * change all arrays have the same n. */
#include "core/state/state.h"

#include <stdlib.h>
#include <string.h>

static hk_status refuse(hk_population_change *c, hk_status status, const char *what, double value) {
  return c->source->host.fail(&c->source->host, status, "%s (%g)", what, value);
}

static hk_status check_birth(hk_population_change *c, const hk_birth *b) {
  if (!(b->mass > 0) || !isfinite(b->mass))
    return refuse(c, HK_FAILED, "a newborn's mass must be positive, kg", b->mass);
  for (int k = 0; k < 3; k++) {
    if (!isfinite(b->position[k])) return refuse(c, HK_FAILED, "a newborn's position must be finite", b->position[k]);
    if (!isfinite(b->velocity[k])) return refuse(c, HK_FAILED, "a newborn's velocity must be finite", b->velocity[k]);
  }
  if (b->group >= c->state->model.groups) return refuse(c, HK_FAILED, "a newborn's group does not exist", b->group);
  if (c->state->next_id + c->births >= UINT32_MAX - 1) return refuse(c, HK_FAILED, "ids are used up", UINT32_MAX);
  return HK_OK;
}

static void initial_channels(const hk_population_change *c, double *into) {
  for (size_t k = 0; k < c->scene->channels; k++) {
    const hk_channel_spec *spec = &c->scene->channel[k];
    memcpy(into + c->state->channel[k].offset, spec->initial, spec->size * sizeof *into);
  }
}

static hk_status add_birth(hk_population *population, const hk_birth *birth, uint32_t *id) {
  hk_population_change *c = (hk_population_change *)(void *)population;
  size_t width = c->state->width;
  hk_status status = check_birth(c, birth);
  if (status != HK_OK) return status;
  void *list = c->birth, *channel = c->channel;
  int failed = hk_array_reserve(&list, &c->capacity, c->births + 1, sizeof *c->birth);
  c->birth = list;
  if (!failed && width)
    failed = hk_array_reserve(&channel, &c->channel_capacity, (c->births + 1) * width, sizeof(double));
  c->channel = channel;
  if (failed) return refuse(c, HK_NO_MEMORY, "no memory for births", (double)c->births);
  c->birth[c->births] = *birth;
  if (width && birth->channel)
    memcpy(c->channel + c->births * width, birth->channel, width * sizeof(double));
  else if (width)
    initial_channels(c, c->channel + c->births * width);
  if (id) *id = c->state->next_id + (uint32_t)c->births;
  c->births++;
  return HK_OK;
}

static hk_status take(hk_population *population, uint32_t index) {
  hk_population_change *c = (hk_population_change *)(void *)population;
  if (index >= c->state->model.n) return refuse(c, HK_FAILED, "there is no particle of that index to remove", index);
  if (!c->dies) c->dies = calloc(c->state->model.n, sizeof *c->dies);
  if (!c->dies) return refuse(c, HK_NO_MEMORY, "no memory for deaths", index);
  c->deaths += !c->dies[index];
  c->dies[index] = true;
  return HK_OK;
}

static uint32_t *make_map(const hk_population_change *c) {
  size_t n = c->state->model.n;
  uint32_t *map = malloc((n + 1) * sizeof *map), next = 0;
  for (size_t i = 0; map && i < n; i++) map[i] = c->dies && c->dies[i] ? UINT32_MAX : next++;
  return map;
}

/* Copies one block of `width` numbers per particle to the new order of particles. */
static void move_block(const double *from, double *to, size_t width, const uint32_t *map, size_t n_old) {
  for (size_t i = 0; i < n_old; i++)
    if (map[i] != UINT32_MAX) memcpy(to + width * map[i], from + width * i, width * sizeof *to);
}

static void place_births(const hk_population_change *c, double *X, size_t n, size_t first) {
  const hk_state *s = c->state;
  for (size_t b = 0; b < c->births; b++) {
    memcpy(X + 3 * (first + b), c->birth[b].position, 3 * sizeof(double));
    memcpy(X + 3 * (n + first + b), c->birth[b].velocity, 3 * sizeof(double));
    for (size_t k = 0; k < s->model.channels; k++) {
      const hk_channel *channel = &s->channel[k];
      memcpy(X + (6 + channel->offset) * n + channel->size * (first + b), c->channel + b * s->width + channel->offset,
             channel->size * sizeof(double));
    }
  }
}

static void new_state(const hk_population_change *c, const uint32_t *map, double *X, size_t n) {
  const hk_state *s = c->state;
  size_t old = s->model.n, first = old - c->deaths;
  move_block(s->X, X, 3, map, old);
  move_block(s->X + 3 * old, X + 3 * n, 3, map, old);
  for (size_t k = 0; k < s->model.channels; k++) {
    size_t offset = 6 + s->channel[k].offset;
    move_block(s->X + offset * old, X + offset * n, s->channel[k].size, map, old);
  }
  X[(6 + s->width) * n] = s->X[(6 + s->width) * old]; /* the work */
  place_births(c, X, n, first);
}

static void fill_members(const hk_population_change *c, const uint32_t *map, hk_particle_set *m) {
  hk_state *s = c->state;
  size_t next = s->model.n - c->deaths;
  for (size_t i = 0; i < s->model.n; i++) {
    if (map[i] == UINT32_MAX) continue;
    m->mass[map[i]] = s->mass[i];
    m->id[map[i]] = s->id[i];
    m->group[map[i]] = s->group[i];
  }
  for (size_t b = 0; b < c->births; b++, next++) {
    m->mass[next] = c->birth[b].mass;
    m->id[next] = s->next_id++;
    m->group[next] = c->birth[b].group;
  }
}

hk_population_change hk_population_begin(hk_state *state, const hk_scene *scene, const hk_instance *source) {
  return (hk_population_change){.population = {add_birth, take}, .state = state, .scene = scene, .source = source};
}

hk_status hk_population_apply(hk_population_change *c, uint32_t **map, hk_error *error) {
  hk_state *s = c->state;
  size_t n = s->model.n - c->deaths + c->births;
  hk_particle_set set = {0};
  *map = make_map(c);
  if (*map && hk_particle_set_allocate(&set, n, s->width)) {
    new_state(c, *map, set.X, n);
    fill_members(c, *map, &set);
    return hk_state_adopt(s, *map, &set, error);
  }
  hk_particle_set_free(&set);
  return hk_error_set(error, HK_NO_MEMORY, "no memory for %zu particles", n);
}

void hk_population_end(hk_population_change *c) {
  free(c->birth);
  free(c->channel);
  free(c->dies);
}
