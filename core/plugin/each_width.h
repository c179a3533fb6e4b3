/* Includes the file HK_LOOPS once for each width of vectors that core/plugin/widest.h chooses from, for loops that
 * compilers do not turn into good vectors by themselves. In that file LANES is 2, 4 or 8, TARGET the attribute of
 * functions with vectors, NAME(loop) the name that HK_WIDEST(loop) finds, and VECTOR a type of LANES doubles at any
 * address; SPREAD(w, r), r = 0, 1, 2, gives each of LANES numbers three places, as those of a particle have in x.
 * Functions with vectors as arguments have to be inlined. The file is included by what uses it, with its own HK_LOOPS.
 */
#include "core/plugin/widest.h"

#ifndef HK_LOOPS
#error "HK_LOOPS: the file of the loops, in quotes"
#endif

#define HK_JOIN(a, b) a##b
#define HK_JOINED(a, b) HK_JOIN(a, b)
#define NAME(loop) HK_JOINED(loop##_, LANES)
#define VECTOR NAME(vector)
#define SPREAD(w, r)                                                                                                   \
  ((r) == 0   ? HK_JOINED(SPREAD_0_, LANES)(w)                                                                         \
   : (r) == 1 ? HK_JOINED(SPREAD_1_, LANES)(w)                                                                         \
              : HK_JOINED(SPREAD_2_, LANES)(w))
#define SPREAD_0_2(w) __builtin_shufflevector(w, w, 0, 0)
#define SPREAD_1_2(w) __builtin_shufflevector(w, w, 0, 1)
#define SPREAD_2_2(w) __builtin_shufflevector(w, w, 1, 1)
#define SPREAD_0_4(w) __builtin_shufflevector(w, w, 0, 0, 0, 1)
#define SPREAD_1_4(w) __builtin_shufflevector(w, w, 1, 1, 2, 2)
#define SPREAD_2_4(w) __builtin_shufflevector(w, w, 2, 3, 3, 3)
#define SPREAD_0_8(w) __builtin_shufflevector(w, w, 0, 0, 0, 1, 1, 1, 2, 2)
#define SPREAD_1_8(w) __builtin_shufflevector(w, w, 2, 3, 3, 3, 4, 4, 4, 5)
#define SPREAD_2_8(w) __builtin_shufflevector(w, w, 5, 5, 6, 6, 6, 7, 7, 7)

#define LANES 2
#define TARGET
typedef double VECTOR __attribute__((vector_size(8 * LANES), aligned(8), may_alias));
#include HK_LOOPS
#undef TARGET
#undef LANES

#if defined(__x86_64__)
#define LANES 4
#define TARGET HK_TARGET_4
typedef double VECTOR __attribute__((vector_size(8 * LANES), aligned(8), may_alias));
#include HK_LOOPS
#undef TARGET
#undef LANES

#define LANES 8
#define TARGET HK_TARGET_8
typedef double VECTOR __attribute__((vector_size(8 * LANES), aligned(8), may_alias));
#include HK_LOOPS
#undef TARGET
#undef LANES
#endif
