/* Births and deaths. A source asks during `emit`; what it asked for takes effect when it returns: the dead close ranks
 * in order, the born follow with new ids, and every list of indices in the scene is remapped. Before and after, all
 * arrays have the same n; a scene whose sources ask for nothing pays for one call each. */
#include "core/run/engine.h"
#include "core/base/memory.h"
#include "core/state/particle_set.h"

#include <stdlib.h>
#include <string.h>

typedef struct population_change {
  hk_population population; /* first member */
  hk_run *run;
  const hk_instance *source;
  size_t births, capacity;
  hk_birth *birth;
  double *channel; /* births x width */
  size_t channel_capacity;
  size_t deaths;
  bool *dies; /* n, NULL while nobody does */
} population_change;

static hk_status refuse(population_change *c, hk_status status, const char *what, double value) {
  return c->source->host.fail(&c->source->host, status, "%s (%g)", what, value);
}

static hk_status check_birth(population_change *c, const hk_birth *b) {
  if (!(b->mass > 0) || !isfinite(b->mass))
    return refuse(c, HK_FAILED, "a newborn's mass must be positive, kg", b->mass);
  for (int k = 0; k < 3; k++) {
    if (!isfinite(b->position[k])) return refuse(c, HK_FAILED, "a newborn's position must be finite", b->position[k]);
    if (!isfinite(b->velocity[k])) return refuse(c, HK_FAILED, "a newborn's velocity must be finite", b->velocity[k]);
  }
  if (b->group >= c->run->model.groups) return refuse(c, HK_FAILED, "a newborn's group does not exist", b->group);
  if (c->run->next_id + c->births >= UINT32_MAX - 1) return refuse(c, HK_FAILED, "ids are used up", UINT32_MAX);
  return HK_OK;
}

static void initial_channels(const hk_run *run, double *into) {
  for (size_t k = 0; k < run->scene->channels; k++) {
    const hk_channel_spec *spec = &run->scene->channel[k];
    memcpy(into + run->channel[k].offset, spec->initial, spec->size * sizeof *into);
  }
}

static hk_status add_birth(hk_population *population, const hk_birth *birth, uint32_t *id) {
  population_change *c = (population_change *)(void *)population;
  size_t width = c->run->width;
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
    initial_channels(c->run, c->channel + c->births * width);
  if (id) *id = c->run->next_id + (uint32_t)c->births;
  c->births++;
  return HK_OK;
}

static hk_status take(hk_population *population, uint32_t index) {
  population_change *c = (population_change *)(void *)population;
  if (index >= c->run->model.n) return refuse(c, HK_FAILED, "there is no particle of that index to remove", index);
  if (!c->dies) c->dies = calloc(c->run->model.n, sizeof *c->dies);
  if (!c->dies) return refuse(c, HK_NO_MEMORY, "no memory for deaths", index);
  c->deaths += !c->dies[index];
  c->dies[index] = true;
  return HK_OK;
}

static uint32_t *make_map(const population_change *c) {
  size_t n = c->run->model.n;
  uint32_t *map = malloc((n + 1) * sizeof *map), next = 0;
  for (size_t i = 0; map && i < n; i++) map[i] = c->dies && c->dies[i] ? UINT32_MAX : next++;
  return map;
}

/* Moves one block of `width` numbers per particle into the new layout. */
static void move_block(const double *from, double *to, size_t width, const uint32_t *map, size_t n_old) {
  for (size_t i = 0; i < n_old; i++)
    if (map[i] != UINT32_MAX) memcpy(to + width * map[i], from + width * i, width * sizeof *to);
}

static void place_newborn(const population_change *c, double *X, size_t n, size_t first) {
  const hk_run *run = c->run;
  for (size_t b = 0; b < c->births; b++) {
    memcpy(X + 3 * (first + b), c->birth[b].position, 3 * sizeof(double));
    memcpy(X + 3 * (n + first + b), c->birth[b].velocity, 3 * sizeof(double));
    for (size_t k = 0; k < run->model.channels; k++) {
      const hk_channel *channel = &run->channel[k];
      memcpy(X + (6 + channel->offset) * n + channel->size * (first + b), c->channel + b * run->width + channel->offset,
             channel->size * sizeof(double));
    }
  }
}

static void new_state(const population_change *c, const uint32_t *map, double *X, size_t n) {
  const hk_run *run = c->run;
  size_t old = run->model.n, first = old - c->deaths;
  move_block(run->X, X, 3, map, old);
  move_block(run->X + 3 * old, X + 3 * n, 3, map, old);
  for (size_t k = 0; k < run->model.channels; k++) {
    size_t offset = 6 + run->channel[k].offset;
    move_block(run->X + offset * old, X + offset * n, run->channel[k].size, map, old);
  }
  X[(6 + run->width) * n] = run->X[(6 + run->width) * old]; /* the work */
  place_newborn(c, X, n, first);
}

/* Keeps the tuples none of whose members died; returns how many. */
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

static hk_status remap_list(hk_run *run, const hk_instances *list, const uint32_t *map, size_t n_old) {
  for (size_t k = 0; k < list->count; k++) {
    hk_status status = hk_instance_remap(list->item[k], map, n_old, &run->view, run->system.size, &run->error);
    if (status != HK_OK) return status;
  }
  return HK_OK;
}

static hk_status remap_plugins(hk_run *run, const uint32_t *map, size_t n_old) {
  hk_scene *scene = run->scene;
  const hk_instances *lists[] = {&scene->source, &scene->force, &scene->constraint, &scene->corrector, &scene->output};
  hk_status status = HK_OK;
  for (size_t k = 0; k < sizeof lists / sizeof *lists && status == HK_OK; k++)
    status = remap_list(run, lists[k], map, n_old);
  hk_instance *single[] = {scene->integrator, scene->solver && scene->solver->started ? scene->solver : NULL};
  for (size_t k = 0; k < 2 && status == HK_OK; k++)
    if (single[k]) status = hk_instance_remap(single[k], map, n_old, &run->view, run->system.size, &run->error);
  return status;
}

void hk_particle_set_free(hk_particle_set *m) {
  free(m->X);
  free(m->mass);
  free(m->id);
  free(m->group);
  *m = (hk_particle_set){0};
}

bool hk_particle_set_allocate(hk_particle_set *m, size_t n, size_t width) {
  m->n = n;
  m->X = calloc((6 + width) * n + 1, sizeof *m->X);
  m->mass = calloc(n + 1, sizeof *m->mass);
  m->id = malloc((n + 1) * sizeof *m->id);
  m->group = malloc((n + 1) * sizeof *m->group);
  return m->X && m->mass && m->id && m->group;
}

/* Pins stay with those that live; the new arrays take the place of the old ones. */
static hk_status adopt(hk_run *run, const uint32_t *map, hk_particle_set *m) {
  double *inverse_mass = malloc((m->n + 1) * sizeof *inverse_mass);
  uint8_t *pin = calloc(m->n + 1, sizeof *pin);
  if (!inverse_mass || !pin) {
    free(inverse_mass);
    free(pin);
    return HK_NO_MEMORY;
  }
  for (size_t i = 0; i < m->n; i++) inverse_mass[i] = m->mass[i] > 0 ? 1 / m->mass[i] : 0;
  for (size_t i = 0; i < run->model.n; i++) {
    if (map[i] == UINT32_MAX) continue;
    pin[map[i]] = run->pin[i];
    if (run->pin[i] == HK_PIN_FIXED || run->pin[i] == HK_PIN_PATH) inverse_mass[map[i]] = 0;
  }
  hk_particle_set old = {0, run->X, run->mass, run->id, run->group};
  free(run->inverse_mass);
  free(run->pin);
  run->inverse_mass = inverse_mass;
  run->pin = pin;
  run->X = m->X;
  run->mass = m->mass;
  run->id = m->id;
  run->group = m->group;
  run->model.n = m->n;
  hk_particle_set_free(&old);
  *m = (hk_particle_set){0};
  return HK_OK;
}

hk_status hk_state_install(hk_run *run, const uint32_t *map, hk_particle_set *members) {
  size_t n_old = run->model.n;
  if (adopt(run, map, members) != HK_OK) {
    hk_particle_set_free(members);
    return hk_error_set(&run->error, HK_NO_MEMORY, "no memory for %zu particles", members->n);
  }
  run->model.edges.count = remap_tuples(&run->edge[0][0], run->model.edges.count, 2, map);
  run->model.triangles = remap_tuples(&run->triangle[0][0], run->model.triangles, 3, map);
  hk_pins_remap(run, map);
  hk_state_publish(run);
  hk_state_view(run);
  hk_status status = remap_plugins(run, map, n_old);
  hk_state_view(run); /* selections are new as well */
  if (status == HK_OK) hk_elements_refresh(run);
  if (status == HK_OK) status = hk_system_resize(run);
  if (status == HK_OK) status = hk_constraints_topology(run);
  hk_jacobian_topology(run);
  return status;
}

static void fill_members(const population_change *c, const uint32_t *map, hk_particle_set *m) {
  hk_run *run = c->run;
  size_t next = run->model.n - c->deaths;
  for (size_t i = 0; i < run->model.n; i++) {
    if (map[i] == UINT32_MAX) continue;
    m->mass[map[i]] = run->mass[i];
    m->id[map[i]] = run->id[i];
    m->group[map[i]] = run->group[i];
  }
  for (size_t b = 0; b < c->births; b++, next++) {
    m->mass[next] = c->birth[b].mass;
    m->id[next] = run->next_id++;
    m->group[next] = c->birth[b].group;
  }
}

static hk_status apply(population_change *c) {
  hk_run *run = c->run;
  size_t n = run->model.n - c->deaths + c->births;
  uint32_t *map = make_map(c);
  hk_particle_set members = {0};
  hk_status status = HK_NO_MEMORY;
  if (map && hk_particle_set_allocate(&members, n, run->width)) {
    new_state(c, map, members.X, n);
    fill_members(c, map, &members);
    status = hk_state_install(run, map, &members);
  } else {
    hk_particle_set_free(&members);
    hk_error_set(&run->error, status, "no memory for %zu particles", n);
  }
  free(map);
  return status;
}

hk_status hk_state_emit(hk_run *run, double h, bool *changed) {
  *changed = false;
  hk_status status = HK_OK;
  for (size_t k = 0; k < run->scene->source.count && status == HK_OK; k++) {
    hk_instance *source = run->scene->source.item[k];
    population_change c = {.population = {add_birth, take}, .run = run, .source = source};
    hk_view view = run->view;
    view.host = &source->host;
    if (run->system.t >= source->from && run->system.t < source->to)
      status = source->plugin->source->emit(source->self, &view, h, &c.population);
    if (status == HK_OK && c.births + c.deaths) {
      status = apply(&c);
      *changed = true;
    }
    free(c.birth);
    free(c.channel);
    free(c.dies);
  }
  return status;
}
