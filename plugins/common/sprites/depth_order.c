/* Radix sort by the bits of the depth, 11 at a time: positive floats have the order of their bits. */
#include "plugins/common/sprites/depth_order.h"

#include <string.h>

enum { BITS = 11, DIGITS = 1 << BITS, PASSES = 3 };

static void sort_by_digit(const uint32_t *key, const uint32_t *order, size_t count, int shift, uint32_t *key_to,
                          uint32_t *order_to) {
  size_t at[DIGITS] = {0}, sum = 0;
  for (size_t k = 0; k < count; k++) at[key[k] >> shift & (DIGITS - 1)]++;
  for (int d = 0; d < DIGITS; d++) {
    size_t here = at[d];
    at[d] = sum, sum += here;
  }
  for (size_t k = 0; k < count; k++) {
    size_t to = at[key[k] >> shift & (DIGITS - 1)]++;
    key_to[to] = key[k], order_to[to] = order[k];
  }
}

size_t hk_depth_order(const hk_sprite *sprite, size_t count, uint32_t *order, uint32_t *spare, uint32_t *key) {
  size_t seen = 0;
  uint32_t *from = spare, *to = order, *key_from = key, *key_to = key + count;
  for (size_t k = 0; k < count; k++) {
    if (!(sprite[k].radius > 0)) continue;
    uint32_t bits;
    memcpy(&bits, &sprite[k].depth, sizeof bits);
    key_from[seen] = bits, from[seen++] = (uint32_t)k;
  }
  for (int pass = 0; pass < PASSES; pass++) { /* an odd number of passes: the last one writes to `order` */
    sort_by_digit(key_from, from, seen, pass * BITS, key_to, to);
    uint32_t *other = from, *other_key = key_from;
    from = to, to = other, key_from = key_to, key_to = other_key;
  }
  return seen;
}
