/* Builds the arrays of the short steps. Springs that hang together, through whatever stiff springs, form a component,
 * whose short steps depend on no other. Components are put into parts by their bound of the squared frequency
 * (stiff_edges.c), an octave each, so that each takes as many short steps as it needs itself. */
#include "plugins/common/local/short_steps.h"

#include <string.h>

enum { NOT_STIFF = -1 };

typedef struct builder {
  hk_short_steps *s;
  const hk_host *host;
  const hk_model *model;
  const hk_stiff_edges *edges;
  uint32_t *parent, *place; /* n each: trees of components; a particle's number within its part */
  int8_t *part;             /* n, NOT_STIFF: of no part */
  double *bound;            /* n, 1/s^2: of a particle, then of the component at its root */
} builder;

static uint32_t root_of(builder *b, uint32_t i) {
  while (b->parent[i] != i) i = b->parent[i] = b->parent[b->parent[i]];
  return i;
}

static void find_components(builder *b) {
  for (uint32_t i = 0; i < b->model->n; i++) b->parent[i] = i;
  for (size_t e = 0; e < b->edges->count; e++) {
    const uint32_t *pair = b->edges->pair[e];
    double r = b->edges->k[e] * (b->model->inverse_mass[pair[0]] + b->model->inverse_mass[pair[1]]);
    uint32_t p = root_of(b, pair[0]), q = root_of(b, pair[1]);
    b->parent[p > q ? p : q] = p > q ? q : p;
    b->bound[pair[0]] += r;
    b->bound[pair[1]] += r;
  }
  for (uint32_t i = 0; i < b->model->n; i++) /* a root is never above its particles */
    b->bound[root_of(b, i)] = fmax(b->bound[root_of(b, i)], b->bound[i]);
}

/* Parts by octaves below the stiffest component, numbered as they come. */
static void divide(builder *b) {
  int8_t number[HK_SHORT_PARTS];
  hk_short_steps *s = b->s;
  memset(number, NOT_STIFF, sizeof number);
  for (uint32_t i = 0; i < b->model->n; i++) {
    double bound = b->bound[root_of(b, i)];
    b->part[i] = NOT_STIFF;
    if (!(bound > 0)) continue;
    int octave = (int)fmin(HK_SHORT_PARTS - 1, log2(b->edges->stiffest / bound) + 0.5);
    if (number[octave] == NOT_STIFF) number[octave] = (int8_t)s->parts++;
    hk_short_part *part = &s->part[b->part[i] = number[octave]];
    part->stiffest = fmax(part->stiffest, bound);
    b->place[i] = (uint32_t)part->n++;
  }
  for (size_t k = 0; k < s->parts; k++) {
    s->part[k].begin = s->n;
    s->n += s->part[k].n;
  }
}

static hk_status reserve(builder *b) {
  hk_short_steps *s = b->s;
  double **array[] = {&s->inverse_mass, &s->q, &s->change, &s->a, &s->F};
  size_t arrays = sizeof array / sizeof *array;
  s->index = b->host->allocate(b->host, (s->n + 1) * sizeof *s->index);
  s->inverse_mass = b->host->allocate(b->host, (arrays * 3 * s->n + 1) * sizeof *s->inverse_mass);
  if (!s->index || !s->inverse_mass) return HK_NO_MEMORY;
  for (size_t k = 1; k < arrays; k++) *array[k] = s->inverse_mass + 3 * s->n * k;
  for (size_t i = 0; i < b->model->n; i++) {
    if (b->part[i] == NOT_STIFF) continue;
    size_t at = s->part[b->part[i]].begin + b->place[i];
    s->index[at] = (uint32_t)i;
    for (size_t c = 0; c < 3; c++) s->inverse_mass[3 * at + c] = b->model->inverse_mass[i];
  }
  return HK_OK;
}

static hk_status lay_out(builder *b, hk_short_part *part, int8_t number, uint32_t (*pair)[2], double *k, double *L) {
  size_t count = 0;
  double none = 0;
  for (size_t e = 0; e < b->edges->count; e++) {
    const uint32_t *ends = b->edges->pair[e];
    if (b->part[ends[0]] != number) continue;
    for (int c = 0; c < 2; c++) pair[count][c] = b->place[ends[c]];
    part->retardation = fmax(part->retardation, b->edges->c[e] / b->edges->k[e]);
    k[count] = b->edges->k[e];
    L[count++] = b->edges->L[e];
  }
  const hk_tuples list = {count, 2, &pair[0][0]};
  const hk_per_tuple stiffness = {count, k}, damping = {1, &none}, rest = {count, L};
  const hk_partition undivided = hk_partition_undivided(part->n);
  return hk_spring_layout_build(&part->layout, b->host, &undivided, &list, &stiffness, &damping, &rest, NULL);
}

static hk_status lay_out_all(builder *b) {
  size_t count = b->edges->count;
  uint32_t(*pair)[2] = b->host->allocate(b->host, count * sizeof *pair);
  double *k = b->host->allocate(b->host, 2 * count * sizeof *k);
  hk_status status = pair && k ? HK_OK : HK_NO_MEMORY;
  for (size_t part = 0; part < b->s->parts && status == HK_OK; part++)
    status = lay_out(b, &b->s->part[part], (int8_t)part, pair, k, k + count);
  b->host->release(b->host, pair);
  b->host->release(b->host, k);
  return status;
}

/* The projector of a sliding particle has as columns what `filter` leaves of the unit vectors. */
static hk_status read_projectors(hk_short_steps *s, hk_system *system, double *scratch) {
  const hk_model *model = system->model;
  bool any = false;
  for (size_t i = 0; i < s->n; i++)
    any |= model->pin[s->index[i]] == HK_PIN_LINE || model->pin[s->index[i]] == HK_PIN_PLANE;
  if (!any) return HK_OK;
  s->projector = system->host->allocate(system->host, s->n * sizeof *s->projector);
  if (!s->projector) return HK_NO_MEMORY;
  for (size_t c = 0; c < 3; c++) {
    for (size_t e = 0; e < 3 * model->n; e++) scratch[e] = e % 3 == c;
    system->filter(system, scratch);
    for (size_t i = 0; i < s->n; i++)
      for (size_t r = 0; r < 3; r++) s->projector[i][3 * r + c] = scratch[3 * (size_t)s->index[i] + r];
  }
  return HK_OK;
}

hk_status hk_short_steps_build(hk_short_steps *s, hk_system *system, const hk_stiff_edges *edges, double *scratch) {
  const hk_host *host = system->host;
  size_t n = system->model->n;
  hk_short_steps_free(s, host);
  if (edges->count == 0) return HK_OK;
  builder b = {.s = s, .host = host, .model = system->model, .edges = edges};
  b.parent = host->allocate(host, 2 * n * sizeof *b.parent);
  b.bound = host->allocate(host, n * sizeof *b.bound);
  b.part = host->allocate(host, n);
  hk_status status = b.parent && b.bound && b.part ? HK_OK : HK_NO_MEMORY;
  if (status == HK_OK) {
    b.place = b.parent + n;
    find_components(&b);
    divide(&b);
    status = reserve(&b);
  }
  if (status == HK_OK) status = lay_out_all(&b);
  if (status == HK_OK) status = read_projectors(s, system, scratch);
  host->release(host, b.parent);
  host->release(host, b.bound);
  host->release(host, b.part);
  return status;
}

void hk_short_steps_free(hk_short_steps *s, const hk_host *host) {
  for (size_t k = 0; k < s->parts; k++) hk_spring_layout_free(&s->part[k].layout, host);
  host->release(host, s->index);
  host->release(host, s->projector);
  host->release(host, s->inverse_mass);
  *s = (hk_short_steps){0};
}
