/* The broad phase: the pairs of items of surfaces (surface_items.h) that come within reach in a straight move. A tree
 * of swept boxes finds overlaps, which separating axes then reduce (separating_axis.h). Items of which no particle can
 * move stand last, so that pairs of two of them are never compared.
 *
 * Invariant: the result depends on positions and pins alone, not on the tree or on when it was built. */
#ifndef HK_BROAD_PHASE_H
#define HK_BROAD_PHASE_H

#include "plugins/common/space/gather.h"
#include "plugins/common/contact/candidates/separating_axis.h"
#include "plugins/common/contact/surfaces/surface_items.h"
#include "plugins/common/contact/surfaces/surface_lists.h"

typedef struct hk_surface_move {
  const double *x_from, *x_to; /* n x 3, m */
  double reach;                /* m */
  bool bare;                   /* without the radii of surfaces */
} hk_surface_move;

/* The data of an item that a search reads most. */
typedef struct hk_item_place {
  uint32_t vertex[4];
  double radius; /* m */
} hk_item_place;

typedef struct hk_broad_phase {
  const hk_surface_lists *lists;
  const hk_model *model;
  hk_surface_items items;
  uint32_t *order;      /* items: those that can move first, both parts rising; a place is an index of it */
  hk_item_place *place; /* as `order` */
  uint32_t *place_of;   /* items: the place of each */
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
  hk_gather near; /* row k: the places above k within reach of place k, rising; records are uint32_t */
} hk_broad_phase;

/* Lists and model have to stay where they are until hk_broad_phase_free. HK_NO_MEMORY. */
hk_status hk_broad_phase_open(hk_broad_phase *, const hk_host *, const hk_surface_lists *, const hk_model *);
void hk_broad_phase_free(hk_broad_phase *, const hk_host *);
/* Finds the rows for a move. HK_NO_MEMORY; HK_NOT_FINITE, without a message: a position is not. */
hk_status hk_broad_phase_run(hk_broad_phase *, const hk_host *, const hk_surface_move *);
/* The first part of that: the places of items, and the swept positions of all points. Boxes are the caller's. */
hk_status hk_broad_phase_move(hk_broad_phase *, const hk_host *, const hk_surface_move *);
/* The box that an item sweeps, with its radius. */
void hk_broad_phase_box(hk_broad_phase *, uint32_t place);
/* Whether the same particles as in the last search can move. */
bool hk_broad_phase_pins_kept(const hk_broad_phase *);

/* An item that is compared with many others, and the parts of the tests that do not depend on these. */
typedef struct hk_item_query {
  uint32_t place;
  const uint32_t *vertex;
  double distance; /* m, without the radius of the other */
  hk_swept_set set;
  double normal[3], normal2;
  hk_two_range along; /* the normal */
} hk_item_query;

hk_item_query hk_item_query_of(const hk_broad_phase *, uint32_t place);
/* Whether an axis keeps the item at another place apart from it. */
bool hk_item_query_misses(const hk_broad_phase *, const hk_item_query *, uint32_t other);

enum { HK_BROAD_PHASE_LEAVES = 32 /* of the tree, that a thread takes at a time */ };

/* The number of leaves, and the places of a leaf, up to four; their number. For loops over the rows in which neighbours
 * in space follow each other. */
size_t hk_broad_phase_leaves(const hk_broad_phase *);
size_t hk_broad_phase_leaf(const hk_broad_phase *, size_t leaf, const uint32_t **place);

/* ---- features: one to three particles ---- */

/* m: nearer than this two features are a pair. */
static inline double hk_broad_phase_distance(const hk_broad_phase *s, double offset) {
  return (s->move.bare ? 0 : offset + s->move.reach) + s->slack;
}

#endif
