#include "plugins/common/surfaces/surface_pairs.h"

typedef struct task {
  const hk_surface_search *search;
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

bool hk_surface_point_near(const hk_surface_search *s, const uint32_t v[4], double offset) {
  hk_swept_set point = hk_swept(s->swept, v, 1), face = hk_swept(s->swept, v + 1, 3);
  double distance = hk_surface_distance(s, offset);
  return !hk_apart_by_boxes(&point, &face, distance) && !hk_apart_by_middles(&point, &face, distance) &&
         !hk_apart_by_face(&face, &point, &face, distance);
}

bool hk_surface_edges_near(const hk_surface_search *s, const uint32_t v[4], double offset) {
  hk_swept_set a = hk_swept(s->swept, v, 2), b = hk_swept(s->swept, v + 2, 2);
  double distance = hk_surface_distance(s, offset);
  return !hk_apart_by_boxes(&a, &b, distance) && !hk_apart_by_middles(&a, &b, distance) &&
         !hk_apart_by_normal(a.point[0], a.point[1], b.point[0], b.point[1], &a, &b, distance);
}

static void try_pair(const output *o, hk_pair_kind kind, const uint32_t v[4]) {
  const hk_surface_search *s = o->task->search;
  const hk_surface_mesh *m = &s->lists->mesh;
  int first = kind == HK_POINT_TRIANGLE ? 1 : 2;
  double offset = hk_feature_radius(m, v, first) + hk_feature_radius(m, v + first, 4 - first);
  if (s->held[v[0]] && s->held[v[1]] && s->held[v[2]] && s->held[v[3]]) return;
  if (!(kind == HK_POINT_TRIANGLE ? hk_surface_point_near : hk_surface_edges_near)(s, v, offset)) return;
  hk_surface_pair *pair = hk_gather_add(o->task->into, o->chunk);
  if (pair) *pair = (hk_surface_pair){{v[0], v[1], v[2], v[3]}, kind, offset};
}

/* The points that `item` owns against a triangle. */
static void try_points(const output *o, const hk_surface_item *item, const hk_surface_item *triangle) {
  const uint32_t *t = triangle->vertex;
  if (!(triangle->owns & HK_IS_TRIANGLE)) return;
  for (int c = 0; c < 3; c++) {
    uint32_t p = item->vertex[c];
    if ((item->owns & (unsigned)HK_OWNS_POINT << c) && !among(t, 3, p))
      try_pair(o, HK_POINT_TRIANGLE, (uint32_t[]){p, t[0], t[1], t[2]});
  }
}

/* Edges have their lower particle first. */
static void ends_of(const hk_surface_item *item, int c, uint32_t end[2]) {
  uint32_t p = item->vertex[c], q = item->vertex[(c + 1) % 3];
  end[0] = p < q ? p : q;
  end[1] = p < q ? q : p;
}

static void try_edge(const output *o, const uint32_t e[2], const hk_surface_item *item) {
  for (int c = 0; c < 3; c++) {
    uint32_t f[2];
    if (!(item->owns & (unsigned)HK_OWNS_EDGE << c)) continue;
    ends_of(item, c, f);
    if (!among(f, 2, e[0]) && !among(f, 2, e[1])) try_pair(o, HK_EDGE_EDGE, (uint32_t[]){e[0], e[1], f[0], f[1]});
  }
}

/* A lone particle meets triangles as a point; its edge of length 0 would say the same of their edges. */
static void try_edges(const output *o, const hk_surface_item *a, const hk_surface_item *b) {
  unsigned both = a->owns | b->owns;
  if ((both & HK_IS_TRIANGLE) && (both & HK_IS_LONE)) return;
  for (int c = 0; c < 3; c++) {
    uint32_t e[2];
    if (!(a->owns & (unsigned)HK_OWNS_EDGE << c)) continue;
    ends_of(a, c, e);
    try_edge(o, e, b);
  }
}

static void try_row(const output *o, uint32_t k) {
  const hk_surface_search *s = o->task->search;
  const hk_surface_item *item = s->lists->item, *a = &item[s->order[k]];
  const uint32_t *near = hk_gather_records(&s->near, k);
  hk_gather_row(o->task->into, o->chunk, k);
  for (size_t q = 0; q < s->near.row[k].count; q++) {
    const hk_surface_item *b = &item[s->order[near[q]]];
    try_points(o, a, b);
    try_points(o, b, a);
    try_edges(o, a, b);
  }
}

static void pair_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  output o = {context, chunk};
  for (size_t leaf = begin; leaf < end; leaf++) {
    const uint32_t *place;
    size_t count = hk_surface_search_leaf(o.task->search, leaf, &place);
    for (size_t q = 0; q < count; q++)
      if (place[q] < o.task->search->moving) try_row(&o, place[q]);
  }
}

hk_status hk_surface_pairs_find(hk_surface_search *s, const hk_host *host, const hk_surface_move *move,
                                hk_gather *pairs) {
  task t = {s, pairs};
  hk_status status = hk_surface_search_run(s, host, move);
  if (status == HK_OK)
    status = hk_gather_run(pairs, host, s->moving, hk_surface_search_leaves(s), HK_SEARCH_LEAVES, pair_chunk, &t);
  return status == HK_OK ? hk_gather_join(pairs, host) : status;
}
