/* Morton 1966, "A computer oriented geodetic data base"; the cells from the sorted keys after Warren and Salmon 1993,
 * "A parallel hashed oct-tree N-body algorithm". */
#include "plugins/common/space/octree_builder.h"

#include <string.h>

enum { GRAIN = 4096, DIGIT = 11, DIGITS = 1 << DIGIT, KEY_BITS = 3 * HK_OCTREE_DEPTH, FEW = 48 };

hk_status hk_octree_reserve(hk_octree_builder *b, const hk_host *host, size_t n) {
  if (b->room && n <= b->room) return HK_OK;
  hk_octree_release(b);
  size_t room = n + n / 2 + 1;
  b->host = host;
  b->key = host->allocate(host, 2 * room * sizeof *b->key);
  b->order = host->allocate(host, 2 * room * sizeof *b->order);
  b->cell = host->allocate(host, 2 * room * sizeof *b->cell);
  b->spare_key = b->key ? b->key + room : NULL;
  b->spare = b->order ? b->order + room : NULL;
  if (!b->key || !b->order || !b->cell) {
    hk_octree_release(b);
    return HK_NO_MEMORY;
  }
  b->room = room;
  return HK_OK;
}

void hk_octree_release(hk_octree_builder *b) {
  if (!b->host) return;
  b->host->release(b->host, b->key < b->spare_key ? b->key : b->spare_key);
  b->host->release(b->host, b->order < b->spare ? b->order : b->spare);
  b->host->release(b->host, b->cell);
  *b = (hk_octree_builder){0};
}

/* ---- keys ---- */

typedef struct task {
  hk_octree_builder *b;
  const double *x;
  const uint32_t *list;
  size_t count;
  double low[3], cubes; /* 1/m, smallest cubes per length */
} task;

static size_t particle(const task *t, size_t k) { return t->list ? t->list[k] : k; }

static bool measure(task *t, uint32_t *flawed) {
  double high[3], side = 0;
  for (size_t c = 0; c < 3; c++) t->low[c] = INFINITY, high[c] = -INFINITY;
  for (size_t k = 0; k < t->count; k++)
    for (size_t c = 0; c < 3; c++) {
      double x = t->x[3 * particle(t, k) + c];
      *flawed = (uint32_t)particle(t, k);
      if (!isfinite(x)) return false;
      if (x < t->low[c]) t->low[c] = x;
      if (x > high[c]) high[c] = x;
    }
  for (size_t c = 0; c < 3; c++) side = fmax(side, high[c] - t->low[c]);
  t->cubes = side > 0 && isfinite((1 << HK_OCTREE_DEPTH) / side) ? (1 << HK_OCTREE_DEPTH) / side : 0;
  return true;
}

/* The bits of a number of 21 bits, each third place. */
static uint64_t spread(uint64_t v) {
  v = (v | v << 32) & 0x1f00000000ffff;
  v = (v | v << 16) & 0x1f0000ff0000ff;
  v = (v | v << 8) & 0x100f00f00f00f00f;
  v = (v | v << 4) & 0x10c30c30c30c30c3;
  return (v | v << 2) & 0x1249249249249249;
}

static void key_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    uint64_t key = 0;
    for (size_t c = 0; c < 3; c++) {
      double at = (t->x[3 * particle(t, k) + c] - t->low[c]) * t->cubes;
      uint64_t cube = at < (1 << HK_OCTREE_DEPTH) - 1 ? (uint64_t)at : (1 << HK_OCTREE_DEPTH) - 1;
      key = key << 1 | spread(cube);
    }
    t->b->key[k] = key;
    t->b->order[k] = (uint32_t)particle(t, k);
  }
}

/* ---- radix sort, by digits from the lowest ---- */

static void swap(hk_octree_builder *b) {
  uint64_t *key = b->key;
  uint32_t *order = b->order;
  b->key = b->spare_key, b->spare_key = key;
  b->order = b->spare, b->spare = order;
}

static void sort_by_digit(hk_octree_builder *b, size_t count, unsigned shift) {
  uint32_t place[DIGITS] = {0}, sum = 0;
  for (size_t k = 0; k < count; k++) place[b->key[k] >> shift & (DIGITS - 1)]++;
  if (place[b->key[0] >> shift & (DIGITS - 1)] == count) return;
  for (size_t v = 0; v < DIGITS; v++) {
    uint32_t here = place[v];
    place[v] = sum;
    sum += here;
  }
  for (size_t k = 0; k < count; k++) {
    uint32_t to = place[b->key[k] >> shift & (DIGITS - 1)]++;
    b->spare_key[to] = b->key[k];
    b->spare[to] = b->order[k];
  }
  swap(b);
}

/* Of a few points, where the digits' counts would take longer: in the same order, as both keep that of equal keys. */
static void sort_few(hk_octree_builder *b, size_t count) {
  for (size_t k = 1; k < count; k++) {
    uint64_t key = b->key[k];
    uint32_t point = b->order[k];
    size_t to = k;
    for (; to > 0 && b->key[to - 1] > key; to--) {
      b->key[to] = b->key[to - 1];
      b->order[to] = b->order[to - 1];
    }
    b->key[to] = key;
    b->order[to] = point;
  }
}

static void sort(hk_octree_builder *b, size_t count) {
  if (count <= FEW) {
    sort_few(b, count);
    return;
  }
  for (unsigned shift = 0; shift < KEY_BITS && count > 1; shift += DIGIT) sort_by_digit(b, count, shift);
}

/* ---- cells ---- */

typedef struct growth {
  const hk_octree_builder *b;
  const double *x;
  size_t cells;
} growth;

static void box_points(const growth *g, hk_octree_cell *cell) {
  for (size_t c = 0; c < 3; c++) cell->low[c] = INFINITY, cell->high[c] = -INFINITY;
  for (size_t k = cell->begin; k < (size_t)cell->begin + cell->count; k++) {
    const double *x = g->x + 3 * (size_t)g->b->order[k];
    for (size_t c = 0; c < 3; c++) {
      if (x[c] < cell->low[c]) cell->low[c] = x[c];
      if (x[c] > cell->high[c]) cell->high[c] = x[c];
    }
  }
}

static void box_parts(const growth *g, hk_octree_cell *cell, size_t first) {
  for (size_t c = 0; c < 3; c++) cell->low[c] = INFINITY, cell->high[c] = -INFINITY;
  for (size_t k = first; k < g->cells; k = g->b->cell[k].next)
    for (size_t c = 0; c < 3; c++) {
      if (g->b->cell[k].low[c] < cell->low[c]) cell->low[c] = g->b->cell[k].low[c];
      if (g->b->cell[k].high[c] > cell->high[c]) cell->high[c] = g->b->cell[k].high[c];
    }
}

/* The end of those in [begin, end) that have the first one's key above `shift`. */
static size_t end_of_part(const uint64_t *key, size_t begin, size_t end, unsigned shift) {
  uint64_t value = key[begin] >> shift;
  while (begin + 1 < end) {
    size_t middle = begin + (end - begin) / 2;
    if (key[middle] >> shift == value)
      begin = middle;
    else
      end = middle;
  }
  return begin + 1;
}

/* A cell is cut at the first level where its keys differ; recursion is at most HK_OCTREE_DEPTH deep. */
static void grow(growth *g, size_t begin, size_t end) {
  const uint64_t *key = g->b->key;
  size_t index = g->cells++;
  hk_octree_cell *cell = g->b->cell + index;
  cell->begin = (uint32_t)begin;
  cell->count = (uint32_t)(end - begin);
  uint64_t differ = key[begin] ^ key[end - 1];
  if (cell->count <= HK_OCTREE_LEAF || differ == 0) {
    box_points(g, cell);
  } else {
    unsigned shift = (unsigned)(63 - __builtin_clzll(differ)) / 3 * 3;
    for (size_t at = begin; at < end;) {
      size_t until = end_of_part(key, at, end, shift);
      grow(g, at, until);
      at = until;
    }
    box_parts(g, cell, index + 1);
  }
  cell->next = (uint32_t)g->cells;
}

bool hk_octree_build(hk_octree_builder *b, const double *x, const uint32_t *list, size_t count, hk_octree *tree,
                     uint32_t *flawed) {
  task t = {.b = b, .x = x, .list = list, .count = count};
  growth g = {.b = b, .x = x};
  if (!measure(&t, flawed)) return false;
  b->host->parallel_for(b->host, count, GRAIN, key_chunk, &t);
  sort(b, count);
  if (count) grow(&g, 0, count);
  *tree = (hk_octree){count, g.cells, b->order, b->cell};
  return true;
}
