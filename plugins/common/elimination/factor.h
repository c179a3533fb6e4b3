/* Numeric factorization A = L D L^T of one component, or of four with the same graph at once, and its solution. */
#ifndef HK_FACTOR_H
#define HK_FACTOR_H

#include "plugins/common/elimination/elimination.h"

enum { HK_LANES = 4 };

/* One component in 1 lane, or up to HK_LANES in HK_LANES lanes: where there are fewer, the last one fills the rest. */
typedef struct hk_bundle {
  const hk_elimination *elimination;
  size_t lanes;
  uint32_t *row;    /* n x lanes: rows of A in the order of elimination */
  uint32_t *origin; /* blocks x lanes: blocks of A; UINT32_MAX: fill */
  double *value;    /* blocks x b x b x lanes: L, and the reciprocals of D */
  double *solution; /* n x b x lanes */
} hk_bundle;

/* False: A is not positive definite or not finite; hk_bundle_fault says where. b is 1 or 3; lanes:
 * hk_host.lanes. */
bool hk_bundle_factorize(const hk_bundle *, int lanes, size_t b, const double *value);
/* The row of A, in numbers, at which that was seen. */
size_t hk_bundle_fault(const hk_bundle *, size_t b, bool *finite);
/* Solves A x = rhs for the bundle's rows. False: x is not finite. */
bool hk_bundle_solve(const hk_bundle *, int lanes, size_t b, const double *rhs, double *x);

#endif
