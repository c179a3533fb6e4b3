/* The point where edge e pierces triangle f is an end of the pieces that f has with the triangles at e. Sorted by their
 * two triangles, the ends of a piece stand side by side. */
#include "plugins/common/contact/untangling/contours.h"
#include "plugins/common/space/reserve.h"

#include <stdlib.h>

static const uint32_t NONE = UINT32_MAX;

typedef struct hk_contour_link { /* an end of a piece */
  uint32_t low, high;            /* its triangles */
  uint32_t node, slot;           /* the point, and which of the edge's triangles it is */
} end_of_piece;

typedef struct hk_contour_node {
  uint32_t edge, triangle;
  uint32_t next[2], next_slot[2]; /* along the piece with each of the edge's triangles; NONE: the curve ends here */
  bool traced;
} node;

static int by_triangles(const void *a, const void *b) {
  const end_of_piece *p = a, *q = b;
  if (p->low != q->low) return p->low < q->low ? -1 : 1;
  if (p->high != q->high) return p->high < q->high ? -1 : 1;
  return (p->node > q->node) - (p->node < q->node);
}

static size_t list_ends(hk_contours *c, const hk_surface_mesh *m, const hk_surface_intersections *found) {
  size_t ends = 0;
  for (uint32_t k = 0; k < found->count; k++) {
    uint32_t e = found->pair[k][0], f = found->pair[k][1];
    c->node[k] = (node){.edge = e, .triangle = f, .next = {NONE, NONE}};
    for (uint32_t slot = 0; slot < 2; slot++) {
      uint32_t g = m->edge_faces[e][slot];
      if (g != NONE) c->link[ends++] = (end_of_piece){g < f ? g : f, g < f ? f : g, k, slot};
    }
  }
  if (ends > 1) qsort(c->link, ends, sizeof *c->link, by_triangles);
  return ends;
}

/* More than two ends at a pair of triangles: these touch, and which end goes with which is not known. */
static void join_ends(hk_contours *c, size_t ends) {
  for (size_t k = 0, same; k < ends; k += same) {
    const end_of_piece *p = &c->link[k];
    for (same = 1; k + same < ends && p[same].low == p->low && p[same].high == p->high; same++) continue;
    if (same != 2) continue;
    for (int end = 0; end < 2; end++) {
      node *from = &c->node[p[end].node];
      from->next[p[end].slot] = p[1 - end].node;
      from->next_slot[p[end].slot] = p[1 - end].slot;
    }
  }
}

static bool share_corner(const hk_surface_mesh *m, uint32_t f, uint32_t g) {
  bool shared = false;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) shared |= m->triangle[f][a] == m->triangle[g][b];
  return shared;
}

static hk_contour_kind end_at(const hk_surface_mesh *m, const node *n, uint32_t slot) {
  uint32_t face = m->edge_faces[n->edge][slot];
  if (face != NONE) return share_corner(m, face, n->triangle) ? HK_CONTOUR_LOOP : HK_CONTOUR_BROKEN;
  return m->edge_faces[n->edge][1 - slot] == NONE ? HK_CONTOUR_BROKEN : HK_CONTOUR_BORDER;
}

static void add_point(hk_contours *c, uint32_t k, uint32_t side) {
  node *n = &c->node[k];
  n->traced = true;
  c->point[c->points++] = (hk_contour_point){n->edge, n->triangle, side};
}

/* From node `start` on, by its piece `slot`, to an end or back to the start. `face` has the two triangles of the
 * present piece, one in each surface. */
static void trace(hk_contours *c, const hk_surface_mesh *m, uint32_t start, uint32_t slot) {
  hk_contour *made = &c->contour[c->count++];
  uint32_t at = start, face[2] = {m->edge_faces[c->node[start].edge][slot], c->node[start].triangle}, side = 0;
  *made = (hk_contour){.kind = HK_CONTOUR_CLOSED, .first = c->points};
  add_point(c, start, 0);
  while (c->node[at].next[slot] != NONE) {
    uint32_t next = c->node[at].next[slot], into = c->node[at].next_slot[slot];
    side = c->node[next].triangle == face[1] ? 0 : 1;
    if (c->node[next].traced) break;
    add_point(c, next, side);
    at = next;
    slot = 1 - into;
    face[side] = m->edge_faces[c->node[at].edge][slot];
  }
  made->count = c->points - made->first;
  if (c->node[at].next[slot] == NONE)
    made->kind = end_at(m, &c->node[at], slot);
  else
    made->twisted = side == 1; /* the start was on side 0 */
}

static void count_kinds(hk_contours *c) {
  for (int kind = 0; kind < HK_CONTOUR_KINDS; kind++) c->kinds[kind] = 0;
  for (size_t k = 0; k < c->count; k++) c->kinds[c->contour[k].kind]++;
}

/* Curves with ends first, so that what is left is closed. */
static void trace_all(hk_contours *c, const hk_surface_mesh *m, size_t nodes) {
  c->points = c->count = c->beyonds = 0;
  for (uint32_t k = 0; k < nodes; k++)
    for (uint32_t slot = 0; slot < 2 && !c->node[k].traced; slot++) {
      if (c->node[k].next[slot] != NONE) continue;
      hk_contour_kind begin = end_at(m, &c->node[k], slot);
      trace(c, m, k, 1 - slot);
      hk_contour *made = &c->contour[c->count - 1];
      made->kind = begin > made->kind ? begin : made->kind;
      uint32_t last = c->point[made->first + made->count - 1].side;
      made->cuts[0] = made->kind == HK_CONTOUR_BORDER && last == 0 && made->count > 1; /* the start is on side 0 */
    }
  for (uint32_t k = 0; k < nodes; k++)
    if (!c->node[k].traced) trace(c, m, k, 0);
  count_kinds(c);
}

hk_status hk_contours_trace(hk_contours *c, const hk_host *host, const hk_surface_mesh *m,
                            const hk_surface_intersections *found) {
  size_t nodes = found->count;
  hk_status status = hk_reserve(host, &c->node, &c->node_room, nodes, sizeof *c->node);
  if (status == HK_OK) status = hk_reserve(host, &c->link, &c->link_room, 2 * nodes, sizeof *c->link);
  if (status == HK_OK) status = hk_reserve(host, &c->point, &c->point_room, nodes, sizeof *c->point);
  if (status == HK_OK) status = hk_reserve(host, &c->contour, &c->contour_room, nodes, sizeof *c->contour);
  if (status != HK_OK) return status;
  join_ends(c, list_ends(c, m, found));
  trace_all(c, m, nodes);
  return HK_OK;
}

void hk_contours_free(hk_contours *c, const hk_host *host) {
  void *all[] = {c->node, c->link, c->point, c->contour, c->beyond};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) host->release(host, all[k]);
  *c = (hk_contours){.points = 0};
}
