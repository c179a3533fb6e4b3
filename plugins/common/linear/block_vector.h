/* Vectors of four doubles for products with blocks, on every processor: one with narrower registers takes two for each.
 * The functions that use them are always inlined into those that HK_VERSIONS compiles, with the same operations in the
 * same order. */
#ifndef HK_BLOCK_VECTOR_H
#define HK_BLOCK_VECTOR_H

#include "core/plugin/widest.h"

typedef double vector __attribute__((vector_size(32), aligned(8), may_alias));
typedef double half __attribute__((vector_size(16), aligned(8), may_alias));

/* Macros, because vectors must not be passed between functions compiled for different instruction sets. */
#define LOAD(p) (*(const vector *)(p))
#define STORE(p, value) (*(vector *)(p) = (value))

/* Stores two numbers and one: a store of four would overlap the next row, whose load would wait for it. */
#define ADD3(p, v)                                                                                                     \
  do {                                                                                                                 \
    half two_ = {v[0], v[1]};                                                                                          \
    *(half *)(p) += two_;                                                                                              \
    (p)[2] += v[2];                                                                                                    \
  } while (0)

#endif
