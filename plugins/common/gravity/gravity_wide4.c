/* Four targets at a time, for x86-64 with AVX2 and FMA. */
#include "plugins/common/gravity/gravity_path.h"

#if defined(__x86_64__)
#include <immintrin.h>

#define TARGET __attribute__((target("avx2,fma")))
#define INLINE static inline __attribute__((always_inline, target("avx2,fma")))
#define LANES 4
#define SPREAD(a) ((vector)_mm256_set1_pd(a))
#define FMA(a, b, c) ((vector)_mm256_fmadd_pd((__m256d)(a), (__m256d)(b), (__m256d)(c)))

typedef double vector __attribute__((vector_size(32), aligned(8), may_alias));
typedef int64_t mask __attribute__((vector_size(32), aligned(8), may_alias));

/* The estimate is one of floats, 1.5 2^-12: |e| <= 7.4e-4, and the first term left out, 63/256 e^5, is 6e-17. */
INLINE vector root(vector s2) {
  vector y = (vector)_mm256_cvtps_pd(_mm_rsqrt_ps(_mm256_cvtpd_ps((__m256d)s2)));
  vector e = FMA(-(s2 * y), y, SPREAD(1));
  vector series = FMA(e, FMA(e, FMA(e, SPREAD(0.2734375), SPREAD(0.3125)), SPREAD(0.375)), SPREAD(0.5));
  return FMA(y * e, series, y);
}

#include "plugins/common/gravity/gravity_loops.h"

static const hk_gravity_path path = PATH("AVX2");

const hk_gravity_path *hk_gravity_wide4(void) {
  return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") ? &path : NULL;
}

#else

const hk_gravity_path *hk_gravity_wide4(void) { return NULL; }

#endif
