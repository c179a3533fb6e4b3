/* The checksum of HDF5's metadata: Bob Jenkins' lookup3 with initial value 0 (hashlittle; public domain, 2006), which
 * is what the HDF5 File Format Specification names. */
#ifndef HK_H5_CHECKSUM_H
#define HK_H5_CHECKSUM_H

#include <stddef.h>
#include <stdint.h>

static inline uint32_t hk_rotate(uint32_t x, int k) { return x << k | x >> (32 - k); }

static inline void hk_lookup3_mix(uint32_t w[3]) {
  static const int turn[6] = {4, 6, 8, 16, 19, 4};
  for (int k = 0; k < 6; k++) { /* a -= c, a ^= rot(c), c += b; then b, c, a and so on */
    uint32_t *a = &w[k % 3], *b = &w[(k + 1) % 3], *c = &w[(k + 2) % 3];
    *a -= *c, *a ^= hk_rotate(*c, turn[k]), *c += *b;
  }
}

static inline void hk_lookup3_final(uint32_t w[3]) {
  static const int turn[7] = {14, 11, 25, 16, 4, 14, 24};
  for (int k = 0; k < 7; k++) { /* c ^= b, c -= rot(b); then a ^= c, b ^= a and so on */
    uint32_t *to = &w[(k + 2) % 3], *from = &w[(k + 1) % 3];
    *to ^= *from, *to -= hk_rotate(*from, turn[k]);
  }
}

static inline uint32_t hk_h5_checksum(const void *bytes, size_t size) {
  const unsigned char *byte = bytes;
  uint32_t w[3];
  w[0] = w[1] = w[2] = 0xdeadbeefu + (uint32_t)size;
  if (size == 0) return w[2];
  for (; size > 12; size -= 12, byte += 12) {
    for (int k = 0; k < 12; k++) w[k / 4] += (uint32_t)byte[k] << 8 * (k % 4);
    hk_lookup3_mix(w);
  }
  for (size_t k = 0; k < size; k++) w[k / 4] += (uint32_t)byte[k] << 8 * (k % 4);
  hk_lookup3_final(w);
  return w[2];
}

#endif
