/* See factor_loops.h. The loops are compiled for b = 1 and 3, for one lane and four, and these for every width of
 * vectors; all do the same operations on a number in the same order. */
#include "plugins/common/elimination/factor.h"
#include "plugins/common/linear/block_vector.h"

typedef long long lane_mask __attribute__((vector_size(32)));

#define NAME(x) x##_one
#define NUMBER double
#define LANES 1
#define MASK int
#define ALL_FINE 1
#define IS_FINE(fine) ((fine) != 0)
#include "plugins/common/elimination/factor_loops.h"
#undef NAME
#undef NUMBER
#undef LANES
#undef MASK
#undef ALL_FINE
#undef IS_FINE

#define NAME(x) x##_four
#define NUMBER vector
#define LANES 4
#define MASK lane_mask
#define ALL_FINE ((lane_mask){-1, -1, -1, -1})
#define IS_FINE(fine) (((fine)[0] & (fine)[1] & (fine)[2] & (fine)[3]) != 0)
#include "plugins/common/elimination/factor_loops.h"

HK_VERSIONS(static bool, factorize_fours, (const hk_bundle *s, size_t b, const double *value),
            return b == 1 ? factorize_four(s, 1, value) : factorize_four(s, 3, value))

static bool factorize_single(const hk_bundle *s, size_t b, const double *value) {
  return b == 1 ? factorize_one(s, 1, value) : factorize_one(s, 3, value);
}

bool hk_bundle_factorize(const hk_bundle *s, int lanes, size_t b, const double *value) {
  if (s->lanes == 1) return factorize_single(s, b, value);
  return HK_WIDEST(lanes, factorize_fours)(s, b, value);
}

HK_VERSIONS(static bool, solve_fours, (const hk_bundle *s, size_t b, const double *rhs, double *x),
            return b == 1 ? solve_four(s, 1, rhs, x) : solve_four(s, 3, rhs, x))

static bool solve_single(const hk_bundle *s, size_t b, const double *rhs, double *x) {
  return b == 1 ? solve_one(s, 1, rhs, x) : solve_one(s, 3, rhs, x);
}

bool hk_bundle_solve(const hk_bundle *s, int lanes, size_t b, const double *rhs, double *x) {
  if (s->lanes == 1) return solve_single(s, b, rhs, x);
  return HK_WIDEST(lanes, solve_fours)(s, b, rhs, x);
}

/* Reciprocals after a pivot that is not positive mean nothing, so the first one is looked for. That of an infinite
 * pivot is 0. */
size_t hk_bundle_fault(const hk_bundle *s, size_t b, bool *finite) {
  *finite = true;
  for (size_t j = 0; j < s->elimination->n; j++)
    for (size_t c = 0; c < b; c++)
      for (size_t l = 0; l < s->lanes; l++) {
        double r = s->value[(b * b * s->elimination->start[j] + c * b + c) * s->lanes + l];
        if (r > 0 && r < INFINITY) continue;
        *finite = r < 0 || r > 0;
        return b * s->row[j * s->lanes + l] + c;
      }
  return 0;
}
