/* Pairs of features from pairs of items, and edges that pass through triangles. */
#ifndef HK_SURFACE_PAIRS_H
#define HK_SURFACE_PAIRS_H

#include "plugins/common/surfaces/surface_search.h"

/* The pairs of a move into `pairs`, whose records are hk_surface_pair. As hk_surface_search_run. */
hk_status hk_surface_pairs_find(hk_surface_search *, const hk_host *, const hk_surface_move *, hk_gather *pairs);

/* Which features are a pair, after that: those that no axis of a few keeps apart by more than offset and reach: the
 * axes of coordinates, the line between their middles, and the normal of the triangle, or of the two edges. v: the
 * particles, as in hk_surface_pair. */
bool hk_surface_point_near(const hk_surface_search *, const uint32_t v[4], double offset);
bool hk_surface_edges_near(const hk_surface_search *, const uint32_t v[4], double offset);

/* A loop over pairs of items that adds the pairs of their features to rows of a gather. */
typedef struct hk_surface_output {
  const hk_surface_search *search;
  hk_gather *into; /* of hk_surface_pair, or, with `gaps`, of hk_near_pair */
  bool gaps;
  size_t chunk;
} hk_surface_output;

/* The pairs of an item of which one can move with another one, or with itself. */
void hk_surface_try_items(const hk_surface_output *, uint32_t place, uint32_t other);

/* The edges and triangles that have a point in common at x (n x 3) and share no particle, into `crossings`, whose
 * records are uint32_t[2], rising. As hk_surface_search_run. */
hk_status hk_surface_crossings_find(hk_surface_search *, const hk_host *, const double *x, hk_gather *crossings);

#endif
