/* Which items of surfaces (surface_lists.h) are near each other: the boxes that they sweep in a straight move, and a
 * tree of these boxes. Items of which no particle can move stand last, so that pairs of two of them are never looked
 * at.
 *
 * Rows of candidates are functions of the positions and of what can move alone: the tree and when it was built leave no
 * trace in them. */
#ifndef HK_SURFACE_SEARCH_H
#define HK_SURFACE_SEARCH_H

#include "plugins/common/space/bvh.h"
#include "plugins/common/space/gather.h"
#include "plugins/common/surfaces/surface_lists.h"

typedef struct hk_surface_search {
  const hk_surface_lists *lists;
  const hk_model *model;
  hk_box *swept;   /* n: the boxes of the particles' moves */
  hk_box *box;     /* items, as in `order` */
  uint32_t *order; /* items: those that can move first, both parts rising */
  size_t moving;
  bool *held; /* n: which particles cannot move, for `order` */
  bool ordered;
  bool *lost; /* by chunks of the particles: one is not finite */
  hk_bvh tree;
  hk_gather rows;
} hk_surface_search;

typedef struct hk_item_pair {
  uint32_t a, b; /* items of the lists; a can move */
} hk_item_pair;

typedef struct hk_surface_move {
  const double *x_from, *x_to; /* n x 3, m */
  double reach;                /* m */
  bool bare;                   /* boxes of the positions alone, without the radii of surfaces */
} hk_surface_move;

/* Lists and model have to stay where they are until hk_surface_search_free. HK_NO_MEMORY. */
hk_status hk_surface_search_open(hk_surface_search *, const hk_host *, const hk_surface_lists *, const hk_model *);
void hk_surface_search_free(hk_surface_search *, const hk_host *);
/* The pairs of items whose boxes of a move are within its reach, in `rows`: by their places in `order`, rising. With
 * them `swept` and `box` are those of the move. HK_NO_MEMORY; HK_NOT_FINITE, without a message: a position is not. */
hk_status hk_surface_search_rows(hk_surface_search *, const hk_host *, const hk_surface_move *);

/* Whether the same particles as in the last search can move. */
bool hk_surface_search_pins_kept(const hk_surface_search *);

static inline bool hk_boxes_near(const hk_box *a, const hk_box *b, double reach) {
  bool apart = false;
  for (int c = 0; c < 3; c++) apart |= a->low[c] - reach > b->high[c] || b->low[c] > a->high[c] + reach;
  return !apart;
}

/* The box of two boxes. */
static inline hk_box hk_box_around(const hk_box *a, const hk_box *b) {
  hk_box box;
  for (int c = 0; c < 3; c++) {
    box.low[c] = a->low[c] < b->low[c] ? a->low[c] : b->low[c];
    box.high[c] = a->high[c] > b->high[c] ? a->high[c] : b->high[c];
  }
  return box;
}

#endif
