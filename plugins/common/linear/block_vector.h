/* Vectors of four doubles for products with blocks, compiled twice: for processors with registers of that width, and
 * for any processor. Both versions do the same operations in the same order. */
#ifndef HK_BLOCK_VECTOR_H
#define HK_BLOCK_VECTOR_H

typedef double vector __attribute__((vector_size(32), aligned(8), may_alias));
typedef double half __attribute__((vector_size(16), aligned(8), may_alias));

/* Macros and functions that are always inlined, because vectors must not be passed between functions compiled for
 * different instruction sets. */
#define INLINE static inline __attribute__((always_inline))
#define LOAD(p) (*(const vector *)(p))
#define STORE(p, value) (*(vector *)(p) = (value))

#if defined(__x86_64__)
#define WIDE __attribute__((target("avx2")))
#define HAS_WIDE() __builtin_cpu_supports("avx2")
#else
#define WIDE
#define HAS_WIDE() 0
#endif

/* Stores two numbers and one: a store of four would overlap the next row, whose load would wait for it. */
#define ADD3(p, v)                                                                                                     \
  do {                                                                                                                 \
    half two_ = {v[0], v[1]};                                                                                          \
    *(half *)(p) += two_;                                                                                              \
    (p)[2] += v[2];                                                                                                    \
  } while (0)

#endif
