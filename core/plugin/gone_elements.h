/* Which edges and triangles go where elements are gone (facets/internal.h), for the scene's surface and for plugins
 * with lists of their own:
 * - a triangle that is gone, or of which a side is;
 * - an edge that is gone, or that is a side of triangles that are gone and of none that stays.
 * First all lost elements are taken, then the lists are sorted, then the triangles that stay are held, then edges are
 * asked for. */
#ifndef HK_PLUGIN_GONE_ELEMENTS_H
#define HK_PLUGIN_GONE_ELEMENTS_H

#include "core/plugin/facets/internal.h"

#include <stdlib.h>

enum { HK_SIDES = 3 };

typedef struct hk_corners {
  uint32_t of[3]; /* rising; of an edge the last is UINT32_MAX */
} hk_corners;

/* Lists with room for what is taken: of `lost` elements, edge and triangle lost, border 3 lost; held: 3 of those held.
 */
typedef struct hk_gone_elements {
  hk_corners *edge, *triangle; /* that are gone */
  hk_corners *border, *held;   /* sides of triangles that are gone, and of those that stay */
  size_t edges, triangles, borders, holds;
} hk_gone_elements;

static inline bool hk_is_gone(const hk_lost_elements *l, size_t k) { return l->gone[k * l->stride] > 0; }

static inline hk_corners hk_corners_of_edge(uint32_t a, uint32_t b) {
  return (hk_corners){{a < b ? a : b, a < b ? b : a, UINT32_MAX}};
}

static inline hk_corners hk_corners_of_triangle(const uint32_t *t) {
  uint32_t low = t[0] < t[1] ? t[0] : t[1], high = t[0] < t[1] ? t[1] : t[0], c = t[2];
  return (hk_corners){{c < low ? c : low, c < low ? low : c < high ? c : high, c < high ? high : c}};
}

static inline int hk_corners_compare(const void *a, const void *b) {
  const hk_corners *p = (const hk_corners *)a, *q = (const hk_corners *)b;
  for (int c = 0; c < 3; c++)
    if (p->of[c] != q->of[c]) return p->of[c] < q->of[c] ? -1 : 1;
  return 0;
}

static inline void hk_corners_sort(hk_corners *list, size_t count) {
  if (count > 0) qsort(list, count, sizeof *list, hk_corners_compare);
}

static inline bool hk_corners_have(const hk_corners *list, size_t count, hk_corners key) {
  return count > 0 && bsearch(&key, list, count, sizeof key, hk_corners_compare);
}

static inline size_t hk_corners_put_sides(hk_corners *list, size_t count, const uint32_t *t) {
  for (int c = 0; c < HK_SIDES; c++) list[count++] = hk_corners_of_edge(t[c], t[(c + 1) % HK_SIDES]);
  return count;
}

static inline void hk_gone_take(hk_gone_elements *g, const hk_lost_elements *lost) {
  for (size_t e = 0; e < lost->node.count; e++) {
    const uint32_t *node = hk_tuple(&lost->node, e);
    if (!hk_is_gone(lost, e)) continue;
    if (lost->node.arity == 2) g->edge[g->edges++] = hk_corners_of_edge(node[0], node[1]);
    if (lost->node.arity != 3) continue;
    g->triangle[g->triangles++] = hk_corners_of_triangle(node);
    g->borders = hk_corners_put_sides(g->border, g->borders, node);
  }
}

static inline void hk_gone_sort(hk_gone_elements *g) {
  hk_corners_sort(g->edge, g->edges);
  hk_corners_sort(g->triangle, g->triangles);
  hk_corners_sort(g->border, g->borders);
}

static inline bool hk_gone_triangle(const hk_gone_elements *g, const uint32_t *t) {
  bool goes = hk_corners_have(g->triangle, g->triangles, hk_corners_of_triangle(t));
  for (int c = 0; c < HK_SIDES && !goes; c++)
    goes = hk_corners_have(g->edge, g->edges, hk_corners_of_edge(t[c], t[(c + 1) % HK_SIDES]));
  return goes;
}

/* Of a triangle that stays. After the last one `held` is to be sorted. */
static inline void hk_gone_hold(hk_gone_elements *g, const uint32_t *t) {
  g->holds = hk_corners_put_sides(g->held, g->holds, t);
}

static inline bool hk_gone_edge(const hk_gone_elements *g, const uint32_t *end) {
  const hk_corners pair = hk_corners_of_edge(end[0], end[1]);
  return hk_corners_have(g->edge, g->edges, pair) ||
         (hk_corners_have(g->border, g->borders, pair) && !hk_corners_have(g->held, g->holds, pair));
}

#endif
