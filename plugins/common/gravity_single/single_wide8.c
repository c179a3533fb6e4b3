/* Eight targets at a time, for x86-64 with AVX2 and FMA. */
#include "plugins/common/gravity_single/single_path.h"

#if defined(__x86_64__)
#include <immintrin.h>

#define TARGET __attribute__((target("avx2,fma")))
#define INLINE static inline __attribute__((always_inline, target("avx2,fma")))
#define LANES 8
#define SPREAD(a) ((vector)_mm256_set1_ps(a))
#define FMA(a, b, c) ((vector)_mm256_fmadd_ps((__m256)(a), (__m256)(b), (__m256)(c)))
#define LESSER(a, b) ((vector)_mm256_min_ps((__m256)(a), (__m256)(b)))

typedef float vector __attribute__((vector_size(32), aligned(4), may_alias));

/* With the estimate y of 1/s and e = 1 - s^2 y^2, 1/s^3 = y^3 (1 + 3/2 e + 15/8 e^2 + ...): its 1.5 2^-12 make |e| <=
 * 7.4e-4, and the first term left out, 35/16 e^3, 9e-10. */
INLINE vector over_cube(vector m, vector s2) {
  vector y = (vector)_mm256_rsqrt_ps((__m256)s2), y2 = y * y;
  vector e = FMA(-s2, y2, SPREAD(1));
  return (m * y) * y2 * FMA(e, FMA(e, SPREAD(1.875f), SPREAD(1.5f)), SPREAD(1));
}

#include "plugins/common/gravity_single/single_loops.h"

static const hk_single_path path = {"floats, AVX2", pull};

const hk_single_path *hk_single_wide8(void) {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? &path : NULL;
}

#else

const hk_single_path *hk_single_wide8(void) { return NULL; }

#endif
