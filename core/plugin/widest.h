/* Loops in the widest vectors of the processor that runs them. HK_VERSIONS compiles a function for vectors of two
 * doubles, of four (AVX2) and of eight (AVX-512), and HK_WIDEST is the one for hk_host.lanes, which is 2 on processors
 * of other kinds:
 *
 *     HK_VERSIONS(static void, kick, (const leap *l, size_t begin, size_t end), kick_each(l, begin, end))
 *     ...
 *     HK_WIDEST(host->lanes, kick)(l, begin, end);
 *
 * The body is a call of a function that is always inlined, or some statements. All of them give the same bits, since
 * compilers do not change the order of a sum, where products and sums are not contracted to one operation: that takes
 * -ffp-contract=off, which `hooke --cflags` gives. Vectors are arguments of inlined functions only. Nothing but this
 * header, each_width.h and the host's processor.c knows of kinds of processors. */
#ifndef HK_PLUGIN_WIDEST_H
#define HK_PLUGIN_WIDEST_H

#define HK_INLINE static inline __attribute__((always_inline))

#if defined(__x86_64__)
#define HK_TARGET_4 __attribute__((target("avx2,fma")))
#define HK_TARGET_8 __attribute__((target("avx512f,avx512vl,avx512dq,fma")))
#define HK_VERSIONS(result, name, parameters, ...)                                                                     \
  result name##_2 parameters { __VA_ARGS__; }                                                                          \
  HK_TARGET_4 result name##_4 parameters { __VA_ARGS__; }                                                              \
  HK_TARGET_8 result name##_8 parameters { __VA_ARGS__; }
#define HK_WIDEST(lanes, name) ((lanes) >= 8 ? name##_8 : (lanes) >= 4 ? name##_4 : name##_2)
#else
#define HK_VERSIONS(result, name, parameters, ...)                                                                     \
  result name##_2 parameters { __VA_ARGS__; }
#define HK_WIDEST(lanes, name) ((void)(lanes), name##_2)
#endif

#endif
