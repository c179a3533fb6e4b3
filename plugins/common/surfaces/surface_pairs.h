/* Pairs of features from pairs of items, and edges that pass through triangles. */
#ifndef HK_SURFACE_PAIRS_H
#define HK_SURFACE_PAIRS_H

#include "plugins/common/surfaces/surface_search.h"

/* The pairs of a move into `pairs`, whose records are hk_surface_pair. As hk_surface_search_rows. */
hk_status hk_surface_pairs_find(hk_surface_search *, const hk_host *, const hk_surface_move *, hk_gather *pairs);

/* The edges and triangles that have a point in common at x (n x 3) and share no particle, into `crossings`, whose
 * records are uint32_t[2], rising. As hk_surface_search_rows. */
hk_status hk_surface_crossings_find(hk_surface_search *, const hk_host *, const double *x, hk_gather *crossings);

#endif
