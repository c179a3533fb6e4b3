/* Moves in which two bodies pass each other between two steps: their force is of short range then, r/3. */
#ifndef HK_FLYBYS_H
#define HK_FLYBYS_H

#include "core/plugin.h"

typedef struct hk_flybys {
  double G, softening;
  const hk_view *to;
  const double *x_from; /* n x 3 */
  hk_encounters *into;
  bool (*acts)(const void *self, uint32_t i, uint32_t j); /* whether a pair does */
  const void *self;
} hk_flybys;

/* False: no body moved far enough for any, whatever the others. */
bool hk_flybys_possible(const hk_flybys *);
/* Names all in the tree of the acting bodies at `to`. */
void hk_flybys_find(const hk_flybys *, const hk_octree *);

#endif
