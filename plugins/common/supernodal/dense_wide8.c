/* For x86-64 with AVX-512: tiles of 2 vectors x 12 columns are 24 of its 32 registers. */
#include "plugins/common/supernodal/dense_path.h"

#if defined(__x86_64__)
#include <immintrin.h>
#include <math.h>

#define TARGET __attribute__((target("avx512f,fma")))
#define INLINE static inline __attribute__((always_inline)) TARGET
#define NAME_OF_PATH "AVX-512"
#define BYTES 64
#define TALL 2
#define WIDE 12

#define REAL double
#define NAME(x) x##_double
#define ROOT sqrt
#define FMA(a, b, c) ((vector_double)_mm512_fmadd_pd((__m512d)(a), (__m512d)(b), (__m512d)(c)))
#define FMA1(a, b, c) __builtin_fma(a, b, c)
#include "plugins/common/supernodal/dense_loops.h"

#define REAL float
#define NAME(x) x##_single
#define ROOT sqrtf
#define FMA(a, b, c) ((vector_single)_mm512_fmadd_ps((__m512)(a), (__m512)(b), (__m512)(c)))
#define FMA1(a, b, c) __builtin_fmaf(a, b, c)
#include "plugins/common/supernodal/dense_loops.h"

const hk_dense_path *hk_dense_wide8(bool single) {
  if (!__builtin_cpu_supports("avx512f")) return NULL;
  return single ? &path_single : &path_double;
}

#else

const hk_dense_path *hk_dense_wide8(bool single) {
  (void)single;
  return NULL;
}

#endif
