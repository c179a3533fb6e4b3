/* Springs without runs, in slices. A slice has up to eight bundles side by side, of springs at one particle each: its
 * first slot has the first spring of every bundle, the second slot the second ones, and so on, bundles with more
 * springs before those with fewer. So the particles of the bundles, the first ends, are read and their forces are
 * written once for all of their springs, and eight springs of a slot are computed together.
 *
 * Forces are added in this order: slot after slot those on the second ends, then to each first end the sum of its
 * springs'. An end may occur many times in a slice.
 *
 * Measured with eight lanes on Zen 5, on a mesh of 130,000 particles in random order, ns a spring for the list alone:
 * springs sorted by both ends, each end read and written for every spring, 4.5; slices 2.7; where a slot begins before
 * the one ahead of it ends, 2.5 (in the first-level cache 2.1 instead of 2.35, of which 1.3 without the additions to
 * second ends). Not faster, within what a busy machine lets one see: rows of four numbers in which the forces of a part
 * are summed before they are added to F, with one store for a force (0.5 instead of 0.8 for the additions, but as much
 * more for the rows themselves); indices multiplied by three beforehand; bundles of fewer particles with more springs
 * each, by a greedy cover of the edges; bundles far apart beside each other, with forces added as vectors of four;
 * large pages; particles along a curve of Hilbert or by Cuthill and McKee instead of in rows
 * (core/scene/scene/order.c). With two lanes slices take up to a tenth longer than the sorted springs took, with four a
 * quarter less. */
#ifndef HK_SPRING_SLICES_H
#define HK_SPRING_SLICES_H

#include "core/plugin.h"
#include <string.h>

enum {
  HK_SPRING_BUNDLES = 8, /* of a slice */
  HK_SPRING_SLOTS = 16   /* of a slice, at most; a particle with more springs has several bundles */
};

/* Eight pairs can be read from any of the list on, and the coordinates of their particles with one number beyond. */
typedef struct hk_spring_list {
  size_t count;              /* springs */
  const uint32_t (*pair)[2]; /* count: a bundle's particle first */
  const uint8_t *lanes;      /* the springs of each slot; 0 after the last slot of a slice */
} hk_spring_list;

/* Puts `count` springs into the order of slices. `order` has room for twice as many, `lanes` too. Returns the length of
 * `lanes`. */
static inline size_t hk_spring_slices_sort(const hk_tuples *edges, uint32_t *order, size_t count, uint8_t *lanes);

/* The end by whose springs bundles are made. */
static inline uint32_t hk_spring_owner(const uint32_t pair[2]) { return pair[0] > pair[1] ? pair[0] : pair[1]; }

/* ---- how ---- */

/* The order of springs in slices: sorted by their higher end, which owns them, and by their lower one; bundles are cut
 * from this order, sorted by size among some hundred neighbours, so that slots are full and particles are still close,
 * and taken in eights. */

enum { HK_SPRING_SORTED = 256 /* sorted at once; 64 are slower, 1024 as fast */ };

typedef struct hk_spring_bundle {
  uint32_t *first;
  size_t size;
} hk_spring_bundle;

static inline uint32_t hk_spring_owner_of(const hk_tuples *edges, uint32_t e) {
  return hk_spring_owner(hk_tuple(edges, e));
}

/* The next bundles of a list that ends at `end`; their number. */
static inline size_t hk_spring_cut(const hk_tuples *edges, uint32_t **list, const uint32_t *end,
                                   hk_spring_bundle out[HK_SPRING_SORTED]) {
  size_t count = 0;
  for (; *list < end && count < HK_SPRING_SORTED; count++) {
    hk_spring_bundle b = {*list, 1};
    uint32_t owner = hk_spring_owner_of(edges, *b.first);
    while (b.size < HK_SPRING_SLOTS && b.first + b.size < end && hk_spring_owner_of(edges, b.first[b.size]) == owner)
      b.size++;
    *list += b.size;
    out[count] = b;
  }
  return count;
}

/* By size, the largest first, otherwise as they are. */
static inline void hk_spring_sort_by_size(hk_spring_bundle *list, size_t count) {
  hk_spring_bundle sorted[HK_SPRING_SORTED];
  size_t placed = 0;
  for (size_t size = HK_SPRING_SLOTS; size > 0; size--)
    for (size_t k = 0; k < count; k++)
      if (list[k].size == size) sorted[placed++] = list[k];
  memcpy(list, sorted, count * sizeof *list);
}

/* Writes a slice of `count` bundles; returns the length of its lanes. */
static inline size_t hk_spring_write_slice(const hk_spring_bundle *list, size_t count, uint32_t **to, uint8_t *lanes) {
  size_t slots = list->size;
  for (size_t t = 0; t < slots; t++) {
    lanes[t] = 0;
    for (size_t r = 0; r < count && list[r].size > t; r++, lanes[t]++) *(*to)++ = list[r].first[t];
  }
  lanes[slots] = 0;
  return slots + 1;
}

static inline size_t hk_spring_slices_sort(const hk_tuples *edges, uint32_t *order, size_t count, uint8_t *lanes) {
  hk_spring_bundle list[HK_SPRING_SORTED];
  uint32_t *from = order + count, *to = order;
  size_t used = 0, bundles;
  memcpy(from, order, count * sizeof *order);
  for (const uint32_t *end = from + count; (bundles = hk_spring_cut(edges, &from, end, list)) > 0;) {
    hk_spring_sort_by_size(list, bundles);
    for (size_t k = 0; k < bundles; k += HK_SPRING_BUNDLES)
      used += hk_spring_write_slice(list + k, bundles - k < HK_SPRING_BUNDLES ? bundles - k : HK_SPRING_BUNDLES, &to,
                                    lanes + used);
  }
  return used;
}

#endif
