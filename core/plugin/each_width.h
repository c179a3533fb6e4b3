/* Includes the file HK_LOOPS once for each width of vectors that core/plugin/widest.h chooses from, for loops that
 * compilers do not turn into good vectors by themselves. Numbers are doubles, or HK_REAL where that is defined, as
 * float. In that file
 *   WIDTH      2, 4 or 8: the doubles of a vector
 *   LANES      the numbers of a vector, WIDTH or, of floats, twice that
 *   TARGET     the attribute of functions with vectors
 *   NAME(loop) the name that HK_WIDEST(lanes, loop) finds
 *   VECTOR     a type of LANES numbers at any address
 *   MASK       one of LANES integers, which comparisons give: all bits where they are true
 *   FILL(a)    a number in all lanes
 *   SPREAD(w, r), r = 0, 1, 2, gives each of LANES doubles three places, as those of a particle have in x
 * Functions with vectors as arguments have to be inlined. The file is included by what uses it, with its own HK_LOOPS;
 * none of these names is left behind.
 */
#include "core/plugin/widest.h"

#include <stdint.h>

#ifndef HK_PLUGIN_EACH_WIDTH_H
#define HK_PLUGIN_EACH_WIDTH_H
#define HK_JOIN(a, b) a##b
#define HK_JOINED(a, b) HK_JOIN(a, b)
#define HK_MASK_OF_double int64_t
#define HK_MASK_OF_float int32_t
#define HK_SPREAD_0_2(w) __builtin_shufflevector(w, w, 0, 0)
#define HK_SPREAD_1_2(w) __builtin_shufflevector(w, w, 0, 1)
#define HK_SPREAD_2_2(w) __builtin_shufflevector(w, w, 1, 1)
#define HK_SPREAD_0_4(w) __builtin_shufflevector(w, w, 0, 0, 0, 1)
#define HK_SPREAD_1_4(w) __builtin_shufflevector(w, w, 1, 1, 2, 2)
#define HK_SPREAD_2_4(w) __builtin_shufflevector(w, w, 2, 3, 3, 3)
#define HK_SPREAD_0_8(w) __builtin_shufflevector(w, w, 0, 0, 0, 1, 1, 1, 2, 2)
#define HK_SPREAD_1_8(w) __builtin_shufflevector(w, w, 2, 3, 3, 3, 4, 4, 4, 5)
#define HK_SPREAD_2_8(w) __builtin_shufflevector(w, w, 5, 5, 6, 6, 6, 7, 7, 7)
#endif

#ifndef HK_LOOPS
#error "HK_LOOPS: the file of the loops, in quotes"
#endif
#ifndef HK_REAL
#define HK_REAL double
#endif

#define NAME(loop) HK_JOINED(loop##_, WIDTH)
#define LANES (8 * WIDTH / sizeof(HK_REAL))
#define VECTOR NAME(vector)
#define MASK NAME(mask)
#define FILL(a) ((VECTOR)((a) - (VECTOR){0}))
#define SPREAD(w, r)                                                                                                   \
  ((r) == 0   ? HK_JOINED(HK_SPREAD_0_, WIDTH)(w)                                                                      \
   : (r) == 1 ? HK_JOINED(HK_SPREAD_1_, WIDTH)(w)                                                                      \
              : HK_JOINED(HK_SPREAD_2_, WIDTH)(w))
/* With core/plugin/vector_math.h: */
#define FMA(a, b, c) HK_OPERATION(HK_FMA, HK_REAL, WIDTH)(a, b, c)
#define FMA_ONE(a, b, c) HK_OPERATION(HK_FMA_ONE, HK_REAL, WIDTH)(a, b, c)
#define ROOT(a) HK_OPERATION(HK_SQUARE_ROOT, HK_REAL, WIDTH)(a)
#define ROOT_ESTIMATE(a) HK_OPERATION(HK_ROOT_ESTIMATE, HK_REAL, WIDTH)(a)
#define HALVES(a, b) HK_OPERATION(HK_HALVES, HK_REAL, WIDTH)(a, b)
#define LOGIC HK_OPERATION(HK_LOGIC, HK_REAL, WIDTH)
#define LANES_SET(bits) HK_OPERATION(HK_LANES_SET, HK_REAL, WIDTH)(bits)
#define EXCEEDS(a, b) HK_OPERATION(HK_EXCEEDS, HK_REAL, WIDTH)(a, b)
#define BOTH(p, q) ((p) & (q))
#define CHOOSE(p, a, b) HK_OPERATION(HK_CHOOSE, HK_REAL, WIDTH)(p, a, b)
#define KEEP(p, a) HK_OPERATION(HK_KEEP, HK_REAL, WIDTH)(p, a)
#define ADD_KEPT(p, a, b) HK_OPERATION(HK_ADD_KEPT, HK_REAL, WIDTH)(p, a, b)
#define HK_VECTOR_TYPES                                                                                                \
  typedef HK_REAL VECTOR __attribute__((vector_size(8 * WIDTH), aligned(sizeof(HK_REAL)), may_alias));                 \
  typedef HK_JOINED(HK_MASK_OF_, HK_REAL) MASK                                                                         \
      __attribute__((vector_size(8 * WIDTH), aligned(sizeof(HK_REAL)), may_alias));

#define WIDTH 2
#define TARGET
HK_VECTOR_TYPES
#include HK_LOOPS
#undef TARGET
#undef WIDTH

#if defined(__x86_64__)
#define WIDTH 4
#define TARGET HK_TARGET_4
HK_VECTOR_TYPES
#include HK_LOOPS
#undef TARGET
#undef WIDTH

#define WIDTH 8
#define TARGET HK_TARGET_8
HK_VECTOR_TYPES
#include HK_LOOPS
#undef TARGET
#undef WIDTH
#endif

#undef NAME
#undef LANES
#undef VECTOR
#undef MASK
#undef FILL
#undef SPREAD
#undef FMA
#undef FMA_ONE
#undef ROOT
#undef ROOT_ESTIMATE
#undef HALVES
#undef HALVES
#undef LOGIC
#undef LANES_SET
#undef EXCEEDS
#undef BOTH
#undef CHOOSE
#undef KEEP
#undef ADD_KEPT
#undef HK_VECTOR_TYPES
#undef HK_LOOPS
#undef HK_REAL
