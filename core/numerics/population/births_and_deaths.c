/* Births and deaths. Sources request them during `emit`, and they take effect when all have returned: dead particles
 * are removed, the others keep their order, and new particles are appended with new ids, which rise with the times of
 * birth. Invariant: before and after a change all arrays have the same n. */
#include "core/numerics/population/population.h"

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

static void set_channels(const hk_population_change *c, const double *given, double *into) {
  for (size_t k = 0; k < c->state->start->channels; k++) {
    const hk_channel_spec *spec = &c->state->start->channel[k];
    memcpy(into + c->state->channel[k].offset, spec->initial, spec->size * sizeof *into);
  }
  for (size_t e = 0; given && e < c->state->width; e++)
    if (!isnan(given[e])) into[e] = given[e];
}

static bool reserve(hk_population_change *c, size_t width) {
  void *list = c->birth, *channel = c->channel;
  int failed = hk_array_reserve(&list, &c->capacity, c->births + 1, sizeof *c->birth);
  c->birth = list;
  if (!failed && width)
    failed = hk_array_reserve(&channel, &c->channel_capacity, (c->births + 1) * width, sizeof(double));
  c->channel = channel;
  return !failed;
}

/* Of a source with a group all particles are born into it. */
static uint32_t group_of(const hk_population_change *c, const hk_birth *birth) {
  const char *name = c->source->spec->group;
  for (uint32_t g = 0; name && g < c->state->model.groups; g++)
    if (strcmp(c->state->model.group_name[g], name) == 0) return g;
  return birth->group;
}

static hk_status request(hk_population_change *c, const hk_birth *birth, double age, double lifetime, uint32_t *id) {
  size_t width = c->state->width;
  hk_status status = check_birth(c, birth);
  if (status != HK_OK) return status;
  if (!reserve(c, width)) return refuse(c, HK_NO_MEMORY, "no memory for births", (double)c->births);
  set_channels(c, birth->channel, c->channel + c->births * width);
  c->birth[c->births] = (hk_newborn){*birth, age, lifetime, id, c->births, 0};
  c->birth[c->births].birth.group = group_of(c, birth);
  c->births++;
  return HK_OK;
}

/* These come before those with an age, so that their ids are known at once. */
static hk_status add_birth(hk_population *population, const hk_birth *birth, uint32_t *id) {
  hk_population_change *c = (hk_population_change *)(void *)population;
  hk_status status = request(c, birth, INFINITY, INFINITY, NULL);
  if (status == HK_OK && id) *id = c->state->next_id + (uint32_t)c->ageless;
  c->ageless += status == HK_OK;
  return status;
}

static hk_status add_aged(hk_population *population, const hk_birth *birth, double age, double lifetime, uint32_t *id) {
  hk_population_change *c = (hk_population_change *)(void *)population;
  if (!(age >= 0) || isinf(age)) return refuse(c, HK_FAILED, "the age of a newborn is not 0 s or more", age);
  if (!(lifetime >= 0)) return refuse(c, HK_FAILED, "the lifetime of a newborn is not 0 s or more", lifetime);
  return request(c, birth, age, lifetime, id);
}

static hk_status take(hk_population *population, uint32_t index) {
  hk_population_change *c = (hk_population_change *)(void *)population;
  if (index >= c->state->model.n) return refuse(c, HK_FAILED, "there is no particle of that index to remove", index);
  c->deaths += !c->dies[index];
  c->dies[index] = true;
  return HK_OK;
}

static void make_map(hk_population_change *c) {
  uint32_t next = 0;
  for (size_t i = 0; i < c->state->model.n; i++) c->map[i] = c->dies[i] ? UINT32_MAX : next++;
  if (c->deaths) memset(c->dies, 0, c->state->model.n * sizeof *c->dies);
}

static int by_birth(const void *a, const void *b) {
  const hk_newborn *p = a, *q = b;
  if (p->age != q->age) return p->age > q->age ? -1 : 1;
  return (p->order > q->order) - (p->order < q->order);
}

/* Ids by the time of birth; those that died meanwhile are dropped. */
static void name_newborns(hk_population_change *c) {
  size_t living = 0;
  if (c->births) qsort(c->birth, c->births, sizeof *c->birth, by_birth);
  for (size_t b = 0; b < c->births; b++) {
    hk_newborn *newborn = &c->birth[b];
    newborn->given = c->state->next_id++;
    if (newborn->id) *newborn->id = newborn->given;
    if (isinf(newborn->age) || newborn->lifetime > newborn->age) c->birth[living++] = *newborn;
  }
  c->births = living;
}

static void place_births(const hk_population_change *c) {
  hk_state *s = c->state;
  size_t n = s->model.n, i = n - c->births;
  for (size_t b = 0; b < c->births; b++, i++) {
    const hk_newborn *newborn = &c->birth[b];
    memcpy(s->X + 3 * i, newborn->birth.position, 3 * sizeof(double));
    memcpy(s->X + 3 * (n + i), newborn->birth.velocity, 3 * sizeof(double));
    for (size_t k = 0; k < s->model.channels; k++) {
      size_t offset = s->channel[k].offset, size = s->channel[k].size;
      memcpy(s->X + (6 + offset) * n + size * i, c->channel + newborn->order * s->width + offset,
             size * sizeof(double));
    }
    s->mass[i] = newborn->birth.mass;
    s->inverse_mass[i] = 1 / newborn->birth.mass;
    s->id[i] = newborn->given;
    s->group[i] = newborn->birth.group;
  }
}

hk_population_change *hk_population_open(hk_state *state) {
  hk_population_change *c = malloc(sizeof *c);
  if (c) *c = (hk_population_change){.population = {add_birth, take, add_aged}, .state = state};
  return c;
}

hk_status hk_population_begin(hk_population_change *c, hk_error *error) {
  size_t n = c->state->model.n, room = n + n / 8 + 1;
  c->births = c->ageless = c->deaths = 0;
  if (n < c->room) return HK_OK;
  free(c->dies);
  free(c->map);
  c->dies = calloc(room, sizeof *c->dies);
  c->map = malloc(room * sizeof *c->map);
  c->room = c->dies && c->map ? room : 0;
  return c->room ? HK_OK : hk_error_set(error, HK_NO_MEMORY, "no memory for births and deaths among %zu particles", n);
}

hk_status hk_population_apply(hk_population_change *c, hk_error *error) {
  hk_state *s = c->state;
  size_t most = s->model.n - c->deaths + c->births;
  if (!hk_state_reserve(s, most)) return hk_error_set(error, HK_NO_MEMORY, "no memory for %zu particles", most);
  make_map(c);
  name_newborns(c);
  hk_state_move(s, c->map, s->model.n - c->deaths + c->births);
  place_births(c);
  return HK_OK;
}

void hk_population_close(hk_population_change *c) {
  if (!c) return;
  free(c->birth);
  free(c->channel);
  free(c->dies);
  free(c->map);
  free(c);
}
