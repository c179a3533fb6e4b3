/* For x86-64 with AVX2 and FMA: tiles of 2 vectors x 6 columns are 12 of its 16 registers. */
#include "plugins/common/supernodal/dense_path.h"

#if defined(__x86_64__)
#include <immintrin.h>
#include <math.h>

#define TARGET __attribute__((target("avx2,fma")))
#define INLINE static inline __attribute__((always_inline)) TARGET
#define NAME_OF_PATH "AVX2"
#define BYTES 32
#define TALL 2
#define WIDE 6

#define REAL double
#define NAME(x) x##_double
#define ROOT sqrt
#define FMA(a, b, c) ((vector_double)_mm256_fmadd_pd((__m256d)(a), (__m256d)(b), (__m256d)(c)))
#define FMA1(a, b, c) __builtin_fma(a, b, c)
#include "plugins/common/supernodal/dense_loops.h"

#define REAL float
#define NAME(x) x##_single
#define ROOT sqrtf
#define FMA(a, b, c) ((vector_single)_mm256_fmadd_ps((__m256)(a), (__m256)(b), (__m256)(c)))
#define FMA1(a, b, c) __builtin_fmaf(a, b, c)
#include "plugins/common/supernodal/dense_loops.h"

const hk_dense_path *hk_dense_wide4(bool single) {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return NULL;
  return single ? &path_single : &path_double;
}

#else

const hk_dense_path *hk_dense_wide4(bool single) {
  (void)single;
  return NULL;
}

#endif
