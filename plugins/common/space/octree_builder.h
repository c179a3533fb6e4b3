/* Builds octrees: points are sorted along Morton's curve, where a cube of the octree is a contiguous part, and cubes
 * are halved until they have few points. Cubes with a single part are left out, so that every cell with parts has two
 * at least, and there are fewer than twice as many cells as points, however near to each other they are. */
#ifndef HK_OCTREE_BUILDER_H
#define HK_OCTREE_BUILDER_H

#include "core/plugin.h"

enum { HK_OCTREE_LEAF = 8, HK_OCTREE_DEPTH = 21 };

typedef struct hk_octree_builder {
  const hk_host *host;
  size_t room;
  uint64_t *key, *spare_key;
  uint32_t *order, *spare;
  hk_octree_cell *cell; /* 2 x room */
} hk_octree_builder;

/* Memory for n points. HK_NO_MEMORY, without a message. */
hk_status hk_octree_reserve(hk_octree_builder *, const hk_host *, size_t n);
void hk_octree_release(hk_octree_builder *);
/* list: `count` particles; NULL: 0 to count - 1. False: *flawed, an index, is at no finite place. */
bool hk_octree_build(hk_octree_builder *, const double *x, const uint32_t *list, size_t count, hk_octree *,
                     uint32_t *flawed);

#endif
