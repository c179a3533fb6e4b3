/* Eight targets at a time, for x86-64 with AVX-512. */
#include "plugins/common/gravity/gravity_path.h"

#if defined(__x86_64__)
#include <immintrin.h>

#define TARGET __attribute__((target("avx512f")))
#define INLINE static inline __attribute__((always_inline, target("avx512f")))
#define LANES 8
#define SPREAD(a) ((vector)_mm512_set1_pd(a))
#define FMA(a, b, c) ((vector)_mm512_fmadd_pd((__m512d)(a), (__m512d)(b), (__m512d)(c)))

typedef double vector __attribute__((vector_size(64), aligned(8), may_alias));
typedef int64_t mask __attribute__((vector_size(64), aligned(8), may_alias));

/* The estimate has 14 bits, so |e| <= 1.3e-4, and the first term left out, 35/128 e^4, is 7e-17. */
INLINE vector root(vector s2) {
  vector y = (vector)_mm512_rsqrt14_pd((__m512d)s2);
  vector e = FMA(-(s2 * y), y, SPREAD(1));
  return FMA(y * e, FMA(e, FMA(e, SPREAD(0.3125), SPREAD(0.375)), SPREAD(0.5)), y);
}

#include "plugins/common/gravity/gravity_loops.h"

static const hk_gravity_path path = PATH("AVX-512");

const hk_gravity_path *hk_gravity_wide8(void) { return __builtin_cpu_supports("avx512f") ? &path : NULL; }

#else

const hk_gravity_path *hk_gravity_wide8(void) { return NULL; }

#endif
