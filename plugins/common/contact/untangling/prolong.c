/* The way to the border that crosses the fewest edges, by a search in breadth over triangles, which does not cross the
 * curve itself. A way of more edges than half of the curve's points is none: then the curve does not nearly cut. */
#include "plugins/common/contact/untangling/prolong.h"
#include "plugins/common/space/reserve.h"

static const uint32_t NONE = UINT32_MAX;

static hk_status reserve(hk_prolong *p, const hk_host *host, const hk_surface_mesh *m) {
  hk_status status = hk_reserve(host, &p->side, &p->triangle_room[0], m->triangles, sizeof *p->side);
  if (status == HK_OK) status = hk_reserve(host, &p->from, &p->triangle_room[1], m->triangles, sizeof *p->from);
  if (status == HK_OK) status = hk_reserve(host, &p->queue, &p->triangle_room[2], m->triangles, sizeof *p->queue);
  if (status == HK_OK) status = hk_reserve(host, &p->depth, &p->triangle_room[3], m->triangles, sizeof *p->depth);
  return status == HK_OK ? hk_reserve(host, &p->barred, &p->edge_room, m->edges, sizeof *p->barred) : status;
}

static void list_sides(hk_prolong *p, const hk_surface_mesh *m) {
  memset(p->depth, 0, m->triangles * sizeof *p->depth); /* here: how many sides were found */
  memset(p->barred, 0, m->edges * sizeof *p->barred);
  for (uint32_t e = 0; e < m->edges; e++)
    for (int slot = 0; slot < 2; slot++) {
      uint32_t t = m->edge_faces[e][slot];
      if (t != NONE) p->side[t][p->depth[t]++] = e;
    }
  memset(p->depth, 0, m->triangles * sizeof *p->depth);
}

static void visit(hk_prolong *p, uint32_t triangle, uint32_t edge, uint32_t depth) {
  p->queue[p->reached++] = triangle;
  p->from[triangle] = edge;
  p->depth[triangle] = depth;
}

static uint32_t across(const hk_surface_mesh *m, uint32_t edge, uint32_t triangle) {
  return m->edge_faces[edge][m->edge_faces[edge][0] == triangle];
}

/* The border edge that is reached first, from the triangle at the queue's place *at; NONE: none is within `most`. */
static uint32_t search(hk_prolong *p, const hk_surface_mesh *m, uint32_t start, uint32_t most, uint32_t curve,
                       size_t *at) {
  p->reached = 0;
  visit(p, start, NONE, 1);
  for (*at = 0; *at < p->reached; ++*at) {
    uint32_t here = p->queue[*at];
    for (int k = 0; k < 3 && p->depth[here] <= most; k++) {
      uint32_t e = p->side[here][k], there = across(m, e, here);
      if (p->barred[e] == curve) continue;
      if (there == NONE) return e;
      if (!p->depth[there]) visit(p, there, e, p->depth[here] + 1);
    }
  }
  return NONE;
}

static bool prolong_side(hk_prolong *p, hk_contours *c, const hk_surface_mesh *m, size_t contour, uint32_t side) {
  hk_contour *one = &c->contour[contour];
  const hk_contour_point *end = &c->point[one->first]; /* the end that is within this surface */
  size_t at;
  if (end->side == side) end = &c->point[one->first + one->count - 1];
  uint32_t most = (uint32_t)(one->count / 2), edge = search(p, m, end->triangle, most, (uint32_t)contour + 1, &at);
  one->beyond[side].first = c->beyonds;
  if (edge != NONE) {
    uint32_t here = p->queue[at];
    c->beyond[c->beyonds++] = edge;
    for (edge = p->from[here]; edge != NONE; edge = p->from[here]) {
      c->beyond[c->beyonds++] = edge;
      here = across(m, edge, here);
    }
  }
  one->beyond[side].count = c->beyonds - one->beyond[side].first;
  for (size_t k = 0; k < p->reached; k++) p->depth[p->queue[k]] = 0;
  return one->beyond[side].count > 0;
}

/* Whether the curve begins on the border of one surface and ends on that of the other. */
static bool is_mixed(const hk_contours *c, const hk_contour *one) {
  return one->kind == HK_CONTOUR_BORDER && one->count > 1 &&
         c->point[one->first].side != c->point[one->first + one->count - 1].side;
}

hk_status hk_contours_prolong(hk_prolong *p, hk_contours *c, const hk_host *host, const hk_surface_mesh *m) {
  bool any = false;
  c->beyonds = 0;
  for (size_t k = 0; k < c->count; k++) any |= is_mixed(c, &c->contour[k]);
  if (!any) return HK_OK;
  hk_status status = reserve(p, host, m);
  /* two ways of half the points and the border's edge each */
  if (status == HK_OK)
    status = hk_reserve(host, &c->beyond, &c->beyond_room, c->points + 4 * c->count, sizeof *c->beyond);
  if (status != HK_OK) return status;
  list_sides(p, m);
  for (size_t k = 0; k < c->count; k++) {
    hk_contour *one = &c->contour[k];
    for (size_t j = one->first; j < one->first + one->count; j++) p->barred[c->point[j].edge] = (uint32_t)k + 1;
    for (uint32_t side = 0; side < 2 && is_mixed(c, one); side++) one->cuts[side] = prolong_side(p, c, m, k, side);
  }
  return HK_OK;
}

void hk_prolong_free(hk_prolong *p, const hk_host *host) {
  void *all[] = {p->side, p->from, p->queue, p->depth, p->barred};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) host->release(host, all[k]);
  *p = (hk_prolong){.reached = 0};
}
