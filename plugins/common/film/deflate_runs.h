/* Compression of what is mostly runs of equal bytes, as filtered pictures are, to blocks of Deutsch 1996, "DEFLATE
 * compressed data format", RFC 1951: bytes and runs with a Huffman code that is made for each block. One pass finds the
 * runs, one writes them; nothing is searched. */
#ifndef HK_DEFLATE_RUNS_H
#define HK_DEFLATE_RUNS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { HK_RUN_SHORTEST = 3, HK_RUN_LONGEST = 258, HK_TOKENS = 256 + HK_RUN_LONGEST - HK_RUN_SHORTEST + 1 };

/* Bits, the lowest first. */
typedef struct hk_bits {
  unsigned char *at; /* the next byte */
  uint64_t held;     /* what is not yet there, fewer than 8 bits after each call */
  unsigned count;
} hk_bits;

/* Tokens of the bytes, which are appended: below 256 a byte, else the byte before it 3 to 258 times, from 256 on. There
 * is room for one a byte. Returns how many there are. */
size_t hk_runs_find(const unsigned char *bytes, size_t count, uint16_t *token);
/* Bytes that a block of so many tokens may take. */
static inline size_t hk_runs_room(size_t tokens) { return 3 * tokens + 512; }
/* Appends a block; tokens: 1 to 1e7 of them. */
void hk_runs_write(hk_bits *, const uint16_t *token, size_t count, bool last);
/* Appends bits; count: 0 to 32. */
void hk_bits_add(hk_bits *, uint64_t bits, unsigned count);
/* Zeros up to a whole byte. */
void hk_bits_fill(hk_bits *);

#endif
