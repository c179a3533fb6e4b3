/* The state vector and the model: allocation, start values, the search of particles by id. */
#include "core/engine/state/state.h"

#include <stdlib.h>
#include <string.h>

static hk_status no_memory(const hk_state *s, hk_error *error) {
  return hk_error_set(error, HK_NO_MEMORY, "no memory for the state of %zu particles", s->model.n);
}

bool hk_state_open_spare(hk_state *s) {
  return (s->spare = hk_memory_get(&s->numbers, s->size * sizeof *s->spare)) != NULL;
}

void hk_state_exchange(hk_state *s) {
  double *X = s->spare;
  s->spare = s->X;
  s->X = X;
  s->view.x = X;
  s->view.v = X + 3 * s->model.n;
  s->view.y = s->width ? X + 6 * s->model.n : NULL;
}

static bool movable(const hk_state *s, size_t i) {
  return s->pin[i] == HK_FREE || s->pin[i] == HK_PIN_LINE || s->pin[i] == HK_PIN_PLANE;
}

void hk_state_refresh(hk_state *s) {
  for (size_t i = 0; i < s->model.n; i++) s->inverse_mass[i] = movable(s, i) && s->mass[i] > 0 ? 1 / s->mass[i] : 0;
  hk_state_point(s);
}

/* A block has 1,024 particles, or 512 where all of them leave the second-level cache: what a block and its neighbours
 * take stays closer then. A step of a curtain of 256 squared is a tenth faster by 512 than by 1,024, and as fast by
 * 256; one of 64 squared is 3 % slower. */
enum { BITS = 10, SMALLER = 9, MANY = 32768 };

/* A domain has at least so many thousands, where there are more than two of them: with fewer, most particles lie beside
 * another one. 2,000 particles of cloth are some 60 us of work, so that two threads gain from two of them on. */
enum { LEAST = 2 };

/* By the number of particles alone, so that results do not depend on that of threads. */
static hk_partition partition_of(size_t n) {
  const unsigned bits = n > MANY ? SMALLER : BITS;
  const size_t each = (size_t)1 << (BITS - bits), thousands = n ? ((n - 1) >> BITS) + 1 : 1;
  hk_partition p = {.n = n, .bits = bits, .blocks = n ? ((n - 1) >> bits) + 1 : 1};
  size_t wanted = thousands / LEAST;
  if (wanted > HK_DOMAINS) wanted = HK_DOMAINS;
  wanted = wanted > 1 ? wanted / 2 * 2 : thousands > 1 ? 2 : 1; /* even: as many for each of two threads */
  p.width = each * ((thousands + wanted - 1) / wanted);
  p.domains = (p.blocks + p.width - 1) / p.width;
  p.parts = p.blocks + p.domains * (p.domains - 1) / 2 + 1;
  return p;
}

void hk_state_point(hk_state *s) {
  hk_model *m = &s->model;
  size_t n = m->n;
  s->size = (6 + s->width) * n + 1;
  s->partition = partition_of(n);
  m->partition = &s->partition;
  m->mass = s->mass;
  m->inverse_mass = s->inverse_mass;
  m->id = s->id;
  m->group = s->group;
  m->pin = s->pin;
  m->channel = s->channel;
  m->by_id = s->by_id;
  m->t = s->t;
  m->rider = s->rider;
  m->skin = s->skin;
  m->inside = s->inside;
  m->edges.index = &s->edge[0][0];
  m->triangles.index = &s->triangle[0][0];
  s->view = (hk_view){.t = s->t, .n = n, .x = s->X, .v = s->X + 3 * n, .model = m, .acting = n};
  s->view.y = s->width ? s->X + 6 * n : NULL;
}

static hk_status open_channels(hk_state *s, const hk_particles *p, hk_error *error) {
  s->channel = calloc(p->channels + 1, sizeof *s->channel);
  if (!s->channel) return no_memory(s, error);
  for (size_t k = 0; k < p->channels; k++) {
    s->channel[k] = (hk_channel){p->channel[k].name, p->channel[k].size, s->width};
    s->width += p->channel[k].size;
  }
  s->model.channels = p->channels;
  return HK_OK;
}

static hk_status allocate(hk_state *s, const hk_particles *p, hk_error *error) {
  size_t n = p->n;
  s->mass = hk_memory_get(&s->numbers, (n + 1) * sizeof *s->mass);
  s->inverse_mass = hk_memory_get(&s->numbers, (n + 1) * sizeof *s->inverse_mass);
  s->id = malloc((n + 1) * sizeof *s->id);
  s->group = malloc((n + 1) * sizeof *s->group);
  s->pin = calloc(n + 1, sizeof *s->pin);
  s->X = hk_memory_get(&s->numbers, ((6 + s->width) * n + 1) * sizeof *s->X);
  s->edge = malloc((p->edges + 1) * sizeof *s->edge);
  s->triangle = malloc((p->triangles + 1) * sizeof *s->triangle);
  bool fine = s->mass && s->inverse_mass && s->id && s->group && s->pin && s->X && s->edge && s->triangle;
  return fine ? HK_OK : no_memory(s, error);
}

static uint32_t index_of(const hk_state *s, size_t id) { return s->by_id ? s->by_id[id - 1] : (uint32_t)id - 1; }

/* `bytes` for each particle, in the order of ids, to their indices. */
static void place(const hk_state *s, void *to, const void *from, size_t bytes) {
  if (!s->by_id) memcpy(to, from, s->model.n * bytes);
  for (size_t i = 0; s->by_id && i < s->model.n; i++)
    memcpy((char *)to + bytes * s->by_id[i], (const char *)from + bytes * i, bytes);
}

static void copy_particles(hk_state *s, const hk_particles *p) {
  size_t n = p->n;
  place(s, s->X, p->position, 3 * sizeof(double));
  place(s, s->X + 3 * n, p->velocity, 3 * sizeof(double));
  for (size_t k = 0; k < p->channels; k++)
    place(s, s->X + (6 + s->channel[k].offset) * n, p->channel[k].value, s->channel[k].size * sizeof(double));
  place(s, s->mass, p->mass, sizeof *s->mass);
  place(s, s->group, p->group, sizeof *s->group);
  for (size_t id = 1; id <= n; id++) s->id[index_of(s, id)] = (uint32_t)id;
  for (size_t e = 0; e < 2 * p->edges; e++) s->edge[e / 2][e % 2] = index_of(s, p->edge[e / 2][e % 2]);
  for (size_t e = 0; e < 3 * p->triangles; e++) s->triangle[e / 3][e % 3] = index_of(s, p->triangle[e / 3][e % 3]);
}

hk_status hk_state_open(hk_state *s, const hk_particles *p, uint32_t *places, hk_error *error) {
  s->start = p;
  s->by_id = places;
  s->model = (hk_model){.n = p->n, .edges = {p->edges, 2, NULL}, .triangles = {p->triangles, 3, NULL}};
  s->model.groups = p->groups;
  s->model.group_name = (const char *const *)p->group_name;
  hk_status status = open_channels(s, p, error);
  if (status == HK_OK) status = allocate(s, p, error);
  if (status != HK_OK) return status;
  s->next_id = (uint32_t)p->n + 1;
  s->room = p->n;
  if (p->n) copy_particles(s, p);
  hk_state_refresh(s);
  return HK_OK;
}

void hk_state_close(hk_state *s) {
  void *arrays[] = {s->id, s->group, s->pin, s->edge, s->triangle, s->channel, s->by_id, s->rider, s->skin, s->inside};
  for (size_t k = 0; k < sizeof arrays / sizeof *arrays; k++) free(arrays[k]);
  hk_memory_clear(&s->numbers);
}

hk_status hk_state_check_masses(const hk_state *s, hk_error *error) {
  for (size_t i = 0; i < s->model.n; i++)
    if (s->mass[i] == 0 && movable(s, i))
      return hk_error_set(error, HK_BAD_PARAM, "particle %u: mass 0 kg needs a pin; give it a mass or pin it",
                          s->id[i]);
  return HK_OK;
}

double hk_state_extent(const hk_state *s) {
  double extent = 0;
  for (int c = 0; c < 3; c++) {
    double low = INFINITY, high = -INFINITY;
    for (size_t i = 0; i < s->model.n; i++) {
      low = fmin(low, s->X[3 * i + (size_t)c]);
      high = fmax(high, s->X[3 * i + (size_t)c]);
    }
    extent = fmax(extent, high - low);
  }
  return extent > 0 ? extent : 1;
}

bool hk_state_copy(const hk_state *s, double **copy, size_t *room, size_t size) {
  double *grown = size > *room ? realloc(*copy, size * sizeof *grown) : *copy;
  if (!grown) return false;
  *copy = grown;
  if (size > *room) *room = size;
  memcpy(grown, s->X, size * sizeof *grown);
  return true;
}

double hk_state_kinetic(const hk_state *s, const double *X) {
  const double *v = X + 3 * s->model.n;
  double sum = 0;
  for (size_t i = 0; i < s->model.n; i++)
    if (s->inverse_mass[i] > 0)
      sum += s->mass[i] * (v[3 * i] * v[3 * i] + v[3 * i + 1] * v[3 * i + 1] + v[3 * i + 2] * v[3 * i + 2]);
  return sum / 2;
}

bool hk_state_index(const hk_state *s, uint32_t id, uint32_t *index) {
  *index = (uint32_t)hk_model_find(&s->model, id);
  return *index < s->model.n;
}
