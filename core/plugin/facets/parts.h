/* Facet of forces with `add_part` that are sums over elements: which blocks of particles each part touches. */
#ifndef HK_PLUGIN_PARTS_FACET_H
#define HK_PLUGIN_PARTS_FACET_H

#include "core/plugin/force.h"

/* What the elements of all parts touch, for the host, which fills it with "nothing" before it asks. */
typedef struct hk_part_use {
  const hk_partition *partition;
  uint32_t *lowest; /* parts: the lowest block that it touches; UINT32_MAX: it has no elements */
  bool *deferred;   /* blocks: touched by an element across domains */
} hk_part_use;

/* Notes an element. */
static inline void hk_part_touch(const hk_part_use *u, const uint32_t *index, size_t arity) {
  size_t part = hk_part_of(u->partition, index, arity);
  for (size_t c = 0; c < arity; c++) {
    uint32_t block = index[c] >> u->partition->bits;
    if (block < u->lowest[part]) u->lowest[part] = block;
    if (part >= u->partition->blocks) u->deferred[block] = true;
  }
}

#define HK_PARTS_ID "parts/1"
#define HK_PARTS_FACET(...) HK_FACET(HK_PARTS_ID, hk_parts_facet, __VA_ARGS__)

typedef struct hk_parts_facet {
  size_t size;
  /* Notes all elements that act (hk_part_touch). Called when the force has been created and after every `topology`.
   * Required. */
  void (*touch)(void *self, const hk_view *view, const hk_part_use *use);
} hk_parts_facet;

#endif
