#include "plugins/common/surfaces/surface_pairs.h"

enum { GRAIN = 1024 };

typedef struct task {
  const hk_surface_search *search;
  double reach;
  hk_gather *into;
} task;

typedef struct output {
  const task *task;
  size_t chunk;
} output;

static bool among(const uint32_t *v, int count, uint32_t i) {
  bool found = false;
  for (int c = 0; c < count; c++) found |= v[c] == i;
  return found;
}

static void add_pair(const output *o, hk_pair_kind kind, const uint32_t v[4]) {
  const hk_surface_search *s = o->task->search;
  const hk_surface_mesh *m = &s->lists->mesh;
  if (s->held[v[0]] && s->held[v[1]] && s->held[v[2]] && s->held[v[3]]) return;
  hk_surface_pair *pair = hk_gather_add(o->task->into, o->chunk);
  if (!pair) return;
  int first = kind == HK_POINT_TRIANGLE ? 1 : 2;
  double offset = hk_feature_radius(m, v, first) + hk_feature_radius(m, v + first, 4 - first);
  *pair = (hk_surface_pair){{v[0], v[1], v[2], v[3]}, kind, offset};
}

static void try_point(const output *o, uint32_t p, const hk_surface_item *triangle, const hk_box *around) {
  const uint32_t *t = triangle->vertex;
  if (among(t, 3, p) || !hk_boxes_near(&o->task->search->swept[p], around, o->task->reach)) return;
  add_pair(o, HK_POINT_TRIANGLE, (uint32_t[]){p, t[0], t[1], t[2]});
}

/* The points that `item` owns against a triangle. */
static void try_points(const output *o, const hk_surface_item *item, const hk_surface_item *triangle) {
  const hk_box *swept = o->task->search->swept;
  const uint32_t *t = triangle->vertex;
  if (!(triangle->owns & HK_IS_TRIANGLE)) return;
  hk_box two = hk_box_around(&swept[t[0]], &swept[t[1]]), around = hk_box_around(&two, &swept[t[2]]);
  for (int c = 0; c < 3; c++)
    if (item->owns & (unsigned)HK_OWNS_POINT << c) try_point(o, item->vertex[c], triangle, &around);
}

/* Edges have their lower particle first. */
static void ends_of(const hk_surface_item *item, int c, uint32_t end[2]) {
  uint32_t p = item->vertex[c], q = item->vertex[(c + 1) % 3];
  end[0] = p < q ? p : q;
  end[1] = p < q ? q : p;
}

static void try_edge(const output *o, const uint32_t e[2], const hk_box *around, const hk_surface_item *item) {
  const hk_box *swept = o->task->search->swept;
  for (int c = 0; c < 3; c++) {
    uint32_t f[2];
    if (!(item->owns & (unsigned)HK_OWNS_EDGE << c)) continue;
    ends_of(item, c, f);
    if (among(f, 2, e[0]) || among(f, 2, e[1])) continue;
    hk_box other = hk_box_around(&swept[f[0]], &swept[f[1]]);
    if (hk_boxes_near(around, &other, o->task->reach)) add_pair(o, HK_EDGE_EDGE, (uint32_t[]){e[0], e[1], f[0], f[1]});
  }
}

/* A lone particle meets triangles as a point; its edge of length 0 would say the same of their edges. */
static bool edges_meet(const hk_surface_item *a, const hk_surface_item *b) {
  unsigned both = a->owns | b->owns;
  return !((both & HK_IS_TRIANGLE) && (both & HK_IS_LONE));
}

static void try_edges(const output *o, const hk_surface_item *a, const hk_surface_item *b) {
  const hk_box *swept = o->task->search->swept;
  for (int c = 0; c < 3; c++) {
    uint32_t e[2];
    if (!(a->owns & (unsigned)HK_OWNS_EDGE << c)) continue;
    ends_of(a, c, e);
    hk_box around = hk_box_around(&swept[e[0]], &swept[e[1]]);
    try_edge(o, e, &around, b);
  }
}

static void pair_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  output o = {context, chunk};
  const hk_surface_search *s = o.task->search;
  const hk_item_pair *pair = s->rows.record;
  for (size_t k = begin; k < end; k++) {
    const hk_surface_item *a = &s->lists->item[pair[k].a], *b = &s->lists->item[pair[k].b];
    try_points(&o, a, b);
    try_points(&o, b, a);
    if (edges_meet(a, b)) try_edges(&o, a, b);
  }
}

hk_status hk_surface_pairs_find(hk_surface_search *s, const hk_host *host, const hk_surface_move *move,
                                hk_gather *pairs) {
  task t = {s, move->reach, pairs};
  hk_status status = hk_surface_search_rows(s, host, move);
  return status == HK_OK ? hk_gather_run(pairs, host, s->rows.count, GRAIN, pair_chunk, &t) : status;
}
