/* The order of springs in slices: sorted by their higher end, which owns them, and by their lower one; bundles are cut
 * from this order, sorted by size among some hundred neighbours, so that slots are full and particles are still close,
 * and taken in eights. */
#include "plugins/common/springs/spring_slices.h"

#include <string.h>

enum { BUNDLES = HK_SPRING_BUNDLES, SLOTS = HK_SPRING_SLOTS, WINDOW = 256 /* bundles; 64 are slower, 1024 as fast */ };

typedef struct bundle {
  uint32_t *first;
  size_t size;
} bundle;

static uint32_t owner_of(const hk_tuples *edges, uint32_t e) { return hk_spring_owner(hk_tuple(edges, e)); }

/* The next bundles of a list that ends at `end`; their number. */
static size_t cut(const hk_tuples *edges, uint32_t **list, const uint32_t *end, bundle out[WINDOW]) {
  size_t count = 0;
  for (; *list < end && count < WINDOW; count++) {
    bundle b = {*list, 1};
    uint32_t owner = owner_of(edges, *b.first);
    while (b.size < SLOTS && b.first + b.size < end && owner_of(edges, b.first[b.size]) == owner) b.size++;
    *list += b.size;
    out[count] = b;
  }
  return count;
}

/* By size, the largest first, otherwise as they are. */
static void sort_by_size(bundle *list, size_t count) {
  bundle sorted[WINDOW];
  size_t placed = 0;
  for (size_t size = SLOTS; size > 0; size--)
    for (size_t k = 0; k < count; k++)
      if (list[k].size == size) sorted[placed++] = list[k];
  memcpy(list, sorted, count * sizeof *list);
}

/* Writes a slice of `count` bundles; returns the length of its lanes. */
static size_t write_slice(const bundle *list, size_t count, uint32_t **to, uint8_t *lanes) {
  size_t slots = list->size;
  for (size_t t = 0; t < slots; t++) {
    lanes[t] = 0;
    for (size_t r = 0; r < count && list[r].size > t; r++, lanes[t]++) *(*to)++ = list[r].first[t];
  }
  lanes[slots] = 0;
  return slots + 1;
}

size_t hk_spring_slices_sort(const hk_tuples *edges, uint32_t *order, size_t count, uint8_t *lanes) {
  bundle list[WINDOW];
  uint32_t *from = order + count, *to = order;
  size_t used = 0, bundles;
  memcpy(from, order, count * sizeof *order);
  for (const uint32_t *end = from + count; (bundles = cut(edges, &from, end, list)) > 0;) {
    sort_by_size(list, bundles);
    for (size_t k = 0; k < bundles; k += BUNDLES)
      used += write_slice(list + k, bundles - k < BUNDLES ? bundles - k : BUNDLES, &to, lanes + used);
  }
  return used;
}
