/* A tree of boxes (bounding volume hierarchy): which of many boxes overlap one, or each other, and which item is
 * nearest to a point. Every inner node's box holds those of its two children. The tree is built by splitting the items
 * at the median of their centres along the longest side; when boxes move, `refit` computes the nodes' boxes anew from
 * the leaves up, at a tenth of that cost, and searches stay right whatever the motion, but become slower as boxes
 * spread: hk_bvh_cost tells. The tree, and the order in which items are visited, depend on the boxes alone. */
#ifndef HK_BVH_H
#define HK_BVH_H

#include "core/plugin.h"

enum { HK_BVH_LEAF = 4 /* items at most in a leaf */, HK_BVH_DEPTH = 64 };

typedef struct hk_box {
  double low[3], high[3]; /* m */
} hk_box;

typedef struct hk_bvh_node {
  hk_box box;
  uint32_t first; /* leaf: of `order`; inner node: its children are `first` and first + 1, both behind it */
  uint32_t count; /* items of a leaf; 0: inner node */
} hk_bvh_node;

typedef struct hk_bvh {
  size_t items, nodes, room; /* room: items that fit the memory */
  hk_bvh_node *node;         /* node[0] is the root; none without items */
  uint32_t *order;           /* items, leaf by leaf */
  double built_cost;         /* hk_bvh_cost after the last build */
} hk_bvh;

/* Builds the tree; memory is allocated when there are more items than ever before. HK_NO_MEMORY: the tree is empty. */
hk_status hk_bvh_build(hk_bvh *, const hk_host *, const hk_box *box, size_t items);
void hk_bvh_refit(hk_bvh *, const hk_box *box);
void hk_bvh_free(hk_bvh *, const hk_host *);
/* The nodes' surfaces together, over that of the root: proportional to the nodes that a search visits. */
double hk_bvh_cost(const hk_bvh *);

static inline bool hk_box_overlap(const hk_box *a, const hk_box *b) {
  bool apart = false;
  for (int c = 0; c < 3; c++) apart |= a->low[c] > b->high[c] || b->low[c] > a->high[c];
  return !apart;
}

/* Calls visit(context, item) for the items whose box overlaps `with`. */
void hk_bvh_overlaps(const hk_bvh *, const hk_box *box, const hk_box *with, void (*visit)(void *, uint32_t),
                     void *context);
/* Calls visit(context, i, j), i < j, for all pairs of items whose boxes overlap. */
void hk_bvh_pairs(const hk_bvh *, const hk_box *box, void (*visit)(void *, uint32_t, uint32_t), void *context);
/* The item nearest to p; distance2(context, item) gives the square of its distance, and may keep what it finds when
 * that is below `best2` (m^2; INFINITY: any). Returns the least square. */
double hk_bvh_nearest(const hk_bvh *, const double p[3], double best2,
                      double (*distance2)(void *, uint32_t, double best2), void *context);

/* ---- "bvh/1": trees that plugins of a run share; the service owns them, to the end of the run ---- */

#define HK_BVH_INTERFACE "bvh/1"

typedef struct hk_bvh_service {
  void *self;
  /* Called in `create` or `topology`. *tree is NULL, for a new one, or one to be built anew. HK_NO_MEMORY. */
  hk_status (*build)(void *self, const hk_box *box, size_t items, hk_bvh **tree);
  /* The boxes have moved: fits the tree, or builds it anew where its cost has grown by half. */
  hk_status (*move)(void *self, const hk_box *box, hk_bvh *tree);
} hk_bvh_service;

#endif
