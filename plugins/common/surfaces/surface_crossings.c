/* Edges against triangles at given positions: boxes that overlap, then the exact predicate. */
#include "plugins/common/collision/exact.h"
#include "plugins/common/surfaces/surface_pairs.h"

#include <stdlib.h>

enum { GRAIN = 1024 };

typedef struct task {
  const hk_surface_search *search;
  const double *x;
  hk_gather *into;
} task;

static bool shares(const uint32_t t[3], const uint32_t e[2]) {
  bool found = false;
  for (int c = 0; c < 3; c++) found |= t[c] == e[0] || t[c] == e[1];
  return found;
}

static bool all_held(const hk_surface_search *s, const uint32_t t[3], const uint32_t e[2]) {
  return s->held[t[0]] && s->held[t[1]] && s->held[t[2]] && s->held[e[0]] && s->held[e[1]];
}

static void try_edge(const task *t, size_t chunk, uint32_t edge, uint32_t triangle) {
  const hk_surface_search *s = t->search;
  const uint32_t *e = s->lists->mesh.edge[edge], *v = s->lists->mesh.triangle[triangle];
  if (shares(v, e) || all_held(s, v, e)) return;
  hk_point corner[5] = {t->x + 3 * (size_t)e[0], t->x + 3 * (size_t)e[1], t->x + 3 * (size_t)v[0],
                        t->x + 3 * (size_t)v[1], t->x + 3 * (size_t)v[2]};
  if (!hk_segment_meets_triangle(corner[0], corner[1], corner[2], corner[3], corner[4])) return;
  uint32_t *found = hk_gather_add(t->into, chunk);
  if (found) found[0] = edge, found[1] = triangle;
}

static hk_box box_of(const hk_surface_search *s, const uint32_t *v, int count) {
  hk_box box = s->swept[v[0]];
  for (int c = 1; c < count; c++) box = hk_box_around(&box, &s->swept[v[c]]);
  return box;
}

/* The edges that an item owns against a triangle. */
static void try_edges(const task *t, size_t chunk, uint32_t item, uint32_t triangle) {
  const hk_surface_search *s = t->search;
  const hk_surface_lists *l = s->lists;
  if (!(l->item[triangle].owns & HK_IS_TRIANGLE) || (l->item[item].owns & HK_IS_LONE)) return;
  hk_box around = box_of(s, l->item[triangle].vertex, 3);
  for (int c = 0; c < 3; c++) {
    uint32_t edge = l->item_edge[item][c];
    if (edge == HK_NO_EDGE) continue;
    hk_box box = box_of(s, l->mesh.edge[edge], 2);
    if (hk_box_overlap(&box, &around)) try_edge(t, chunk, edge, triangle);
  }
}

static void cross_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_item_pair *pair = t->search->rows.record;
  for (size_t k = begin; k < end; k++) {
    try_edges(t, chunk, pair[k].a, pair[k].b);
    try_edges(t, chunk, pair[k].b, pair[k].a);
  }
}

static int rising(const void *a, const void *b) {
  const uint32_t *p = a, *q = b;
  int c = p[0] == q[0];
  return (p[c] > q[c]) - (p[c] < q[c]);
}

hk_status hk_surface_crossings_find(hk_surface_search *s, const hk_host *host, const double *x, hk_gather *crossings) {
  task t = {s, x, crossings};
  hk_surface_move move = {.x_from = x, .x_to = x, .bare = true};
  hk_status status = hk_surface_search_rows(s, host, &move);
  if (status == HK_OK) status = hk_gather_run(crossings, host, s->rows.count, GRAIN, cross_chunk, &t);
  if (status == HK_OK && crossings->count > 1) qsort(crossings->record, crossings->count, 2 * sizeof(uint32_t), rising);
  return status;
}
