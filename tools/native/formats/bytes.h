/* Numbers as files have them, whatever the order of the machine's bytes. */
#ifndef HK_SEQUENCE_BYTES_H
#define HK_SEQUENCE_BYTES_H

#include <stdint.h>
#include <stdio.h>
#include <string.h>

static inline uint64_t hk_bits(double x) {
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  return bits;
}

static inline uint32_t hk_bits_single(float x) {
  uint32_t bits;
  memcpy(&bits, &x, sizeof bits);
  return bits;
}

static inline void hk_put_little(FILE *file, uint64_t value, unsigned bytes) {
  unsigned char b[8];
  for (unsigned k = 0; k < bytes; k++) b[k] = (unsigned char)(value >> 8 * k);
  fwrite(b, 1, bytes, file);
}

static inline void hk_put_big(FILE *file, uint64_t value, unsigned bytes) {
  unsigned char b[8];
  for (unsigned k = 0; k < bytes; k++) b[bytes - 1 - k] = (unsigned char)(value >> 8 * k);
  fwrite(b, 1, bytes, file);
}

/* A name without spaces and what would end it. */
static inline void hk_put_word(FILE *file, const char *name) {
  for (; *name; name++) putc(strchr(" \t\r\n/\"", *name) ? '_' : *name, file);
}

#endif
