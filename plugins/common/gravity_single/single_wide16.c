/* Sixteen targets at a time, for x86-64 with AVX-512. */
#include "plugins/common/gravity_single/single_path.h"

#if defined(__x86_64__)
#include <immintrin.h>

#define TARGET __attribute__((target("avx512f")))
#define INLINE static inline __attribute__((always_inline, target("avx512f")))
#define LANES 16
#define SPREAD(a) ((vector)_mm512_set1_ps(a))
#define FMA(a, b, c) ((vector)_mm512_fmadd_ps((__m512)(a), (__m512)(b), (__m512)(c)))
#define LESSER(a, b) ((vector)_mm512_min_ps((__m512)(a), (__m512)(b)))

typedef float vector __attribute__((vector_size(64), aligned(4), may_alias));

/* With the estimate y of 1/s and e = 1 - s^2 y^2, 1/s^3 = y^3 (1 + 3/2 e + ...): its 14 bits make |e| <= 1.3e-4, and
 * the first term left out, 15/8 e^2, 3e-8, half a rounding. */
INLINE vector over_cube(vector m, vector s2) {
  vector y = (vector)_mm512_rsqrt14_ps((__m512)s2), y2 = y * y;
  vector e = FMA(-s2, y2, SPREAD(1));
  return (m * y) * y2 * FMA(e, SPREAD(1.5f), SPREAD(1));
}

#include "plugins/common/gravity_single/single_loops.h"

static const hk_single_path path = {"floats, AVX-512", pull};

const hk_single_path *hk_single_wide16(void) { return __builtin_cpu_supports("avx512f") ? &path : NULL; }

#else

const hk_single_path *hk_single_wide16(void) { return NULL; }

#endif
