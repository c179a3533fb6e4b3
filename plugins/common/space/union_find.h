/* Disjoint sets of numbers (Tarjan 1975, with path halving): parent[i] = i where i is a root, which is the least number
 * of its set. */
#ifndef HK_UNION_FIND_H
#define HK_UNION_FIND_H

#include <stdint.h>

static inline uint32_t hk_root_of(uint32_t *parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

static inline void hk_unite(uint32_t *parent, uint32_t i, uint32_t j) {
  uint32_t a = hk_root_of(parent, i), b = hk_root_of(parent, j);
  parent[a > b ? a : b] = a > b ? b : a;
}

#endif
