/* Forces on each particle alone that are a number times a vector: F_i += s_i u_i, s_i = each + times by_i. */
#ifndef HK_SCALED_SUMS_H
#define HK_SCALED_SUMS_H

#include "plugins/common/parts/particle_sums.h"

typedef struct hk_scaled {
  double each, times;
  const double *by; /* n: masses, say, or radii */
  const double *u;  /* n x 3; NULL: `common` for all */
  double common[3];
} hk_scaled;

/* An hk_range_body without its first argument. Returns the sum of s_i u_i.u_i, W where u is the velocity, and 0 where
 * it is common; the same bits for any width of vectors. */
double hk_scaled_sums_add(const hk_scaled *, const hk_view *view, size_t begin, size_t end, double *F);

#endif
