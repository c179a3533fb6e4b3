/* Pairs of a liquid by particles whose blocks implicit methods are given (core/plugin/facets/implicit.h): each pair
 * names four, in the order (i, i), (i, j), (j, i), (j, j), with i < j. Named are all that can come within the kernel
 * before the rows of neighbours are found again. */
#ifndef HK_SPH_PAIRS_H
#define HK_SPH_PAIRS_H

#include "plugins/common/sph/sph_particles.h"

/* Whether a force acts between the two, of which both count. */
typedef bool (*hk_sph_acts)(const void *self, size_t i, size_t j);

typedef struct hk_sph_pairs {
  uint32_t (*pair)[2];
  size_t count, room;
  uint64_t number;  /* of the rows that they are from; 0: none */
  hk_status failed; /* of the last naming */
} hk_sph_pairs;

void hk_sph_pairs_name(hk_sph_pairs *, hk_sph *, const hk_view *view, hk_sph_acts, const void *self, hk_pattern *into);
/* In `update`: volumes of new walls, and whether the rows at x_to (n x 3, m) are others than those of the number. */
hk_status hk_sph_pairs_update(hk_sph *, uint64_t number, const hk_view *from, const double *x_to,
                              bool *pattern_changed);

/* Adds B, 3 x 3, to the pair's diagonal blocks and takes it from the others, from slot on. */
void hk_sph_pair_add(double *blocks, const size_t slot[4], const double B[9]);

/* The Hessian of a function of the distance, f'' n n^T + f'/r (1 - n n^T), n = d/r; r = 0: f'' of all directions. */
static inline void hk_sph_pair_hessian(double along, double across, const double d[3], double r2, double H[9]) {
  double inverse = r2 > 0 ? 1 / r2 : 0;
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++) H[3 * a + b] = across * (a == b) + (along - across) * d[a] * d[b] * inverse;
}

#endif
