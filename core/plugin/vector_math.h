/* What processors compute with the vectors of each_width.h beyond the operations of C; to be included before it.
 *   FMA(a, b, c)      a b + c, rounded once on arm64 and by vectors of four and eight; with WIDTH 2 on other processors
 *                     the product is rounded, too. What uses it has other bits there, everything else the same
 *   FMA_ONE(a, b, c)  the same of numbers
 *   ROOT(a)           square root, correctly rounded
 *   ROOT_ESTIMATE(a)  1/root with a relative error of 1.5 2^-12 for WIDTH 4 and of 2^-14 for 8; it differs between
 *                     makes of processors. With 4, doubles beyond the range of floats give 0, infinity or NaN. Not with
 *                     WIDTH 2; of floats as of doubles
 *   LOGIC             the type of what is true in some lanes: LANES_SET(bits), where a bit is set, the lowest first;
 *                     EXCEEDS(a, b), where a > b; BOTH(p, q)
 *   HALVES(a, b)      the lower half of a and the upper one of b
 *   CHOOSE(p, a, b)   a where p is true, b elsewhere;  KEEP(p, a) has 0 there, ADD_KEPT(p, a, b) a instead of a + b */
#ifndef HK_PLUGIN_VECTOR_MATH_H
#define HK_PLUGIN_VECTOR_MATH_H

#include <math.h>
#include <stdint.h>

#define HK_OPERATION_(operation, real, width) operation##_##real##_##width
#define HK_OPERATION(operation, real, width) HK_OPERATION_(operation, real, width)

/* All bits of the lanes whose bit is set in the index. */
static const int64_t hk_lane_bits[16][4] = {
#define ROW(b)                                                                                                         \
  { -((b)&1), -((b) >> 1 & 1), -((b) >> 2 & 1), -((b) >> 3 & 1) }
    ROW(0), ROW(1),  ROW(2),  ROW(3),  ROW(4),  ROW(5),  ROW(6), ROW(7), ROW(8),
    ROW(9), ROW(10), ROW(11), ROW(12), ROW(13), ROW(14), ROW(15)
#undef ROW
};

#define HK_LOGIC_double_2 MASK
#define HK_LOGIC_double_4 MASK
#define HK_LANES_SET_double_2(bits) (*(const MASK *)hk_lane_bits[(bits)&3])
#define HK_LANES_SET_double_4(bits) (*(const MASK *)hk_lane_bits[(bits)&15])
#define HK_EXCEEDS_double_2(a, b) ((MASK)((a) > (b)))
#define HK_EXCEEDS_double_4(a, b) ((MASK)((a) > (b)))
#define HK_KEEP_double_2(p, a) ((VECTOR)((p) & (MASK)(a)))
#define HK_KEEP_double_4 HK_KEEP_double_2
#define HK_CHOOSE_double_2(p, a, b) ((VECTOR)(((p) & (MASK)(a)) | (~(p) & (MASK)(b))))
#define HK_ADD_KEPT_double_2(p, a, b) ((a) + HK_KEEP_double_2(p, b))
#define HK_ADD_KEPT_double_4 HK_ADD_KEPT_double_2

#if defined(__aarch64__)
#include <arm_neon.h>
#define HK_FMA_double_2(a, b, c) ((VECTOR)vfmaq_f64((float64x2_t)(c), (float64x2_t)(a), (float64x2_t)(b)))
#define HK_FMA_float_2(a, b, c) ((VECTOR)vfmaq_f32((float32x4_t)(c), (float32x4_t)(a), (float32x4_t)(b)))
#define HK_FMA_ONE_double_2(a, b, c) __builtin_fma(a, b, c)
#define HK_FMA_ONE_float_2(a, b, c) __builtin_fmaf(a, b, c)
#else
#define HK_FMA_double_2(a, b, c) ((a) * (b) + (c))
#define HK_FMA_float_2(a, b, c) ((a) * (b) + (c))
#define HK_FMA_ONE_double_2(a, b, c) ((a) * (b) + (c))
#define HK_FMA_ONE_float_2(a, b, c) ((a) * (b) + (c))
#endif
#define HK_SQUARE_ROOT_double_2(a) ((VECTOR){sqrt((a)[0]), sqrt((a)[1])})

#if defined(__x86_64__)
#include <immintrin.h>
#define HK_FMA_double_4(a, b, c) ((VECTOR)_mm256_fmadd_pd((__m256d)(a), (__m256d)(b), (__m256d)(c)))
#define HK_FMA_double_8(a, b, c) ((VECTOR)_mm512_fmadd_pd((__m512d)(a), (__m512d)(b), (__m512d)(c)))
#define HK_FMA_float_4(a, b, c) ((VECTOR)_mm256_fmadd_ps((__m256)(a), (__m256)(b), (__m256)(c)))
#define HK_FMA_float_8(a, b, c) ((VECTOR)_mm512_fmadd_ps((__m512)(a), (__m512)(b), (__m512)(c)))
#define HK_FMA_ONE_double_4(a, b, c) __builtin_fma(a, b, c)
#define HK_FMA_ONE_double_8(a, b, c) __builtin_fma(a, b, c)
#define HK_FMA_ONE_float_4(a, b, c) __builtin_fmaf(a, b, c)
#define HK_FMA_ONE_float_8(a, b, c) __builtin_fmaf(a, b, c)
#define HK_SQUARE_ROOT_double_4(a) ((VECTOR)_mm256_sqrt_pd((__m256d)(a)))
#define HK_SQUARE_ROOT_double_8(a) ((VECTOR)_mm512_sqrt_pd((__m512d)(a)))
#define HK_ROOT_ESTIMATE_double_4(a) ((VECTOR)_mm256_cvtps_pd(_mm_rsqrt_ps(_mm256_cvtpd_ps((__m256d)(a)))))
#define HK_ROOT_ESTIMATE_double_8(a) ((VECTOR)_mm512_rsqrt14_pd((__m512d)(a)))
#define HK_ROOT_ESTIMATE_float_4(a) ((VECTOR)_mm256_rsqrt_ps((__m256)(a)))
#define HK_ROOT_ESTIMATE_float_8(a) ((VECTOR)_mm512_rsqrt14_ps((__m512)(a)))
#define HK_HALVES_double_4(a, b) ((VECTOR)_mm256_blend_pd((__m256d)(a), (__m256d)(b), 12))
#define HK_CHOOSE_double_4(p, a, b) ((VECTOR)_mm256_blendv_pd((__m256d)(b), (__m256d)(a), (__m256d)(p)))
#define HK_LOGIC_double_8 __mmask8
#define HK_LANES_SET_double_8(bits) ((__mmask8)(bits))
#define HK_EXCEEDS_double_8(a, b) _mm512_cmp_pd_mask((__m512d)(a), (__m512d)(b), _CMP_GT_OQ)
#define HK_KEEP_double_8(p, a) ((VECTOR)_mm512_maskz_mov_pd(p, (__m512d)(a)))
#define HK_CHOOSE_double_8(p, a, b) ((VECTOR)_mm512_mask_mov_pd((__m512d)(b), p, (__m512d)(a)))
#define HK_ADD_KEPT_double_8(p, a, b) ((VECTOR)_mm512_mask_add_pd((__m512d)(a), p, (__m512d)(a), (__m512d)(b)))
#endif

#endif
