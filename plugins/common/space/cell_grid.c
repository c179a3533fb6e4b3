/* The number of a cell and the sort by it: a stable radix sort, of which several threads count and move parts. */
#include "plugins/common/space/cell_grid.h"

#include <string.h>

enum {
  GRAIN = 512,
  PART = 1 << 15, /* points of one part of the sort, which one thread counts and moves */
  DIGIT = 11,
  VALUES = 1 << DIGIT
};

/* Cell numbers are below 2^31, so the rounding of a coordinate in units of cells is below 2^-21 and less than the
 * widening: two points closer than the reach are never two cells apart. */
static const double widening = 1 + 0x1p-16, narrowest = 0x1p-31, least_width = 1e-290;

/* ---- memory ---- */

void hk_cell_order_free(hk_cell_order *o, const hk_host *host) {
  void *memory[] = {o->key, o->point, o->spare_key, o->spare, o->tally, o->extent};
  for (size_t k = 0; k < sizeof memory / sizeof *memory; k++) host->release(host, memory[k]);
  *o = (hk_cell_order){0};
}

static size_t parts_of(size_t n) { return n / PART + 1; }

bool hk_cell_order_reserve(hk_cell_order *o, const hk_host *host, size_t n) {
  hk_cell_order_free(o, host);
  o->room = n;
  o->key = host->allocate(host, n * sizeof *o->key);
  o->point = host->allocate(host, n * sizeof *o->point);
  o->spare_key = host->allocate(host, n * sizeof *o->spare_key);
  o->spare = host->allocate(host, n * sizeof *o->spare);
  o->tally = host->allocate(host, parts_of(n) * VALUES * sizeof *o->tally);
  o->extent = host->allocate(host, parts_of(n) * sizeof *o->extent);
  return o->key && o->point && o->spare_key && o->spare && o->tally && o->extent;
}

/* ---- cells ---- */

typedef struct task {
  hk_cell_order *order;
  const double *x;
  size_t n;
  hk_cell_grid grid;
  unsigned digit_shift; /* of the present pass of the sort */
} task;

static void bound_chunk(void *context, size_t begin, size_t end, size_t part) {
  const task *t = context;
  double low[3], high[3];
  for (size_t c = 0; c < 3; c++) low[c] = high[c] = t->x[3 * begin + c];
  for (size_t i = begin + 1; i < end; i++)
    for (size_t c = 0; c < 3; c++) {
      double at = t->x[3 * i + c];
      low[c] = at < low[c] ? at : low[c];
      high[c] = at > high[c] ? at : high[c];
    }
  memcpy(t->order->extent[part], low, sizeof low);
  memcpy(t->order->extent[part] + 3, high, sizeof high);
}

/* A power of two from 2n to 4n. */
static size_t hashed_cells(size_t n) {
  size_t cells = 4;
  while (cells < 2 * n) cells *= 2;
  return cells;
}

/* The multipliers of the hash are the first digits of the golden ratio and of pi, odd. */
static void number_cells(hk_cell_grid *g, size_t n, const double high[3]) {
  uint64_t count[3];
  for (size_t c = 0; c < 3; c++) count[c] = hk_cell_along(g, high[c], c) + (uint64_t)2;
  double all = (double)count[0] * (double)count[1] * (double)count[2];
  if (all <= HK_CELLS_PER_POINT * (double)n) {
    g->per_y = count[0];
    g->per_z = count[0] * count[1];
    g->cells = g->per_z * count[2];
    return;
  }
  g->cells = hashed_cells(n);
  g->per_y = 0x9e3779b97f4a7c15u;
  g->per_z = 0x243f6a8885a308d3u;
  for (g->shift = 64; (uint64_t)1 << (64 - g->shift) < g->cells;) g->shift--;
}

static void choose_cells(task *t, const hk_host *host, double reach) {
  double high[3], extent = 0;
  host->parallel_for(host, t->n, PART, bound_chunk, t);
  for (size_t c = 0; c < 3; c++) {
    double low = INFINITY;
    high[c] = -INFINITY;
    for (size_t p = 0; p * PART < t->n; p++) {
      low = fmin(low, t->order->extent[p][c]);
      high[c] = fmax(high[c], t->order->extent[p][3 + c]);
    }
    t->grid.low[c] = low / 2;
    extent = fmax(extent, high[c] / 2 - low / 2);
  }
  t->grid.width = fmax(fmax(reach / 2 * widening, extent * narrowest), least_width);
  number_cells(&t->grid, t->n, high);
}

static void number_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const task *t = context;
  const hk_cell_grid *g = &t->grid;
  (void)chunk;
  for (size_t i = begin; i < end; i++) {
    const double *at = t->x + 3 * i;
    size_t lane = hk_cell_lane(g, hk_cell_along(g, at[1], 1), hk_cell_along(g, at[2], 2));
    t->order->key[i] = (uint32_t)hk_cell_number(g, lane, hk_cell_along(g, at[0], 0));
    t->order->point[i] = (uint32_t)i;
  }
}

/* ---- the sort ---- */

static size_t digit_of(const task *t, uint32_t key) { return key >> t->digit_shift & (VALUES - 1); }

static void tally_chunk(void *context, size_t begin, size_t end, size_t part) {
  const task *t = context;
  uint32_t *tally = t->order->tally + part * VALUES;
  memset(tally, 0, VALUES * sizeof *tally);
  for (size_t k = begin; k < end; k++) tally[digit_of(t, t->order->key[k])]++;
}

static void move_chunk(void *context, size_t begin, size_t end, size_t part) {
  const task *t = context;
  const hk_cell_order *o = t->order;
  uint32_t *place = o->tally + part * VALUES;
  for (size_t k = begin; k < end; k++) {
    size_t to = place[digit_of(t, o->key[k])]++;
    o->spare_key[to] = o->key[k];
    o->spare[to] = o->point[k];
  }
}

static void swap(uint32_t **a, uint32_t **b) {
  uint32_t *kept = *a;
  *a = *b;
  *b = kept;
}

/* One pass of the radix sort, by DIGIT bits; it is stable, so the parts leave no trace. */
static void sort_by_digit(task *t, const hk_host *host) {
  hk_cell_order *o = t->order;
  uint32_t sum = 0;
  host->parallel_for(host, t->n, PART, tally_chunk, t);
  for (size_t v = 0; v < VALUES; v++)
    for (size_t p = 0; p * PART < t->n; p++) {
      uint32_t count = o->tally[p * VALUES + v];
      o->tally[p * VALUES + v] = sum;
      sum += count;
    }
  host->parallel_for(host, t->n, PART, move_chunk, t);
  swap(&o->key, &o->spare_key);
  swap(&o->point, &o->spare);
}

hk_cell_grid hk_cell_order_make(hk_cell_order *o, const hk_host *host, const double *x, size_t n, double reach) {
  task t = {.order = o, .x = x, .n = n};
  choose_cells(&t, host, reach);
  host->parallel_for(host, n, GRAIN, number_chunk, &t);
  for (; t.grid.cells >> t.digit_shift; t.digit_shift += DIGIT) sort_by_digit(&t, host);
  return t.grid;
}
