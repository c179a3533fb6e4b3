/* Loops in the widest vectors of the processor that runs them. HK_VERSIONS compiles a function for vectors of two
 * doubles, of four (AVX2) and of eight (AVX-512), and HK_WIDEST is the one for this processor:
 *
 *     HK_VERSIONS(static void, kick, (const leap *l, size_t begin, size_t end), kick_each(l, begin, end))
 *     ...
 *     HK_WIDEST(kick)(l, begin, end);
 *
 * The body is a call of a function that is always inlined, or some statements. With -ffp-contract=off (`hooke
 * --cflags`) all of them give the same bits, as compilers do not change the order of a sum. */
#ifndef HK_PLUGIN_WIDEST_H
#define HK_PLUGIN_WIDEST_H

#define HK_INLINE static inline __attribute__((always_inline))

#if defined(__x86_64__)
#define HK_TARGET_4 __attribute__((target("avx2")))
#define HK_TARGET_8 __attribute__((target("avx512f,avx512vl,avx512dq")))
#define HK_VERSIONS(result, name, parameters, ...)                                                                     \
  result name##_2 parameters { __VA_ARGS__; }                                                                          \
  HK_TARGET_4 result name##_4 parameters { __VA_ARGS__; }                                                              \
  HK_TARGET_8 result name##_8 parameters { __VA_ARGS__; }
#define HK_WIDEST(name)                                                                                                \
  (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq")       \
       ? name##_8                                                                                                      \
   : __builtin_cpu_supports("avx2") ? name##_4                                                                         \
                                    : name##_2)
#else
#define HK_VERSIONS(result, name, parameters, ...)                                                                     \
  result name##_2 parameters { __VA_ARGS__; }
#define HK_WIDEST(name) name##_2
#endif

#endif
