#include "plugins/common/film/run_coder.h"

#include <stdlib.h>
#include <string.h>

enum { SHORTEST_RUN = 3, END = 256, NODES = 2 * HK_LITERALS };

/* A Huffman tree as deep as 16 has a weight of at least Fibonacci's number 18, 2584: with less, no code is longer than
 * deflate allows. One is every symbol's own, so that rows outside of the sample can be written. */
enum { WEIGHT = 2583 - HK_LITERALS };

/* ---- runs ---- */

/* How many bytes from `at` on are the same as the one before it. */
static size_t run_at(const uint8_t *at, const uint8_t *end) {
  const uint8_t *from = at;
  uint64_t same = at[-1] * UINT64_C(0x0101010101010101), next;
  for (; end - at >= 8; at += 8) {
    memcpy(&next, at, sizeof next);
    if (next != same) break;
  }
  while (at < end && *at == at[-1]) at++;
  return (size_t)(at - from);
}

/* Symbol, extra bits and their number of a run: RFC 1951, 3.2.5. */
static unsigned symbol_of(unsigned length, unsigned *extra, unsigned *bits) {
  *extra = *bits = 0;
  if (length == HK_LONGEST_RUN) return 285;
  unsigned above = length - SHORTEST_RUN;
  if (above < 8) return 257 + above;
  while (above >> (*bits + 3)) ++*bits;
  unsigned group = above >> *bits; /* 4 to 7 */
  *extra = above & ((1u << *bits) - 1);
  return 257 + 4 * *bits + group;
}

static size_t cut(size_t run) { return run < HK_LONGEST_RUN ? run : HK_LONGEST_RUN; }

void hk_run_coder_sample(hk_run_coder *c, const uint8_t *row, size_t bytes) {
  const uint8_t *end = row + bytes;
  for (const uint8_t *at = row; at < end;) {
    size_t run = at > row ? cut(run_at(at, end)) : 0;
    unsigned extra, bits;
    c->count[run >= SHORTEST_RUN ? symbol_of((unsigned)run, &extra, &bits) : *at]++;
    at += run >= SHORTEST_RUN ? run : 1;
  }
}

/* ---- the code ---- */

typedef struct node {
  uint32_t weight;
  uint16_t symbol, parent;
} node;

static int by_weight(const void *a, const void *b) {
  const node *p = a, *q = b;
  if (p->weight != q->weight) return p->weight < q->weight ? -1 : 1;
  return (p->symbol > q->symbol) - (p->symbol < q->symbol);
}

/* Huffman's algorithm on leaves in the order of their weight: the inner nodes are made in that order, too. */
static void choose_lengths(hk_run_coder *c) {
  node n[NODES];
  uint64_t sum = 1;
  for (int k = 0; k < HK_LITERALS; k++) sum += c->count[k];
  for (int k = 0; k < HK_LITERALS; k++)
    n[k] = (node){1 + (uint32_t)(c->count[k] * (uint64_t)WEIGHT / sum), (uint16_t)k, 0};
  qsort(n, HK_LITERALS, sizeof *n, by_weight);
  int leaf = 0, inner = HK_LITERALS, last = 2 * HK_LITERALS - 2;
  for (int made = HK_LITERALS; made <= last; made++) {
    n[made] = (node){0};
    for (int k = 0; k < 2; k++) {
      bool take_leaf = leaf < HK_LITERALS && (inner == made || n[leaf].weight <= n[inner].weight);
      node *least = n + (take_leaf ? leaf++ : inner++);
      least->parent = (uint16_t)made;
      n[made].weight += least->weight;
    }
  }
  uint8_t depth[NODES] = {0};
  for (int k = last - 1; k >= 0; k--) depth[k] = (uint8_t)(depth[n[k].parent] + 1);
  for (int k = 0; k < HK_LITERALS; k++) c->length[n[k].symbol] = depth[k];
}

static unsigned reversed(unsigned code, unsigned bits) {
  unsigned out = 0;
  for (unsigned k = 0; k < bits; k++) out |= (code >> k & 1) << (bits - 1 - k);
  return out;
}

/* The canonical code of these lengths: RFC 1951, 3.2.2. */
static void choose_codes(hk_run_coder *c) {
  unsigned next = 0;
  for (unsigned bits = 1; bits <= HK_LONGEST_CODE; bits++, next <<= 1)
    for (int k = 0; k < HK_LITERALS; k++)
      if (c->length[k] == bits) c->code[k] = (uint16_t)reversed(next++, bits);
}

/* Length and distance in one: the distance's only code is one bit, 0. */
static void choose_runs(hk_run_coder *c) {
  for (unsigned length = SHORTEST_RUN; length <= HK_LONGEST_RUN; length++) {
    unsigned extra, bits, symbol = symbol_of(length, &extra, &bits);
    c->run[length] = c->code[symbol] | extra << c->length[symbol];
    c->run_bits[length] = c->length[symbol] + bits + 1;
  }
}

/* ---- bits ---- */

/* At most 32 bits, of which at most 31 wait. */
static inline uint8_t *put(hk_run_coder *c, uint32_t value, unsigned bits, uint8_t *out) {
  c->bits |= (uint64_t)value << c->waiting;
  c->waiting += bits;
  if (c->waiting < 32) return out;
  for (int k = 0; k < 4; k++) out[k] = (uint8_t)(c->bits >> 8 * k);
  c->bits >>= 32, c->waiting -= 32;
  return out + 4;
}

uint8_t *hk_run_coder_begin(hk_run_coder *c, uint8_t *out) {
  static const uint8_t order[] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
  choose_lengths(c);
  choose_codes(c);
  choose_runs(c);
  c->bits = c->waiting = 0;
  out = put(c, 1, 1, out); /* the last block, */
  out = put(c, 2, 2, out); /* with codes of its own */
  out = put(c, HK_LITERALS - 257, 5, out);
  out = put(c, 0, 5, out); /* one code of distances */
  out = put(c, sizeof order - 4, 4, out);
  for (size_t k = 0; k < sizeof order; k++) out = put(c, order[k] < 16 ? 4 : 0, 3, out); /* lengths are 4 bits each */
  for (int k = 0; k < HK_LITERALS; k++) out = put(c, reversed(c->length[k], 4), 4, out);
  return put(c, reversed(1, 4), 4, out); /* of the distance */
}

uint8_t *hk_run_coder_row(hk_run_coder *c, const uint8_t *row, size_t bytes, uint8_t *out) {
  const uint8_t *end = row + bytes;
  for (const uint8_t *at = row; at < end;) {
    size_t run = at > row && *at == at[-1] ? cut(run_at(at, end)) : 0;
    if (run >= SHORTEST_RUN) {
      out = put(c, c->run[run], c->run_bits[run], out);
      at += run;
    } else {
      out = put(c, c->code[*at], c->length[*at], out);
      at++;
    }
  }
  return out;
}

uint8_t *hk_run_coder_end(hk_run_coder *c, uint8_t *out) {
  out = put(c, c->code[END], c->length[END], out);
  for (; c->waiting > 0; c->waiting -= c->waiting < 8 ? c->waiting : 8, c->bits >>= 8) *out++ = (uint8_t)c->bits;
  return out;
}
