/* Which items of surfaces (surface_items.h) come near each other in a straight move: a tree of the boxes that they
 * sweep, and for what it finds, axes that keep two items apart (surface_gap.h). Items of which no particle can move
 * stand last, so that pairs of two of them are never looked at.
 *
 * What is near is decided by positions and pins alone; the tree and when it was built leave no trace. */
#ifndef HK_SURFACE_SEARCH_H
#define HK_SURFACE_SEARCH_H

#include "plugins/common/space/gather.h"
#include "plugins/common/surfaces/surface_gap.h"
#include "plugins/common/surfaces/surface_items.h"
#include "plugins/common/surfaces/surface_lists.h"

typedef struct hk_surface_move {
  const double *x_from, *x_to; /* n x 3, m */
  double reach;                /* m */
  bool bare;                   /* without the radii of surfaces */
} hk_surface_move;

/* What a search reads of an item most often. */
typedef struct hk_surface_place {
  uint32_t vertex[4];
  double radius; /* m */
} hk_surface_place;

typedef struct hk_surface_search {
  const hk_surface_lists *lists;
  const hk_model *model;
  hk_surface_items items;
  uint32_t *order;         /* items: those that can move first, both parts rising; a place is an index of it */
  hk_surface_place *place; /* as `order` */
  uint32_t *place_of;      /* items: the place of each */
  size_t moving;
  bool *held; /* n: which particles cannot move, for `order` */
  bool ordered;
  uint64_t number, tree_number; /* of the order; of that which the tree was built for */
  hk_swept_point *swept;        /* n: of the last move */
  hk_surface_move move;
  double slack;   /* m: far above what rounds where positions are compared, 2^-46 of the extent of the move */
  double *extent; /* by chunks of the particles, m; NAN: one is not finite */
  hk_box *box;    /* by places, m, from the origin of the search */
  hk_bvh tree;
  hk_gather near; /* row k: the places that place k may meet, above k, rising; records are uint32_t */
} hk_surface_search;

/* Lists and model have to stay where they are until hk_surface_search_free. HK_NO_MEMORY. */
hk_status hk_surface_search_open(hk_surface_search *, const hk_host *, const hk_surface_lists *, const hk_model *);
void hk_surface_search_free(hk_surface_search *, const hk_host *);
/* Finds the rows for a move. HK_NO_MEMORY; HK_NOT_FINITE, without a message: a position is not. */
hk_status hk_surface_search_run(hk_surface_search *, const hk_host *, const hk_surface_move *);
/* The first part of that: the places of items, and the swept positions of all points. Boxes are the caller's. */
hk_status hk_surface_search_sweep(hk_surface_search *, const hk_host *, const hk_surface_move *);
/* The box that an item sweeps, with its radius. */
void hk_surface_search_box(hk_surface_search *, uint32_t place);
/* Whether the same particles as in the last search can move. */
bool hk_surface_search_pins_kept(const hk_surface_search *);

/* An item that others are compared with, and what tests against many of them share. */
typedef struct hk_surface_seeker {
  uint32_t place;
  const uint32_t *vertex;
  double distance; /* m, without the radius of the other */
  hk_swept_set set;
  double normal[3], normal2;
  hk_two_range along; /* the normal */
} hk_surface_seeker;

hk_surface_seeker hk_surface_seek(const hk_surface_search *, uint32_t place);
/* Whether an axis keeps the item at another place apart from it. */
bool hk_surface_seeker_misses(const hk_surface_search *, const hk_surface_seeker *, uint32_t other);

enum { HK_SEARCH_LEAVES = 32 /* of the tree, that a thread takes at a time */ };

/* The number of leaves, and the places of a leaf, up to four; their number. For loops over the rows in which neighbours
 * in space follow each other. */
size_t hk_surface_search_leaves(const hk_surface_search *);
size_t hk_surface_search_leaf(const hk_surface_search *, size_t leaf, const uint32_t **place);

/* ---- features: one to three particles ---- */

/* m: nearer than this two features are a pair. */
static inline double hk_surface_distance(const hk_surface_search *s, double offset) {
  return (s->move.bare ? 0 : offset + s->move.reach) + s->slack;
}

#endif
