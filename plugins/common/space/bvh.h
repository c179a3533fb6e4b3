/* A tree of boxes (bounding volume hierarchy): which of many boxes overlap one, and which item is nearest to a point.
 * Every node has four children, whose boxes stand side by side in it, so that one comparison of a vector looks at all.
 * The nodes of a level follow each other, and children are found by their number alone: the items are put in such an
 * order that each aligned block of 4, 16, 64, ... is what splitting at medians of the centres, along the longest side,
 * makes of them. When boxes move, `refit` computes the nodes' boxes anew, level by level and in parallel, at a tenth of
 * the cost of building; searches stay right whatever the motion, but become slower as boxes spread: hk_bvh_cost tells.
 *
 * Nodes keep their boxes in single precision about the centre of all, rounded outwards; answers are exact all the same,
 * as callers' boxes decide. */
#ifndef HK_BVH_H
#define HK_BVH_H

#include "core/plugin.h"

enum { HK_BVH_LEVELS = 17 /* of 4^17 items */, HK_BVH_STACK = 3 * HK_BVH_LEVELS + 1 };

typedef struct hk_box {
  double low[3], high[3]; /* m */
} hk_box;

/* Child s is node 4 j + s of the level below for node j of its level; of the lowest level 0, the item order[4 j + s].
 */
typedef struct hk_bvh_node {
  float low[3][4], high[3][4]; /* m, about the tree's centre, outside of the true ones; without a child inf, -inf */
} hk_bvh_node;

typedef struct hk_bvh {
  size_t items, nodes, room;       /* room: items that fit the memory */
  unsigned levels;                 /* 0: no items, else 2 or more */
  size_t level[HK_BVH_LEVELS + 1]; /* the first node of each level, and the end */
  double centre[3];                /* m */
  hk_bvh_node *node;
  uint32_t *order;        /* items */
  struct hk_bvh_key *key; /* items: scratch data of building */
  double built_cost;      /* hk_bvh_cost after the last build */
} hk_bvh;

/* Builds the tree; memory is allocated when there are more items than ever before. HK_NO_MEMORY: the tree is empty. Not
 * inside a parallel_for, which it uses, as `refit` does. */
hk_status hk_bvh_build(hk_bvh *, const hk_host *, const hk_box *box, size_t items);
void hk_bvh_refit(hk_bvh *, const hk_host *, const hk_box *box);
void hk_bvh_free(hk_bvh *, const hk_host *);
/* The nodes' surfaces together, over that of the root: proportional to the nodes that a search visits. */
double hk_bvh_cost(const hk_bvh *);

static inline bool hk_box_overlap(const hk_box *a, const hk_box *b) {
  bool apart = false;
  for (int c = 0; c < 3; c++) apart |= a->low[c] > b->high[c] || b->low[c] > a->high[c];
  return !apart;
}

/* ---- searches, which several threads may make at once ---- */

/* A box in the tree's precision, rounded outwards. */
typedef struct hk_bvh_query {
  float low[3], high[3];
} hk_bvh_query;

hk_bvh_query hk_bvh_ask(const hk_bvh *, const hk_box *);
/* Bit s: the box overlaps that of child s, or nearly so. */
static inline unsigned hk_bvh_hits(const hk_bvh_node *, const hk_bvh_query *);

/* A walk through the tree that finds what overlaps a box: items, by their places in `order`, or nodes of level 0. It
 * finds all of them, and perhaps some that are farther away by the rounding of single precision. */
typedef struct hk_bvh_walk {
  const hk_bvh *tree;
  hk_bvh_query with;
  unsigned last, top;           /* last: the level whose nodes are looked into last */
  uint32_t stack[HK_BVH_STACK]; /* nodes to visit */
  unsigned char level[HK_BVH_STACK];
} hk_bvh_walk;

enum { HK_BVH_MOST = 128 /* found at a time */ };

void hk_bvh_walk_begin(hk_bvh_walk *, const hk_bvh *, const hk_bvh_query *, bool items);
/* The next ones, in no order; their number, 0 when there are no more. */
size_t hk_bvh_walk_on(hk_bvh_walk *, uint32_t found[HK_BVH_MOST]);
/* Calls visit(context, item) for the items whose box overlaps `with`, and no others. */
void hk_bvh_overlaps(const hk_bvh *, const hk_box *box, const hk_box *with, void (*visit)(void *, uint32_t),
                     void *context);
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

typedef float hk_bvh_four __attribute__((vector_size(16), may_alias));
typedef int32_t hk_bvh_four_mask __attribute__((vector_size(16), may_alias));

static inline unsigned hk_bvh_hits(const hk_bvh_node *n, const hk_bvh_query *q) {
  const hk_bvh_four *low = (const hk_bvh_four *)n->low, *high = (const hk_bvh_four *)n->high;
  hk_bvh_four_mask apart = {0};
  for (int c = 0; c < 3; c++) {
    hk_bvh_four ql = {q->low[c], q->low[c], q->low[c], q->low[c]},
                qh = {q->high[c], q->high[c], q->high[c], q->high[c]};
    apart |= (low[c] > qh) | (ql > high[c]);
  }
#if defined(__SSE__)
  return ~(unsigned)__builtin_ia32_movmskps((hk_bvh_four)apart) & 15;
#else
  return (apart[0] ? 0 : 1) | (apart[1] ? 0 : 2) | (apart[2] ? 0 : 4) | (apart[3] ? 0 : 8);
#endif
}

#endif
