/* The Huffman code of a block: two queues, of symbols by their counts and of the nodes that join two (van Leeuwen
 * 1976). Where a code would be longer than 15 bits, counts are halved until it is not. */
#include "plugins/common/film/deflate_runs.h"

#include <stdlib.h>
#include <string.h>

enum { SYMBOLS = 286, END = 256, FIRST_RUN = 257, RUN_SYMBOLS = 29, LONGEST_CODE = 15 };

/* ---- bits ---- */

void hk_bits_add(hk_bits *b, uint64_t bits, unsigned count) {
  b->held |= bits << b->count;
  b->count += count;
  for (; b->count >= 8; b->count -= 8, b->held >>= 8) *b->at++ = (unsigned char)b->held;
}

void hk_bits_fill(hk_bits *b) { hk_bits_add(b, 0, (8 - b->count) % 8); }

/* ---- runs ---- */

/* How many of the bytes at `at`, at most `most`, are equal to `byte`. */
static size_t run_of(const unsigned char *at, size_t most, unsigned char byte) {
  const uint64_t all = 0x0101010101010101u * byte;
  size_t k = 0;
  uint64_t here = all;
  for (; k + 8 <= most; k += 8) {
    memcpy(&here, at + k, 8);
    if (here != all) break;
  }
  while (k < most && at[k] == byte) k++;
  return k;
}

/* How many of the 6 bytes at `at` begin no run, from the first on; 9 are read. The bytes that are equal to the next are
 * zeros of the difference, which carry no bit out of theirs (Warren, Hacker's Delight, 6-1). */
static unsigned without_run(const unsigned char *at) {
  const uint64_t low = 0x7f7f7f7f7f7f7f7f;
  uint64_t here, next;
  memcpy(&here, at, 8), memcpy(&next, at + 1, 8);
  uint64_t differ = here ^ next, equal = ~(((differ & low) + low) | differ | low);
  uint64_t runs = equal & equal >> 8 & equal >> 16;
  return runs ? (unsigned)__builtin_ctzll(runs) / 8 : 6;
}

/* The rest of a run of which `byte` is a token already. */
static size_t add_run(size_t run, unsigned char byte, uint16_t *token) {
  size_t tokens = 0;
  for (; run >= HK_RUN_SHORTEST; tokens++) {
    size_t here = run < HK_RUN_LONGEST ? run : HK_RUN_LONGEST;
    token[tokens] = (uint16_t)(256 - HK_RUN_SHORTEST + here);
    run -= here;
  }
  for (; run > 0; run--) token[tokens++] = byte;
  return tokens;
}

size_t hk_runs_find(const unsigned char *bytes, size_t count, uint16_t *token) {
  size_t tokens = 0, k = 0;
  while (k + 9 <= count) {
    unsigned alone = without_run(bytes + k);
    for (unsigned l = 0; l < 8; l++) token[tokens + l] = bytes[k + l]; /* those beyond `alone` are overwritten */
    tokens += alone, k += alone;
    if (alone == 6) continue;
    unsigned char byte = bytes[k++];
    size_t run = run_of(bytes + k, count - k, byte);
    token[tokens++] = byte;
    tokens += add_run(run, byte, token + tokens);
    k += run;
  }
  for (; k < count; k++) token[tokens++] = bytes[k];
  return tokens;
}

/* RFC 1951, 3.2.5: a symbol for the lengths from `base` on, which so many further bits tell apart. */
typedef struct run_symbol {
  unsigned symbol, bits, base;
} run_symbol;

static run_symbol symbol_of_run(unsigned length) {
  unsigned beyond = length - HK_RUN_SHORTEST, bits = 0;
  if (length == HK_RUN_LONGEST) return (run_symbol){FIRST_RUN + RUN_SYMBOLS - 1, 0, length};
  while (beyond >> bits >= 8) bits++; /* four symbols for each number of bits, the eight first ones have none */
  return (run_symbol){FIRST_RUN + 4 * bits + (beyond >> bits), bits, (beyond >> bits << bits) + HK_RUN_SHORTEST};
}

static unsigned symbol_of(unsigned token) {
  return token < 256 ? token : symbol_of_run(token - 256 + HK_RUN_SHORTEST).symbol;
}

/* ---- the code ---- */

typedef struct node {
  uint64_t count;
  int symbol, parent; /* of the parent its place */
} node;

static int by_count(const void *a, const void *b) {
  const node *x = a, *y = b;
  if (x->count != y->count) return x->count < y->count ? -1 : 1;
  return (x->symbol > y->symbol) - (x->symbol < y->symbol);
}

/* Joins the two rarest until one is left: `leaves` nodes, sorted, then room for as many. Returns the place of the root.
 */
static int join(node *n, int leaves) {
  int leaf = 0, inner = leaves, end = leaves;
  for (; end < 2 * leaves - 1; end++) {
    n[end] = (node){0, -1, -1};
    for (int k = 0; k < 2; k++) {
      bool take_leaf = leaf < leaves && (inner == end || n[leaf].count <= n[inner].count);
      int taken = take_leaf ? leaf++ : inner++;
      n[taken].parent = end;
      n[end].count += n[taken].count;
    }
  }
  return end - 1;
}

/* Lengths for the counts, of which two at least are not 0. False: one is too long. */
static bool lengths_of(const uint64_t counts[SYMBOLS], uint8_t length[SYMBOLS]) {
  node n[2 * SYMBOLS];
  int depth[2 * SYMBOLS] = {0}, leaves = 0;
  memset(length, 0, SYMBOLS);
  for (int s = 0; s < SYMBOLS; s++)
    if (counts[s]) n[leaves++] = (node){counts[s], s, -1};
  qsort(n, (size_t)leaves, sizeof *n, by_count);
  for (int k = join(n, leaves) - 1; k >= 0; k--) {
    depth[k] = depth[n[k].parent] + 1;
    if (k >= leaves) continue;
    if (depth[k] > LONGEST_CODE) return false;
    length[n[k].symbol] = (uint8_t)depth[k];
  }
  return true;
}

/* RFC 1951, 3.2.2; the first bit of a code is its highest one, so it is turned round. */
static void codes_of(const uint8_t length[SYMBOLS], uint16_t code[SYMBOLS]) {
  unsigned next = 0;
  for (unsigned bits = 1; bits <= LONGEST_CODE; bits++, next <<= 1)
    for (int s = 0; s < SYMBOLS; s++) {
      if (length[s] != bits) continue;
      unsigned turned = 0;
      for (unsigned b = 0; b < bits; b++) turned |= (next >> b & 1) << (bits - 1 - b);
      code[s] = (uint16_t)turned;
      next++;
    }
}

static void choose_code(const uint32_t of[HK_TOKENS], uint8_t length[SYMBOLS], uint16_t code[SYMBOLS]) {
  uint64_t counts[SYMBOLS] = {[END] = 1};
  for (unsigned t = 0; t < HK_TOKENS; t++) counts[symbol_of(t)] += of[t];
  while (!lengths_of(counts, length))
    for (int s = 0; s < SYMBOLS; s++) counts[s] = (counts[s] + 1) / 2;
  codes_of(length, code);
}

/* ---- a block ---- */

/* All lengths are of a code of 4 bits themselves; of distances there is one, 1, with a code of one bit. */
static void write_header(hk_bits *b, const uint8_t length[SYMBOLS], bool last) {
  hk_bits_add(b, last, 1);
  hk_bits_add(b, 2, 2);
  hk_bits_add(b, SYMBOLS - 257, 5);
  hk_bits_add(b, 0, 5);
  hk_bits_add(b, 15, 4);
  for (int k = 0; k < 19; k++) hk_bits_add(b, k < 3 ? 0 : 4, 3); /* the first three are of repetitions */
  for (int s = 0; s <= SYMBOLS; s++) {
    unsigned l = s < SYMBOLS ? length[s] : 1;
    hk_bits_add(b, (l & 1) << 3 | (l & 2) << 1 | (l & 4) >> 1 | (l & 8) >> 3, 4);
  }
}

/* How often each token is there, of even places and of odd ones: equal tokens one after the other wait for each other.
 */
static void count_tokens(const uint16_t *token, size_t count, uint32_t counts[HK_TOKENS]) {
  uint32_t odd[HK_TOKENS] = {0};
  size_t k = 0;
  for (; k + 2 <= count; k += 2) counts[token[k]]++, odd[token[k + 1]]++;
  if (k < count) counts[token[k]]++;
  for (unsigned t = 0; t < HK_TOKENS; t++) counts[t] += odd[t];
}

enum { CODE_BITS = 24 /* of an entry; its number of bits, at most 21, is above */ };

/* What each token is written as: its code, the bits of its length, and the distance, a bit of 0. */
static void fill_entries(const uint8_t length[SYMBOLS], const uint16_t code[SYMBOLS], uint32_t entry[HK_TOKENS]) {
  for (unsigned t = 0; t < HK_TOKENS; t++) {
    run_symbol s = t < 256 ? (run_symbol){t, 0, 0} : symbol_of_run(t - 256 + HK_RUN_SHORTEST);
    unsigned l = length[s.symbol], rest = t < 256 ? 0 : t - 256 + HK_RUN_SHORTEST - s.base;
    entry[t] = code[s.symbol] | rest << l | (l + s.bits + (t >= 256)) << CODE_BITS;
  }
}

/* 32 bits leave at a time. */
static void write_tokens(hk_bits *b, const uint16_t *token, size_t tokens, const uint32_t entry[HK_TOKENS]) {
  unsigned char *at = b->at;
  uint64_t held = b->held;
  unsigned count = b->count;
  for (size_t k = 0; k < tokens; k++) {
    uint32_t e = entry[token[k]];
    held |= (uint64_t)(e & ((1u << CODE_BITS) - 1)) << count;
    count += e >> CODE_BITS;
    if (count < 32) continue;
    at[0] = (unsigned char)held, at[1] = (unsigned char)(held >> 8);
    at[2] = (unsigned char)(held >> 16), at[3] = (unsigned char)(held >> 24);
    at += 4, held >>= 32, count -= 32;
  }
  *b = (hk_bits){at, held, count};
  hk_bits_add(b, 0, 0);
}

void hk_runs_write(hk_bits *b, const uint16_t *token, size_t count, bool last) {
  uint32_t counts[HK_TOKENS] = {0}, entry[HK_TOKENS];
  uint8_t length[SYMBOLS];
  uint16_t code[SYMBOLS];
  count_tokens(token, count, counts);
  choose_code(counts, length, code);
  write_header(b, length, last);
  fill_entries(length, code, entry);
  write_tokens(b, token, count, entry);
  hk_bits_add(b, code[END], length[END]);
}
