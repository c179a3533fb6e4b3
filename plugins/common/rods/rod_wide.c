/* Rods with vectors of four, for x86-64 with AVX2. */
#include "plugins/common/rods/rod_path.h"

#if defined(__x86_64__)
#include <immintrin.h>

#define TARGET __attribute__((target("avx2")))
#define INLINE static inline __attribute__((always_inline, target("avx2")))
#define WIDTH 4
#define SPREAD(a) ((vector)_mm256_set1_pd(a))

typedef double vector __attribute__((vector_size(32), aligned(8), may_alias));
typedef int64_t mask __attribute__((vector_size(32), aligned(8), may_alias));
typedef uint64_t bits __attribute__((vector_size(32), aligned(8), may_alias));

INLINE vector root(vector a) { return (vector)_mm256_sqrt_pd((__m256d)a); }
INLINE double sum(vector a) { return (a[0] + a[1]) + (a[2] + a[3]); }

#include "plugins/common/rods/rod_loops.h"

static const hk_rod_path path = {"AVX2", gather, sound, plain, frames, solve, forces};

const hk_rod_path *hk_rod_wide(void) { return __builtin_cpu_supports("avx2") ? &path : NULL; }

#else

const hk_rod_path *hk_rod_wide(void) { return NULL; }

#endif
