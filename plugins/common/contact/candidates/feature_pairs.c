#include "plugins/common/contact/candidates/feature_pairs.h"

typedef struct task {
  hk_broad_phase *search;
  hk_gather *into;
} task;

typedef hk_pair_output output;

static bool among(const uint32_t *v, int count, uint32_t i) {
  bool found = false;
  for (int c = 0; c < count; c++) found |= v[c] == i;
  return found;
}

bool hk_point_is_near(const hk_broad_phase *s, const uint32_t v[4], double offset) {
  hk_swept_set point = hk_swept(s->swept, v, 1), face = hk_swept(s->swept, v + 1, 3);
  double distance = hk_broad_phase_distance(s, offset);
  return !hk_apart_by_boxes(&point, &face, distance) && !hk_apart_by_middles(&point, &face, distance) &&
         !hk_apart_by_face(&face, &point, &face, distance);
}

bool hk_edges_are_near(const hk_broad_phase *s, const uint32_t v[4], double offset) {
  hk_swept_set a = hk_swept(s->swept, v, 2), b = hk_swept(s->swept, v + 2, 2);
  double distance = hk_broad_phase_distance(s, offset);
  return !hk_apart_by_boxes(&a, &b, distance) && !hk_apart_by_middles(&a, &b, distance) &&
         !hk_apart_by_normal(a.point[0], a.point[1], b.point[0], b.point[1], &a, &b, distance);
}

/* Of a pair that no axis keeps apart: its gap at the start. False: it cannot come within reach by that. */
static bool find_gap(const hk_broad_phase *s, hk_feature_pair *pair) {
  hk_pair_path path;
  for (int k = 0; k < 4; k++)
    for (int c = 0; c < 3; c++) {
      hk_two x = s->swept[pair->vertex[k]].x[c];
      path.from[3 * k + c] = x[0], path.to[3 * k + c] = x[1];
    }
  pair->gap = sqrt(hk_nearest_of_pair(pair->kind, path.from).squared) - pair->offset - s->slack;
  return pair->gap - hk_pair_approach(pair->kind, &path) <= s->move.reach;
}

static void add_pair(const output *o, hk_pair_kind kind, const uint32_t v[4], double offset) {
  hk_feature_pair pair = {{v[0], v[1], v[2], v[3]}, kind, offset, NAN};
  if (o->gaps && !find_gap(o->search, &pair)) return;
  hk_feature_pair *record = hk_gather_add(o->into, o->chunk);
  if (record) *record = pair;
}

static bool are_held(const hk_broad_phase *s, const uint32_t v[4]) {
  return s->held[v[0]] && s->held[v[1]] && s->held[v[2]] && s->held[v[3]];
}

bool hk_features_left_out(const hk_surface_lists *l, const uint32_t *a, int of_a, const uint32_t *b, int of_b) {
  return l->joined.is_held &&
         (hk_solid_holds(&l->joined, l->solid[b[0]], a, of_a) || hk_solid_holds(&l->joined, l->solid[a[0]], b, of_b));
}

static void try_point(const output *o, uint32_t p, const uint32_t t[3]) {
  const hk_broad_phase *s = o->search;
  const uint32_t v[4] = {p, t[0], t[1], t[2]};
  double offset = hk_feature_radius(&s->lists->mesh, v, 1) + hk_feature_radius(&s->lists->mesh, t, 3);
  if (!are_held(s, v) && hk_point_is_near(s, v, offset) && !hk_features_left_out(s->lists, v, 1, t, 3))
    add_pair(o, HK_POINT_TRIANGLE, v, offset);
}

static void try_edge(const output *o, const uint32_t e[2], const uint32_t f[2]) {
  const hk_broad_phase *s = o->search;
  const uint32_t v[4] = {e[0], e[1], f[0], f[1]};
  double offset = hk_feature_radius(&s->lists->mesh, e, 2) + hk_feature_radius(&s->lists->mesh, f, 2);
  if (!are_held(s, v) && hk_edges_are_near(s, v, offset) && !hk_features_left_out(s->lists, e, 2, f, 2))
    add_pair(o, HK_EDGE_EDGE, v, offset);
}

/* An item of a pair, with those of its features that come near the box of the other one. */
typedef struct member {
  const hk_surface_item *item;
  const hk_box *box;
  unsigned points, edges; /* bits */
} member;

/* Whether a feature's box comes near that of an item, which has its radius in it. */
static bool is_near(const hk_broad_phase *s, const uint32_t *v, int count, const hk_box *box) {
  hk_swept_set set = hk_swept(s->swept, v, count);
  double distance = hk_broad_phase_distance(s, hk_feature_radius(&s->lists->mesh, v, count));
  bool apart = false;
  for (int c = 0; c < 3; c++) {
    hk_two_range r = hk_range_of(&set, c);
    apart |= hk_lesser(r.low) - box->high[c] > distance || hk_lesser(-r.high) + box->low[c] > distance;
  }
  return !apart;
}

/* Edges have their lower particle first. */
static void ends_of(const hk_surface_item *item, int c, uint32_t end[2]) {
  uint32_t p = item->vertex[hk_item_ends[c][0]], q = item->vertex[hk_item_ends[c][1]];
  end[0] = p < q ? p : q;
  end[1] = p < q ? q : p;
}

static void sift(const hk_broad_phase *s, member *m, const hk_box *other) {
  m->points = m->edges = 0;
  for (int c = 0; c < 4; c++)
    if ((m->item->points >> c & 1) && is_near(s, &m->item->vertex[c], 1, other)) m->points |= 1u << c;
  for (int c = 0; c < HK_ITEM_EDGES; c++) {
    uint32_t end[2];
    if (m->item->edge[c] == UINT32_MAX) continue;
    ends_of(m->item, c, end);
    if (is_near(s, end, 2, other)) m->edges |= 1u << c;
  }
}

static void try_points_on(const output *o, const member *a, const uint32_t t[3]) {
  for (unsigned left = a->points; left; left &= left - 1) {
    uint32_t p = a->item->vertex[__builtin_ctz(left)];
    if (!among(t, 3, p)) try_point(o, p, t);
  }
}

/* The points that a owns against the triangles of b. */
static void try_points(const output *o, const member *a, const member *b) {
  const hk_surface_mesh *m = &o->search->lists->mesh;
  for (int k = 0; a->points && k < 2; k++)
    if (b->item->triangle[k] != UINT32_MAX) try_points_on(o, a, m->triangle[b->item->triangle[k]]);
}

static void try_edges_of(const output *o, const uint32_t e[2], const hk_surface_item *item, unsigned edges) {
  for (; edges; edges &= edges - 1) {
    uint32_t f[2];
    ends_of(item, __builtin_ctz(edges), f);
    if (!among(f, 2, e[0]) && !among(f, 2, e[1])) try_edge(o, e, f);
  }
}

/* An isolated particle meets triangles as a point; its edge of length 0 would say the same of their edges. Of an item
 * with itself, each pair once. */
static void try_edges(const output *o, const member *a, const member *b) {
  const hk_surface_item *i = a->item, *j = b->item;
  if ((hk_item_is_isolated(i) && hk_item_has_triangles(j)) || (hk_item_is_isolated(j) && hk_item_has_triangles(i)))
    return;
  for (unsigned left = a->edges; left; left &= left - 1) {
    uint32_t e[2];
    ends_of(i, __builtin_ctz(left), e);
    try_edges_of(o, e, j, i == j ? left & (left - 1) : b->edges);
  }
}

bool hk_items_left_out(const hk_surface_lists *l, const hk_surface_item *a, const hk_surface_item *b) {
  uint32_t solid = l->solid[a->vertex[0]], other = l->solid[b->vertex[0]];
  if (!hk_solids_apart(&l->joined, solid, other)) return false;
  for (int c = 1; c < 4; c++)
    if (l->solid[a->vertex[c]] != solid || l->solid[b->vertex[c]] != other) return false;
  return true;
}

void hk_items_compare(const output *o, uint32_t place, uint32_t other) {
  const hk_broad_phase *s = o->search;
  if (hk_items_left_out(s->lists, &s->items.item[s->order[place]], &s->items.item[s->order[other]])) return;
  member a = {.item = &s->items.item[s->order[place]], .box = &s->box[place]};
  member b = {.item = &s->items.item[s->order[other]], .box = &s->box[other]};
  sift(s, &a, b.box);
  sift(s, &b, a.box);
  try_points(o, &a, &b);
  if (place != other) try_points(o, &b, &a);
  try_edges(o, &a, &b);
}

static void try_row(const output *o, uint32_t k) {
  const hk_broad_phase *s = o->search;
  const uint32_t *near = hk_gather_records(&s->near, k);
  hk_gather_row(o->into, o->chunk, k);
  if (s->items.item[s->order[k]].triangle[1] != UINT32_MAX) hk_items_compare(o, k, k);
  for (size_t q = 0; q < s->near.row[k].count; q++) hk_items_compare(o, k, near[q]);
}

static void pair_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  output o = {.search = t->search, .into = t->into, .chunk = chunk};
  for (size_t leaf = begin; leaf < end; leaf++) {
    const uint32_t *place;
    size_t count = hk_broad_phase_leaf(o.search, leaf, &place);
    for (size_t q = 0; q < count; q++)
      if (place[q] < o.search->moving) try_row(&o, place[q]);
  }
}

hk_status hk_feature_pairs_find(hk_broad_phase *s, const hk_host *host, const hk_surface_move *move, hk_gather *pairs) {
  task t = {s, pairs};
  hk_status status = hk_broad_phase_run(s, host, move);
  if (status == HK_OK)
    status = hk_gather_run(pairs, host, s->moving, hk_broad_phase_leaves(s), HK_BROAD_PHASE_LEAVES, pair_chunk, &t);
  return status == HK_OK ? hk_gather_join(pairs, host) : status;
}
