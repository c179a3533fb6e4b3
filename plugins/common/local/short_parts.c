/* Builds the arrays of the short steps. Springs that hang together, through whatever stiff springs, form a component,
 * whose short steps depend on no other. Components are put into parts by their bound of the squared frequency
 * (stiff_edges.c), an octave each, so that each takes as many short steps as it needs itself; small ones without
 * sliding pins go to short_lanes.h, the others into arrays. */
#include "plugins/common/local/short_steps.h"

#include <string.h>

enum { NOT_STIFF = -1 };

/* A particle, and, at the root of its tree, its component. */
typedef struct node {
  uint32_t parent, place;      /* in the trees of components; its number within its part */
  uint32_t particles, springs; /* of the component */
  double bound, damping;       /* 1/s^2, 1/s: of the particle, then of the component */
  int8_t part;                 /* NOT_STIFF: of none */
  bool slides;                 /* whether a particle of the component does */
} node;

typedef struct builder {
  hk_short_steps *s;
  const hk_host *host;
  const hk_model *model;
  const hk_stiff_edges *edges;
  node *node; /* n */
} builder;

static uint32_t root_of(builder *b, uint32_t i) {
  node *all = b->node;
  while (all[i].parent != i) i = all[i].parent = all[all[i].parent].parent;
  return i;
}

static bool slides(const hk_model *model, size_t i) {
  return model->pin[i] == HK_PIN_LINE || model->pin[i] == HK_PIN_PLANE;
}

static void join(builder *b, size_t e) {
  const uint32_t *pair = b->edges->pair[e];
  double w = b->model->inverse_mass[pair[0]] + b->model->inverse_mass[pair[1]];
  uint32_t p = root_of(b, pair[0]), q = root_of(b, pair[1]);
  b->node[p > q ? p : q].parent = p > q ? q : p;
  for (int end = 0; end < 2; end++) {
    b->node[pair[end]].bound += b->edges->k[e] * w;
    b->node[pair[end]].damping += b->edges->c[e] * w;
  }
}

static void find_components(builder *b) {
  for (uint32_t i = 0; i < b->model->n; i++) b->node[i] = (node){.parent = i, .part = NOT_STIFF};
  for (size_t e = 0; e < b->edges->count; e++) join(b, e);
  for (uint32_t i = 0; i < b->model->n; i++) { /* a root is never above its particles */
    node *root = &b->node[root_of(b, i)];
    root->bound = fmax(root->bound, b->node[i].bound);
    root->damping = fmax(root->damping, b->node[i].damping);
    root->slides |= slides(b->model, i);
    root->particles++;
  }
  for (size_t e = 0; e < b->edges->count; e++) b->node[root_of(b, b->edges->pair[e][0])].springs++;
}

static bool is_small(const node *root) {
  return root->particles <= HK_SHORT_PARTICLES && root->springs <= HK_SHORT_SPRINGS && !root->slides;
}

/* Parts by octaves below the stiffest component, numbered as they come. */
static void make_parts(builder *b) {
  int8_t number[HK_SHORT_PARTS];
  hk_short_steps *s = b->s;
  double most = 0;
  memset(number, NOT_STIFF, sizeof number);
  for (uint32_t i = 0; i < b->model->n; i++) most = fmax(most, b->node[i].bound);
  for (uint32_t i = 0; i < b->model->n; i++) {
    const node *root = &b->node[root_of(b, i)];
    if (!(root->bound > 0)) continue;
    int octave = (int)fmin(HK_SHORT_PARTS - 1, log2(most / root->bound));
    if (number[octave] == NOT_STIFF) number[octave] = (int8_t)s->parts++;
    hk_short_part *part = &s->part[b->node[i].part = number[octave]];
    part->modes.softest = part->modes.stiffest > 0 ? fmin(part->modes.softest, root->bound) : root->bound;
    part->modes.stiffest = fmax(part->modes.stiffest, root->bound);
    part->modes.damping = fmax(part->modes.damping, root->damping);
    if (is_small(root)) continue;
    part->stiffest = fmax(part->stiffest, root->bound);
    b->node[i].place = (uint32_t)part->n++;
  }
  for (size_t k = 0; k < s->parts; k++) {
    s->part[k].begin = s->n;
    s->n += s->part[k].n;
  }
  for (size_t e = 0; e < b->edges->count; e++) {
    const int8_t in = b->node[b->edges->pair[e][0]].part;
    if (in == NOT_STIFF) continue; /* between pinned particles */
    hk_local_modes *modes = &s->part[in].modes;
    modes->retardation = fmax(modes->retardation, b->edges->c[e] / b->edges->k[e]);
  }
}

static hk_status reserve(builder *b) {
  hk_short_steps *s = b->s;
  double **array[] = {&s->inverse_mass, &s->x, &s->d, &s->change, &s->a, &s->F, &s->q};
  size_t arrays = sizeof array / sizeof *array;
  s->index = b->host->allocate(b->host, (s->n + 1) * sizeof *s->index);
  s->inverse_mass = b->host->allocate(b->host, (arrays * 3 * s->n + 1) * sizeof *s->inverse_mass);
  if (!s->index || !s->inverse_mass) return HK_NO_MEMORY;
  for (size_t k = 1; k < arrays; k++) *array[k] = s->inverse_mass + 3 * s->n * k;
  for (uint32_t i = 0; i < b->model->n; i++) {
    if (b->node[i].part == NOT_STIFF || is_small(&b->node[root_of(b, i)])) continue;
    size_t at = s->part[b->node[i].part].begin + b->node[i].place;
    s->index[at] = i;
    for (size_t c = 0; c < 3; c++) s->inverse_mass[3 * at + c] = b->model->inverse_mass[i];
  }
  return HK_OK;
}

/* Room for all springs. */
typedef struct room {
  uint32_t (*pair)[2];
  double *k, *L;
} room;

static hk_status lay_out(builder *b, hk_short_part *part, int8_t number, const room *r) {
  size_t count = 0;
  double none = 0;
  for (size_t e = 0; e < b->edges->count; e++) {
    const uint32_t *ends = b->edges->pair[e];
    if (b->node[ends[0]].part != number || is_small(&b->node[root_of(b, ends[0])])) continue;
    for (int c = 0; c < 2; c++) r->pair[count][c] = b->node[ends[c]].place;
    r->k[count] = b->edges->k[e];
    r->L[count++] = b->edges->L[e];
  }
  const hk_tuples list = {count, 2, &r->pair[0][0]};
  const hk_per_tuple stiffness = {count, r->k}, damping = {1, &none}, rest = {count, r->L};
  const hk_partition undivided = hk_partition_undivided(part->n);
  return hk_spring_layout_build(&part->layout, b->host, &undivided, &list, &stiffness, &damping, &rest, NULL);
}

static hk_status lay_out_large(builder *b) {
  size_t count = b->edges->count;
  room r = {b->host->allocate(b->host, count * sizeof *r.pair), b->host->allocate(b->host, 2 * count * sizeof *r.k),
            NULL};
  hk_status status = r.pair && r.k ? HK_OK : HK_NO_MEMORY;
  if (status == HK_OK) r.L = r.k + count;
  for (size_t part = 0; part < b->s->parts && status == HK_OK; part++)
    if (b->s->part[part].n) status = lay_out(b, &b->s->part[part], (int8_t)part, &r);
  b->host->release(b->host, r.pair);
  b->host->release(b->host, r.k);
  return status;
}

static hk_status take_small(builder *b) {
  size_t n = b->model->n, count = 0;
  uint32_t *edge = b->host->allocate(b->host, (b->edges->count + n) * sizeof *edge), *root = edge + b->edges->count;
  double *bound = b->host->allocate(b->host, n * sizeof *bound);
  hk_status status = edge && bound ? HK_OK : HK_NO_MEMORY;
  for (uint32_t i = 0; i < n && status == HK_OK; i++) {
    root[i] = root_of(b, i);
    bound[i] = b->node[i].bound;
  }
  for (uint32_t e = 0; e < b->edges->count && status == HK_OK; e++)
    if (b->node[b->edges->pair[e][0]].part != NOT_STIFF && is_small(&b->node[root[b->edges->pair[e][0]]]))
      edge[count++] = e;
  if (status == HK_OK)
    status = hk_short_lanes_build(&b->s->lanes, b->host, b->model, b->edges, edge, count, root, bound);
  b->host->release(b->host, edge);
  b->host->release(b->host, bound);
  return status;
}

/* The projector of a sliding particle has as columns what `filter` leaves of the unit vectors. */
static hk_status read_projectors(hk_short_steps *s, hk_system *system, double *scratch) {
  const hk_model *model = system->model;
  bool any = false;
  for (size_t i = 0; i < s->n; i++) any |= slides(model, s->index[i]);
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
  hk_short_steps_free(s, host);
  if (edges->count == 0) return HK_OK;
  s->shift = edges->shift;
  builder b = {.s = s, .host = host, .model = system->model, .edges = edges};
  b.node = host->allocate(host, system->model->n * sizeof *b.node);
  hk_status status = b.node ? HK_OK : HK_NO_MEMORY;
  if (status == HK_OK) {
    find_components(&b);
    make_parts(&b);
    status = reserve(&b);
  }
  if (status == HK_OK) status = lay_out_large(&b);
  if (status == HK_OK) status = take_small(&b);
  if (status == HK_OK) status = read_projectors(s, system, scratch);
  host->release(host, b.node);
  return status;
}

void hk_short_steps_free(hk_short_steps *s, const hk_host *host) {
  for (size_t k = 0; k < s->parts; k++) hk_spring_layout_free(&s->part[k].layout, host);
  hk_short_lanes_free(&s->lanes, host);
  host->release(host, s->index);
  host->release(host, s->projector);
  host->release(host, s->inverse_mass);
  *s = (hk_short_steps){0};
}
