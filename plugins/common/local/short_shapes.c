/* Puts components of the same shape side by side. Particles of a component are numbered from one with the most springs
 * on, breadth first, those with more springs first; then the numbers of most components that differ by the order of
 * their particles only are the same. Two numbers of one shape cost empty lanes, nothing else. */
#include "plugins/common/local/short_lanes.h"

#include <stdlib.h>
#include <string.h>

enum { LANES = HK_SHORT_LANES, PARTICLES = HK_SHORT_PARTICLES, SPRINGS = HK_SHORT_SPRINGS };

/* Bands of the bound, beside which components have the same number of short steps, to a fifth of an octave. */
static const double bands = 2.5;

typedef struct component {
  hk_short_shape shape;
  int band;
  double bound;
  uint32_t particle[PARTICLES], edge[SPRINGS]; /* in the order of the shape */
} component;

typedef struct member {
  uint32_t root, edge;
} member;

static int by_root(const void *a, const void *b) {
  const member *p = a, *q = b;
  if (p->root != q->root) return p->root < q->root ? -1 : 1;
  return (p->edge > q->edge) - (p->edge < q->edge);
}

/* ---- the shape of one component ---- */

static size_t degree(const component *c, const hk_stiff_edges *edges, uint32_t particle) {
  size_t found = 0;
  for (size_t e = 0; e < c->shape.springs; e++)
    found += edges->pair[c->edge[e]][0] == particle || edges->pair[c->edge[e]][1] == particle;
  return found;
}

static uint8_t place_of(const component *c, uint32_t particle) {
  uint8_t at = 0;
  while (at < c->shape.n && c->particle[at] != particle) at++;
  return at;
}

static uint32_t first_of(const component *c, const hk_stiff_edges *edges) {
  uint32_t best = edges->pair[c->edge[0]][0];
  for (size_t e = 0; e < c->shape.springs; e++)
    for (int end = 0; end < 2; end++)
      if (degree(c, edges, edges->pair[c->edge[e]][end]) > degree(c, edges, best)) best = edges->pair[c->edge[e]][end];
  return best;
}

/* The neighbour of a particle that has no number yet and most springs; UINT32_MAX: there is none. */
static uint32_t next_of(const component *c, const hk_stiff_edges *edges, uint32_t particle) {
  uint32_t best = UINT32_MAX;
  for (size_t e = 0; e < c->shape.springs; e++) {
    const uint32_t *pair = edges->pair[c->edge[e]];
    if (pair[0] != particle && pair[1] != particle) continue;
    uint32_t other = pair[0] ^ pair[1] ^ particle;
    if (place_of(c, other) < c->shape.n) continue;
    if (best == UINT32_MAX || degree(c, edges, other) > degree(c, edges, best)) best = other;
  }
  return best;
}

static void number_particles(component *c, const hk_stiff_edges *edges) {
  c->particle[c->shape.n++] = first_of(c, edges);
  for (size_t i = 0; i < c->shape.n; i++)
    for (uint32_t next; (next = next_of(c, edges, c->particle[i])) != UINT32_MAX;) c->particle[c->shape.n++] = next;
}

/* Sorted by insertion, by the higher end and the lower one. */
static void number_springs(component *c, const hk_stiff_edges *edges) {
  hk_short_shape *s = &c->shape;
  for (size_t e = 0; e < s->springs; e++) {
    uint32_t edge = c->edge[e];
    uint8_t p = place_of(c, edges->pair[edge][0]), q = place_of(c, edges->pair[edge][1]);
    uint8_t low = p < q ? p : q, high = p < q ? q : p;
    size_t at = e;
    for (; at > 0 && (s->pair[at - 1][1] > high || (s->pair[at - 1][1] == high && s->pair[at - 1][0] > low)); at--) {
      memcpy(s->pair[at], s->pair[at - 1], sizeof s->pair[at]);
      c->edge[at] = c->edge[at - 1];
    }
    s->pair[at][0] = low, s->pair[at][1] = high;
    c->edge[at] = edge;
  }
}

static size_t read_components(component *list, const member *m, size_t count, const hk_stiff_edges *edges,
                              const double *bound) {
  size_t found = 0;
  for (size_t e = 0; e < count; found++) {
    component *c = &list[found];
    uint32_t root = m[e].root;
    *c = (component){.band = (int)floor(bands * log2(bound[root])), .bound = bound[root]};
    for (; e < count && m[e].root == root; e++) c->edge[c->shape.springs++] = m[e].edge;
    number_particles(c, edges);
    number_springs(c, edges);
  }
  return found;
}

/* ---- batches ---- */

/* Shapes together, and bands of them, in the order of their particles. */
static int by_shape(const void *a, const void *b) {
  const component *p = a, *q = b;
  int shape = memcmp(&p->shape, &q->shape, sizeof p->shape);
  if (shape) return shape;
  if (p->band != q->band) return p->band < q->band ? -1 : 1;
  return (p->particle[0] > q->particle[0]) - (p->particle[0] < q->particle[0]);
}

/* Those that make a batch with the first. */
static size_t alike(const component *list, size_t count) {
  size_t found = 1;
  while (found < count && found < LANES && memcmp(&list[found].shape, &list->shape, sizeof list->shape) == 0) found++;
  return found;
}

static void fill_lane(hk_short_batch *b, size_t lane, const component *c, const hk_model *model,
                      const hk_stiff_edges *edges, bool empty) {
  for (size_t i = 0; i < b->shape.n; i++) {
    b->index[i][lane] = c->particle[i];
    b->w[i][lane] = empty ? 0 : model->inverse_mass[c->particle[i]];
  }
  for (size_t e = 0; e < b->shape.springs && !empty; e++) {
    b->k[e][lane] = edges->k[c->edge[e]];
    b->tension[e][lane] = edges->k[c->edge[e]] * edges->L[c->edge[e]];
  }
}

typedef struct rows {
  hk_short_row *numbers;
  uint32_t (*indices)[LANES];
} rows;

static void fill(hk_short_batch *b, rows *r, const component *list, size_t count, const hk_model *model,
                 const hk_stiff_edges *edges) {
  size_t n = list->shape.n, springs = list->shape.springs;
  *b = (hk_short_batch){.shape = list->shape, .filled = (uint32_t)count};
  b->index = r->indices;
  b->w = r->numbers, b->k = b->w + n, b->tension = b->k + springs;
  r->indices += n, r->numbers += n + 2 * springs;
  for (size_t lane = 0; lane < LANES; lane++)
    fill_lane(b, lane, &list[lane < count ? lane : 0], model, edges, lane >= count);
  for (size_t c = 0; c < count; c++) b->stiffest = fmax(b->stiffest, list[c].bound);
}

static hk_status fill_all(hk_short_lanes *s, const hk_host *host, const component *list, size_t count,
                          const hk_model *model, const hk_stiff_edges *edges) {
  size_t numbers = 0, indices = 0, step;
  for (size_t c = 0; c < count; c += step, s->batches++) {
    step = alike(list + c, count - c);
    numbers += list[c].shape.n + 2 * (size_t)list[c].shape.springs;
    indices += list[c].shape.n;
  }
  s->batch = host->allocate(host, (s->batches + 1) * sizeof *s->batch);
  s->rows = host->allocate(host, (numbers + 1) * sizeof *s->rows);
  s->indices = host->allocate(host, (indices + 1) * sizeof *s->indices);
  if (!s->batch || !s->rows || !s->indices) return HK_NO_MEMORY;
  rows r = {s->rows, s->indices};
  hk_short_batch *b = s->batch;
  for (size_t c = 0; c < count; c += step) {
    step = alike(list + c, count - c);
    fill(b++, &r, list + c, step, model, edges);
  }
  return HK_OK;
}

hk_status hk_short_lanes_build(hk_short_lanes *s, const hk_host *host, const hk_model *model,
                               const hk_stiff_edges *edges, const uint32_t *edge, size_t count, const uint32_t *root,
                               const double *bound) {
  hk_short_lanes_free(s, host);
  if (count == 0) return HK_OK;
  member *m = host->allocate(host, count * sizeof *m);
  component *list = host->allocate(host, count * sizeof *list);
  hk_status status = m && list ? HK_OK : HK_NO_MEMORY;
  if (status == HK_OK) {
    for (size_t e = 0; e < count; e++) m[e] = (member){root[edges->pair[edge[e]][0]], edge[e]};
    qsort(m, count, sizeof *m, by_root);
    size_t components = read_components(list, m, count, edges, bound);
    qsort(list, components, sizeof *list, by_shape);
    status = fill_all(s, host, list, components, model, edges);
  }
  host->release(host, m);
  host->release(host, list);
  return status;
}

void hk_short_lanes_free(hk_short_lanes *s, const hk_host *host) {
  host->release(host, s->batch);
  host->release(host, s->rows);
  host->release(host, s->indices);
  *s = (hk_short_lanes){0};
}
