/* Items of surfaces, the units of the broad phase: two triangles that share an edge, or one, an edge of a strand, or a
 * isolated particle. Two triangles have nearly the box of one, so that half as many boxes meet a quarter as often.
 *
 * Every point and every edge is owned by one item, the first that has it, so that a pair of features is found once, at
 * the pair of its owners ("representative triangles", Curtis, Tamstorf and Manocha 2008). */
#ifndef HK_SURFACE_ITEMS_H
#define HK_SURFACE_ITEMS_H

#include "plugins/common/contact/surfaces/surfaces.h"

enum { HK_ITEM_EDGES = 5 };

/* Two triangles are those of the vertices 0 1 2 and 3 2 1. What there is less of is repeated: one triangle 0 1 2 2, an
 * edge 0 1 1 1, an isolated particle 0 0 0 0. */
typedef struct hk_surface_item {
  uint32_t vertex[4];
  uint32_t triangle[2];         /* of the mesh; UINT32_MAX: none */
  uint32_t edge[HK_ITEM_EDGES]; /* those of the mesh that it owns, at hk_item_ends; else UINT32_MAX */
  uint32_t points;              /* bit c: it owns vertex[c] */
} hk_surface_item;

static const unsigned char hk_item_ends[HK_ITEM_EDGES][2] = {{0, 1}, {1, 2}, {2, 0}, {2, 3}, {3, 1}};

static inline bool hk_item_is_isolated(const hk_surface_item *i) { return i->vertex[0] == i->vertex[1]; }

static inline bool hk_item_has_triangles(const hk_surface_item *i) { return i->triangle[0] != UINT32_MAX; }

typedef struct hk_surface_items {
  size_t count;
  hk_surface_item
      *item; /* in the order of their first triangles, then of the edges of strands, then isolated particles */
} hk_surface_items;

hk_status hk_surface_items_build(hk_surface_items *, const hk_host *, const hk_surface_mesh *,
                                 size_t n); /* HK_NO_MEMORY */
void hk_surface_items_free(hk_surface_items *, const hk_host *);

#endif
