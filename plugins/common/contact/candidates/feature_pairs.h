/* Pairs of features from pairs of items, and edges that pass through triangles. */
#ifndef HK_FEATURE_PAIRS_H
#define HK_FEATURE_PAIRS_H

#include "plugins/common/contact/candidates/broad_phase.h"

/* The pairs of a move into `pairs`, whose records are hk_feature_pair. As hk_broad_phase_run. */
hk_status hk_feature_pairs_find(hk_broad_phase *, const hk_host *, const hk_surface_move *, hk_gather *pairs);

/* Which features are a pair, after that: those that no axis of a few keeps apart by more than offset and reach: the
 * axes of coordinates, the line between their middles, and the normal of the triangle, or of the two edges. v: the
 * particles, as in hk_feature_pair. */
bool hk_point_is_near(const hk_broad_phase *, const uint32_t v[4], double offset);
bool hk_edges_are_near(const hk_broad_phase *, const uint32_t v[4], double offset);

/* Whether both are of one rigid body, which does not meet itself, or of two that are joined. */
bool hk_items_left_out(const hk_surface_lists *, const hk_surface_item *, const hk_surface_item *);

/* Whether one is of a rigid body that holds a particle of the other one. */
bool hk_features_left_out(const hk_surface_lists *, const uint32_t *a, int of_a, const uint32_t *b, int of_b);

/* A loop over pairs of items that adds the pairs of their features to rows of a gather. */
typedef struct hk_pair_output {
  const hk_broad_phase *search;
  hk_gather *into; /* of hk_feature_pair */
  bool gaps;       /* they are computed, and only pairs kept that may come within reach by them */
  size_t chunk;
} hk_pair_output;

/* The pairs of an item of which one can move with another one, or with itself. */
void hk_items_compare(const hk_pair_output *, uint32_t place, uint32_t other);

/* The edges and triangles that have a point in common at x (n x 3) and share no particle, into `crossings`, whose
 * records are uint32_t[2], rising. As hk_broad_phase_run. */
hk_status hk_crossings_find(hk_broad_phase *, const hk_host *, const double *x, hk_gather *crossings);

#endif
