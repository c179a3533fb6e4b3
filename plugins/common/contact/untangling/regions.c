/* Vertices that edges join which no curve crosses belong together, whatever the curve: that is found once, by
 * union-find. A curve then colours these few groups: across an edge that it crosses an odd number of times the colour
 * changes, across others it does not. Where that contradicts itself the curve encloses nothing (around a hole of a
 * surface, say), which is said. */
#include "plugins/common/contact/untangling/regions.h"
#include "plugins/kit/vector3.h"
#include "plugins/common/space/reserve.h"
#include "plugins/common/space/union_find.h"

static const uint32_t NONE = UINT32_MAX;

/* ---- groups ---- */

static void list_crossed(hk_regions *r, const hk_surface_mesh *m, const hk_contours *c) {
  r->crossed = 0;
  memset(r->place, 0, m->edges * sizeof *r->place);
  for (size_t k = 0; k < c->points + c->beyonds; k++) {
    uint32_t e = k < c->points ? c->point[k].edge : c->beyond[k - c->points];
    if (r->place[e]) continue;
    r->edge[r->crossed++] = e;
    r->place[e] = (uint32_t)r->crossed;
  }
}

static void find_groups(hk_regions *r, const hk_surface_mesh *m, size_t n, const double *x) {
  for (uint32_t i = 0; i < n; i++) r->root[i] = i, r->head[i] = NONE, r->area[i] = 0, r->colour[i] = 0;
  for (size_t e = 0; e < m->edges; e++) {
    if (r->place[e]) continue;
    hk_unite(r->root, m->edge[e][0], m->edge[e][1]);
  }
  for (uint32_t i = (uint32_t)n; i-- > 0;) {
    uint32_t root = hk_root_of(r->root, i);
    r->next[i] = r->head[root];
    r->head[root] = i;
  }
  for (size_t t = 0; t < m->triangles; t++) {
    const uint32_t *v = m->triangle[t];
    double p[3], q[3], normal[3];
    hk_subtract(p, x + 3 * (size_t)v[1], x + 3 * (size_t)v[0]);
    hk_subtract(q, x + 3 * (size_t)v[2], x + 3 * (size_t)v[0]);
    hk_cross(normal, p, q);
    for (int k = 0; k < 3; k++) r->area[hk_root_of(r->root, v[k])] += hk_length(normal) / 6;
  }
}

/* The crossed edges at each group, those of root i from start[i] on. */
static void list_incident(hk_regions *r, const hk_surface_mesh *m, size_t n) {
  memset(r->start, 0, (n + 2) * sizeof *r->start);
  for (size_t k = 0; k < 2 * r->crossed; k++) r->start[hk_root_of(r->root, m->edge[r->edge[k / 2]][k % 2]) + 2]++;
  for (size_t i = 0; i < n; i++) r->start[i + 2] += r->start[i + 1];
  for (size_t k = 0; k < 2 * r->crossed; k++)
    r->incident[r->start[hk_root_of(r->root, m->edge[r->edge[k / 2]][k % 2]) + 1]++] = (uint32_t)(k / 2);
}

/* ---- one curve ---- */

static bool on_curve(const hk_contour *c, const hk_contour_point *p, uint32_t side) {
  return c->twisted || p->side == side;
}

static void mark_odd(hk_regions *r, const hk_contours *all, const hk_contour *c, uint32_t side) {
  memset(r->odd, 0, r->crossed);
  for (size_t k = c->first; k < c->first + c->count; k++)
    if (on_curve(c, &all->point[k], side)) r->odd[r->place[all->point[k].edge] - 1] ^= 1;
  for (size_t k = 0; k < c->beyond[side].count; k++) r->odd[r->place[all->beyond[c->beyond[side].first + k]] - 1] ^= 1;
}

/* Colours the groups that are connected with that of vertex i. False: the colours contradict each other. */
static bool colour_from(hk_regions *r, const hk_surface_mesh *m, uint32_t i) {
  bool fine = true;
  r->seen_count = 1;
  r->seen[0] = hk_root_of(r->root, i);
  r->colour[r->seen[0]] = 1;
  for (size_t k = 0; k < r->seen_count; k++) {
    uint32_t here = r->seen[k];
    for (uint32_t j = r->start[here]; j < r->start[here + 1]; j++) {
      const uint32_t *ends = m->edge[r->edge[r->incident[j]]];
      uint32_t a = hk_root_of(r->root, ends[0]), b = hk_root_of(r->root, ends[1]), there = a == here ? b : a;
      uint8_t wanted = r->odd[r->incident[j]] ? 3 - r->colour[here] : r->colour[here];
      if (!r->colour[there]) r->seen[r->seen_count++] = there, r->colour[there] = wanted;
      fine &= r->colour[there] == wanted;
    }
  }
  return fine;
}

static void add_smaller(hk_regions *r, hk_enclosed *into) {
  double area[3] = {0};
  for (size_t k = 0; k < r->seen_count; k++) area[r->colour[r->seen[k]]] += r->area[r->seen[k]];
  uint8_t inside = area[1] < area[2] ? 1 : 2;
  for (size_t k = 0; k < r->seen_count; k++)
    for (uint32_t i = r->head[r->seen[k]]; r->colour[r->seen[k]] == inside && i != NONE; i = r->next[i])
      r->vertex[r->vertices++] = i;
  into->count = r->vertices - into->first;
}

/* For n more vertices. */
static bool make_room(hk_regions *r, const hk_host *host, size_t n) {
  if (r->vertices + n <= r->vertex_room) return true;
  size_t room = 2 * (r->vertices + n);
  uint32_t *more = host->allocate(host, room * sizeof *more);
  if (!more) return false;
  if (r->vertices) memcpy(more, r->vertex, r->vertices * sizeof *more);
  host->release(host, r->vertex);
  r->vertex = more;
  r->vertex_room = room;
  return true;
}

static hk_status fill_side(hk_regions *r, const hk_host *host, const hk_surface_mesh *m, const hk_contours *all,
                           const hk_contour *c, uint32_t side, size_t n, hk_enclosed *into) {
  uint32_t begin = NONE;
  *into = (hk_enclosed){.first = r->vertices};
  for (size_t k = c->first; k < c->first + c->count && begin == NONE; k++)
    if (on_curve(c, &all->point[k], side)) begin = m->edge[all->point[k].edge][0];
  into->known = true;
  if (begin == NONE) return HK_OK; /* within one triangle */
  if (!make_room(r, host, n)) return host->fail(host, HK_NO_MEMORY, "no memory for what intersection paths enclose");
  mark_odd(r, all, c, side);
  into->known = colour_from(r, m, begin);
  if (into->known) add_smaller(r, into);
  for (size_t k = 0; k < r->seen_count; k++) r->colour[r->seen[k]] = 0;
  return HK_OK;
}

/* ---- */

/* The next `count` items of the block, at a multiple of 64 bytes; `at` begins at 0. */
static void *carve(const hk_regions *r, size_t *at, size_t count, size_t size) {
  size_t begin = *at;
  *at += (count * size + 63) / 64 * 64;
  return r->memory ? (char *)r->memory + begin : NULL;
}

/* Without a block, only its size is found. */
static size_t lay_out(hk_regions *r, const hk_surface_mesh *m, const hk_contours *c, size_t n) {
  size_t at = 0, most = c->points + c->beyonds;
  r->area = carve(r, &at, n, sizeof *r->area);
  r->root = carve(r, &at, n, sizeof *r->root);
  r->next = carve(r, &at, n, sizeof *r->next);
  r->head = carve(r, &at, n, sizeof *r->head);
  r->seen = carve(r, &at, n, sizeof *r->seen);
  r->start = carve(r, &at, n + 2, sizeof *r->start);
  r->edge = carve(r, &at, most, sizeof *r->edge);
  r->incident = carve(r, &at, 2 * most, sizeof *r->incident);
  r->place = carve(r, &at, m->edges, sizeof *r->place);
  r->enclosed = carve(r, &at, c->count, sizeof *r->enclosed);
  r->colour = carve(r, &at, n, 1);
  r->odd = carve(r, &at, most, 1);
  return at;
}

static hk_status reserve(hk_regions *r, const hk_host *host, const hk_surface_mesh *m, const hk_contours *c, size_t n) {
  void *memory = r->memory;
  r->memory = NULL;
  size_t bytes = lay_out(r, m, c, n);
  r->memory = memory;
  hk_status status = hk_reserve(host, &r->memory, &r->memory_room, bytes, 1);
  if (status == HK_OK) lay_out(r, m, c, n);
  return status;
}

hk_status hk_regions_fill(hk_regions *r, const hk_host *host, const hk_surface_mesh *m, const hk_contours *all,
                          size_t n, const double *x) {
  r->vertices = 0;
  hk_status status = reserve(r, host, m, all, n);
  if (status != HK_OK) return status;
  list_crossed(r, m, all);
  find_groups(r, m, n, x);
  list_incident(r, m, n);
  for (size_t k = 0; k < all->count && status == HK_OK; k++)
    for (uint32_t side = 0; side < 2 && status == HK_OK; side++) {
      const hk_contour *c = &all->contour[k];
      r->enclosed[k][side] = (hk_enclosed){.first = r->vertices};
      if (c->cuts[side] || (c->kind == HK_CONTOUR_CLOSED && !(c->twisted && side == 1)))
        status = fill_side(r, host, m, all, c, side, n, &r->enclosed[k][side]);
    }
  return status;
}

void hk_regions_free(hk_regions *r, const hk_host *host) {
  host->release(host, r->memory);
  host->release(host, r->vertex);
  *r = (hk_regions){.vertices = 0};
}
