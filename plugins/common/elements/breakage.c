/* See breakage.h. What is gone is sorted once for each list, and looked up by its particles. */
#include "plugins/common/elements/breakage.h"

#include <stdlib.h>
#include <string.h>

enum { SIDES = 3 };

typedef struct corners {
  uint32_t of[3]; /* rising; of an edge the last is UINT32_MAX */
} corners;

typedef struct lists {
  corners *edge, *triangle; /* sorted, those that are gone */
  corners *border, *held;   /* sorted, sides of triangles that are gone, and of those that stay */
  size_t edges, triangles, borders, holds;
} lists;

hk_status hk_breakage_enter(const hk_host *host, const hk_breakable *breakable) {
  const hk_breakage *breakage = host->query(host, HK_BREAKAGE_INTERFACE);
  return breakage ? breakage->enter(breakage->self, breakable) : HK_FAILED;
}

static bool is_gone(const hk_lost_elements *l, size_t k) { return l->gone[k * l->stride] > 0; }

static hk_lost_elements of_member(const hk_breakage *s, size_t k) {
  hk_lost_elements lost = {.stride = 1};
  s->member[k].lost(s->member[k].self, &lost);
  return lost;
}

size_t hk_breakage_count(const hk_breakage *s) {
  size_t count = 0;
  for (size_t k = 0; k < s->count; k++) {
    const hk_lost_elements lost = of_member(s, k);
    for (size_t e = 0; e < lost.node.count; e++) count += is_gone(&lost, e);
  }
  return count;
}

/* ---- sorted lists ---- */

static corners pair_of(uint32_t a, uint32_t b) { return (corners){{a < b ? a : b, a < b ? b : a, UINT32_MAX}}; }

static corners triple_of(const uint32_t *t) {
  uint32_t low = t[0] < t[1] ? t[0] : t[1], high = t[0] < t[1] ? t[1] : t[0], c = t[2];
  return (corners){{c < low ? c : low, c < low ? low : c < high ? c : high, c < high ? high : c}};
}

static int compare(const void *a, const void *b) {
  const corners *p = a, *q = b;
  for (int c = 0; c < 3; c++)
    if (p->of[c] != q->of[c]) return p->of[c] < q->of[c] ? -1 : 1;
  return 0;
}

static bool has(const corners *list, size_t count, corners key) {
  return count > 0 && bsearch(&key, list, count, sizeof key, compare);
}

static void sort(corners *list, size_t count) {
  if (count > 0) qsort(list, count, sizeof *list, compare);
}

static size_t put_sides(corners *list, size_t count, const uint32_t *t) {
  for (int c = 0; c < SIDES; c++) list[count++] = pair_of(t[c], t[(c + 1) % SIDES]);
  return count;
}

/* Enters the elements of one plugin; edges first, as a triangle does not stay without one of its sides. */
static void enter_edges(lists *l, const hk_lost_elements *lost) {
  for (size_t e = 0; e < lost->node.count && lost->node.arity == 2; e++)
    if (is_gone(lost, e)) l->edge[l->edges++] = pair_of(hk_tuple(&lost->node, e)[0], hk_tuple(&lost->node, e)[1]);
}

static bool lacks_side(const lists *l, const uint32_t *t) {
  bool lacks = false;
  for (int c = 0; c < SIDES && !lacks; c++) lacks = has(l->edge, l->edges, pair_of(t[c], t[(c + 1) % SIDES]));
  return lacks;
}

static void enter_triangles(lists *l, const hk_lost_elements *lost) {
  for (size_t e = 0; e < lost->node.count && lost->node.arity == 3; e++) {
    const uint32_t *t = hk_tuple(&lost->node, e);
    const bool gone = is_gone(lost, e);
    if (gone) l->triangle[l->triangles++] = triple_of(t);
    if (gone) l->borders = put_sides(l->border, l->borders, t);
    if (!gone && !lacks_side(l, t)) l->holds = put_sides(l->held, l->holds, t);
  }
}

static bool allocate(lists *l, const hk_host *host, size_t most) {
  l->edge = host->allocate(host, (most + 1) * sizeof *l->edge);
  l->triangle = host->allocate(host, (most + 1) * sizeof *l->triangle);
  l->border = host->allocate(host, (SIDES * most + 1) * sizeof *l->border);
  l->held = host->allocate(host, (SIDES * most + 1) * sizeof *l->held);
  return l->edge && l->triangle && l->border && l->held;
}

static void release(lists *l, const hk_host *host) {
  host->release(host, l->edge);
  host->release(host, l->triangle);
  host->release(host, l->border);
  host->release(host, l->held);
}

static void fill(lists *l, const hk_breakage *s) {
  for (size_t k = 0; k < s->count; k++) {
    const hk_lost_elements lost = of_member(s, k);
    enter_edges(l, &lost);
  }
  sort(l->edge, l->edges);
  for (size_t k = 0; k < s->count; k++) {
    const hk_lost_elements lost = of_member(s, k);
    enter_triangles(l, &lost);
  }
  sort(l->triangle, l->triangles);
  sort(l->border, l->borders);
  sort(l->held, l->holds);
}

static bool edge_goes(const lists *l, const uint32_t *end) {
  const corners pair = pair_of(end[0], end[1]);
  return has(l->edge, l->edges, pair) || (has(l->border, l->borders, pair) && !has(l->held, l->holds, pair));
}

static bool triangle_goes(const lists *l, const uint32_t *t) {
  return has(l->triangle, l->triangles, triple_of(t)) || lacks_side(l, t);
}

hk_status hk_breakage_mark(const hk_breakage *s, const hk_host *host, const hk_tuples *node, bool *gone) {
  size_t most = 0;
  lists l = {0};
  for (size_t k = 0; k < s->count; k++) most += of_member(s, k).node.count;
  bool room = allocate(&l, host, most);
  if (room) fill(&l, s);
  for (size_t e = 0; e < node->count && room; e++)
    gone[e] = node->arity == 2   ? edge_goes(&l, hk_tuple(node, e))
              : node->arity == 3 ? triangle_goes(&l, hk_tuple(node, e))
                                 : false;
  release(&l, host);
  return room ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for %zu elements that may be gone", most);
}
