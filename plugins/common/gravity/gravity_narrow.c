/* Two targets at a time, with the vectors that every x86-64 and arm64 has, roots and divisions; and the choice of the
 * widest path. */
#include "plugins/common/gravity/gravity_path.h"

#include <math.h>

#define TARGET
#define INLINE static inline __attribute__((always_inline))
#define LANES 2
#define SPREAD(a) ((vector){a, a})
#define FMA(a, b, c) ((a) * (b) + (c))

typedef double vector __attribute__((vector_size(16), aligned(8), may_alias));
typedef int64_t mask __attribute__((vector_size(16), aligned(8), may_alias));

INLINE vector root(vector s2) { return 1 / (vector){sqrt(s2[0]), sqrt(s2[1])}; }

#include "plugins/common/gravity/gravity_loops.h"

const hk_gravity_path hk_gravity_narrow = PATH("vectors of two");

const hk_gravity_path *hk_gravity_best(void) {
  const hk_gravity_path *eight = hk_gravity_wide8(), *four = hk_gravity_wide4();
  return eight ? eight : four ? four : &hk_gravity_narrow;
}
