/* Edges against triangles at given positions. Most that are near are kept apart by an axis, which costs little and is
 * right beyond rounding; the exact predicate decides the rest. */
#include "plugins/common/contact/geometry/exact.h"
#include "plugins/common/contact/candidates/feature_pairs.h"

#include <stdlib.h>

typedef struct task {
  const hk_broad_phase *search;
  const double *x;
  hk_gather *into;
} task;

static bool shares(const uint32_t t[3], const uint32_t e[2]) {
  bool found = false;
  for (int c = 0; c < 3; c++) found |= t[c] == e[0] || t[c] == e[1];
  return found;
}

static bool all_held(const hk_broad_phase *s, const uint32_t t[3], const uint32_t e[2]) {
  return s->held[t[0]] && s->held[t[1]] && s->held[t[2]] && s->held[e[0]] && s->held[e[1]];
}

/* The normals of the triangle's sides in its plane separate what lies in that plane. */
static bool apart_by_sides(const hk_swept_set *edge, const hk_swept_set *face, double distance) {
  double side[3][3], n[3];
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < 3; c++) side[k][c] = face->point[(k + 1) % 3]->x[c][0] - face->point[k]->x[c][0];
  for (int c = 0, d = 1, e = 2; c < 3; c++, d = (d + 1) % 3, e = (e + 1) % 3)
    n[c] = side[0][d] * side[1][e] - side[0][e] * side[1][d];
  for (int k = 0; k < 3; k++) {
    const double *s = side[k],
                 axis[3] = {n[1] * s[2] - n[2] * s[1], n[2] * s[0] - n[0] * s[2], n[0] * s[1] - n[1] * s[0]};
    if (hk_apart_along(axis, edge, face, distance)) return true;
  }
  return false;
}

static bool are_apart(const hk_broad_phase *s, const uint32_t *e, const uint32_t *t) {
  hk_swept_set edge = hk_swept(s->swept, e, 2), face = hk_swept(s->swept, t, 3);
  double distance = hk_broad_phase_distance(s, 0);
  return hk_apart_by_boxes(&edge, &face, distance) || hk_apart_by_middles(&edge, &face, distance) ||
         hk_apart_by_face(&face, &edge, &face, distance) || apart_by_sides(&edge, &face, distance);
}

static void try_edge(const task *t, size_t chunk, uint32_t edge, uint32_t triangle) {
  const hk_broad_phase *s = t->search;
  const uint32_t *e = s->lists->mesh.edge[edge], *v = s->lists->mesh.triangle[triangle];
  if (shares(v, e) || all_held(s, v, e) || are_apart(s, e, v) || hk_features_left_out(s->lists, e, 2, v, 3)) return;
  hk_point corner[5] = {t->x + 3 * (size_t)e[0], t->x + 3 * (size_t)e[1], t->x + 3 * (size_t)v[0],
                        t->x + 3 * (size_t)v[1], t->x + 3 * (size_t)v[2]};
  if (!hk_segment_meets_triangle(corner[0], corner[1], corner[2], corner[3], corner[4])) return;
  uint32_t *found = hk_gather_add(t->into, chunk);
  if (found) found[0] = edge, found[1] = triangle;
}

/* The edges that an item owns against the triangles of another one. (Those of two triangles that share an edge share a
 * particle with both.) */
static void try_edges(const task *t, size_t chunk, const hk_surface_item *item, const hk_surface_item *other) {
  if (hk_item_is_isolated(item) || !hk_item_has_triangles(other)) return;
  for (int c = 0; c < HK_ITEM_EDGES; c++)
    for (int k = 0; k < 2; k++)
      if (item->edge[c] != UINT32_MAX && other->triangle[k] != UINT32_MAX)
        try_edge(t, chunk, item->edge[c], other->triangle[k]);
}

/* What a body has in itself is no pair of contact, but counts: it is not the body that was meant. */
static bool of_two_bodies(const hk_surface_lists *l, const hk_surface_item *a, const hk_surface_item *b) {
  return l->solid[a->vertex[0]] != l->solid[b->vertex[0]];
}

static void cross_row(const task *t, size_t chunk, uint32_t k) {
  const hk_broad_phase *s = t->search;
  const uint32_t *near = hk_gather_records(&s->near, k);
  hk_gather_row(t->into, chunk, k);
  for (size_t q = 0; q < s->near.row[k].count; q++) {
    const hk_surface_item *a = &s->items.item[s->order[k]], *b = &s->items.item[s->order[near[q]]];
    if (of_two_bodies(s->lists, a, b) && hk_items_left_out(s->lists, a, b)) continue;
    try_edges(t, chunk, a, b);
    try_edges(t, chunk, b, a);
  }
}

static void cross_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  for (size_t leaf = begin; leaf < end; leaf++) {
    const uint32_t *place;
    size_t count = hk_broad_phase_leaf(t->search, leaf, &place);
    for (size_t q = 0; q < count; q++)
      if (place[q] < t->search->moving) cross_row(t, chunk, place[q]);
  }
}

static int rising(const void *a, const void *b) {
  const uint32_t *p = a, *q = b;
  int c = p[0] == q[0];
  return (p[c] > q[c]) - (p[c] < q[c]);
}

hk_status hk_crossings_find(hk_broad_phase *s, const hk_host *host, const double *x, hk_gather *crossings) {
  task t = {s, x, crossings};
  hk_surface_move still = {.x_from = x, .x_to = x, .bare = true};
  hk_status status = hk_broad_phase_run(s, host, &still);
  if (status == HK_OK)
    status =
        hk_gather_run(crossings, host, s->moving, hk_broad_phase_leaves(s), HK_BROAD_PHASE_LEAVES, cross_chunk, &t);
  if (status == HK_OK) status = hk_gather_join(crossings, host);
  if (status == HK_OK && crossings->count > 1) qsort(crossings->record, crossings->count, 2 * sizeof(uint32_t), rising);
  return status;
}
