/* Four targets at a time, with the vectors that every x86-64 and arm64 has, roots and divisions; and the choice of the
 * widest path. */
#include "plugins/common/gravity_single/single_path.h"

#include <math.h>
#include <stdint.h>

#define TARGET
#define INLINE static inline __attribute__((always_inline))
#define LANES 4
#define SPREAD(a) ((vector){a, a, a, a})
#define FMA(a, b, c) ((a) * (b) + (c))
#define LESSER(a, b) lesser(a, b)

typedef float vector __attribute__((vector_size(16), aligned(4), may_alias));
typedef int32_t mask __attribute__((vector_size(16), aligned(4), may_alias));

INLINE vector lesser(vector a, vector b) {
  mask less = (mask)(a < b);
  return (vector)((less & (mask)a) | (~less & (mask)b));
}

INLINE vector over_cube(vector m, vector s2) {
  vector w = 1 / (vector){sqrtf(s2[0]), sqrtf(s2[1]), sqrtf(s2[2]), sqrtf(s2[3])};
  return (m * w) * (w * w);
}

#include "plugins/common/gravity_single/single_loops.h"

const hk_single_path hk_single_narrow = {"floats, vectors of four", pull};

const hk_single_path *hk_single_best(void) {
  const hk_single_path *sixteen = hk_single_wide16(), *eight = hk_single_wide8();
  return sixteen ? sixteen : eight ? eight : &hk_single_narrow;
}
