/* Cell lists (Hockney and Eastwood 1981, section 8.4) on points in the order of their cells (cell_grid.h), where the 27
 * cells around a point are nine contiguous parts. Rows are counted, placed by a prefix sum in the order of points,
 * filled and sorted. Every pair is decided by its distance and every point is met once, so the result depends neither
 * on threads nor on the order of points in space. */
#include "plugins/common/space/cell_list.h"

#include <string.h>

enum {
  GRAIN = 512,
  LANES = 9,
  PIECES = 2 * LANES, /* a lane that passes the end of the table is two */
  CANDIDATES = 2048,
  FEW = 256, /* pairs that there is always room for */
  CROWD = 4  /* points of a cell from which on sorting its candidates once is cheaper than sorting every row */
};

/* ---- memory ---- */

void hk_cell_list_free(hk_cell_list *l, const hk_host *host) {
  void *memory[] = {l->row_start, l->other, l->cell_begin, l->at};
  for (size_t k = 0; k < sizeof memory / sizeof *memory; k++) host->release(host, memory[k]);
  hk_cell_order_free(&l->order, host);
  *l = (hk_cell_list){0};
}

static hk_status no_memory(hk_cell_list *l, const hk_host *host, size_t count, const char *what) {
  hk_cell_list_free(l, host);
  return host->fail(host, HK_NO_MEMORY, "no memory for the neighbours of %zu %s", count, what);
}

hk_status hk_cell_list_reserve(hk_cell_list *l, const hk_host *host, size_t n) {
  if (l->row_start && n <= l->room) return HK_OK;
  size_t room = l->room + l->room / 2;
  if (room < n) room = n;
  hk_cell_list_free(l, host);
  l->room = room;
  l->row_start = host->allocate(host, (room + 1) * sizeof *l->row_start);
  l->cell_begin = host->allocate(host, (HK_CELLS_PER_POINT * room + 5) * sizeof *l->cell_begin);
  l->at = host->allocate(host, 3 * room * sizeof *l->at);
  bool fine = hk_cell_order_reserve(&l->order, host, room) && l->row_start && l->cell_begin && l->at;
  return fine ? HK_OK : no_memory(l, host, n, "particles");
}

static hk_status reserve_pairs(hk_cell_list *l, const hk_host *host, size_t pairs) {
  if (pairs <= l->pairs) return HK_OK;
  size_t room = l->pairs + l->pairs / 2;
  if (room < pairs) room = pairs;
  if (room < FEW) room = FEW;
  host->release(host, l->other);
  l->other = room < SIZE_MAX / sizeof *l->other ? host->allocate(host, room * sizeof *l->other) : NULL;
  l->pairs = room;
  return l->other ? HK_OK : no_memory(l, host, pairs, "pairs of particles (a smaller radius has fewer)");
}

typedef struct build {
  hk_cell_list *list;
  const double *x;
  size_t n, rows; /* points; those that have rows */
  hk_cell_grid grid;
  double reach2; /* m^2 */
} build;

/* Coordinates in the order of the list, and where cells begin: those up to a point's own that no point before it set.
 */
static void gather_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const build *b = context;
  hk_cell_list *l = b->list;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    for (size_t c = 0; c < 3; c++) l->at[c * b->n + k] = b->x[3 * (size_t)l->order.point[k] + c];
    for (size_t cell = k ? (size_t)l->order.key[k - 1] + 1 : 0; cell <= l->order.key[k]; cell++)
      l->cell_begin[cell] = (uint32_t)k;
  }
  for (size_t cell = (size_t)l->order.key[end - 1] + 1; end == b->n && cell <= b->grid.cells; cell++)
    l->cell_begin[cell] = (uint32_t)b->n;
}

/* ---- rows ---- */

/* The parts of the list that hold the neighbours of one cell. */
typedef struct surroundings {
  int count;
  size_t begin[PIECES], end[PIECES], points;
} surroundings;

static void swap_numbers(size_t *a, size_t *b) {
  size_t kept = *a;
  *a = *b;
  *b = kept;
}

static void add_piece(const build *b, surroundings *around, size_t cell, size_t cells) {
  size_t begin = b->list->cell_begin[cell], end = b->list->cell_begin[cell + cells];
  if (begin == end) return;
  around->begin[around->count] = begin;
  around->end[around->count++] = end;
  around->points += end - begin;
}

/* Lanes that begin at a hash may overlap: their pieces by rising begin, those that overlap as one. */
static void merge_pieces(surroundings *around) {
  int last = -1;
  for (int p = 1; p < around->count; p++)
    for (int q = p; q > 0 && around->begin[q] < around->begin[q - 1]; q--) {
      swap_numbers(&around->begin[q], &around->begin[q - 1]);
      swap_numbers(&around->end[q], &around->end[q - 1]);
    }
  for (int p = 0; p < around->count; p++) {
    size_t begin = around->begin[p], end = around->end[p];
    bool apart = last < 0 || begin >= around->end[last];
    if (apart) around->begin[++last] = begin;
    if (apart || end > around->end[last]) around->end[last] = end;
  }
  around->count = last + 1;
}

/* Around the cell of point k of the list. */
static void look_around(const build *b, size_t k, surroundings *around) {
  const double *at = b->list->at + k;
  uint64_t x = hk_cell_along(&b->grid, at[0], 0), y = hk_cell_along(&b->grid, at[b->n], 1),
           z = hk_cell_along(&b->grid, at[2 * b->n], 2);
  around->count = 0, around->points = 0;
  for (uint64_t p = 0; p < LANES; p++) {
    size_t first = hk_cell_number(&b->grid, hk_cell_lane(&b->grid, y + p % 3 - 1, z + p / 3 - 1), x - 1);
    size_t whole = b->grid.cells - first < 3 ? b->grid.cells - first : 3;
    add_piece(b, around, first, whole);
    if (whole < 3) add_piece(b, around, 0, 3 - whole);
  }
  if (b->grid.shift) merge_pieces(around);
}

static bool same_cell(const build *b, size_t j, size_t k) {
  const double *x = b->list->at, *y = x + b->n, *z = y + b->n;
  return b->list->order.key[j] == b->list->order.key[k] &&
         (!b->grid.shift || (hk_cell_along(&b->grid, x[j], 0) == hk_cell_along(&b->grid, x[k], 0) &&
                             hk_cell_along(&b->grid, y[j], 1) == hk_cell_along(&b->grid, y[k], 1) &&
                             hk_cell_along(&b->grid, z[j], 2) == hk_cell_along(&b->grid, z[k], 2)));
}

/* Squared distance, m^2, of two points given by their positions in the sorted list. */
static double distance2(const build *b, size_t j, size_t k) {
  const double *x = b->list->at, *y = x + b->n, *z = y + b->n;
  double dx = x[j] - x[k], dy = y[j] - y[k], dz = z[j] - z[k];
  return dx * dx + dy * dy + dz * dz;
}

typedef double two_numbers __attribute__((vector_size(16)));
typedef int64_t two_flags __attribute__((vector_size(16)));

static two_numbers less(const double *from, double what) {
  two_numbers both;
  memcpy(&both, from, sizeof both);
  return both - what;
}

/* Compares two points at a time; a flag is -1 where the comparison is true. */
static size_t count_piece(const build *b, size_t k, size_t begin, size_t end) {
  const double *x = b->list->at, *y = x + b->n, *z = y + b->n;
  two_flags flags = {0};
  size_t j = begin, count = 0;
  for (; j + 2 <= end; j += 2) {
    two_numbers dx = less(x + j, x[k]), dy = less(y + j, y[k]), dz = less(z + j, z[k]);
    flags += dx * dx + dy * dy + dz * dz < b->reach2;
  }
  if (j < end) count = distance2(b, j, k) < b->reach2;
  return count - (size_t)flags[0] - (size_t)flags[1];
}

static void count_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const build *b = context;
  surroundings around;
  size_t looked = SIZE_MAX; /* the last point with a row */
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    size_t count = 0;
    if (b->list->order.point[k] >= b->rows) continue;
    if (looked == SIZE_MAX || !same_cell(b, k, looked)) look_around(b, k, &around);
    looked = k;
    for (int p = 0; p < around.count; p++) count += count_piece(b, k, around.begin[p], around.end[p]);
    b->list->row_start[b->list->order.point[k] + 1] = count - 1; /* without the point itself */
  }
}

/* Shell's sort with Ciura's gaps (2001), for lists that are short or consist of sorted parts. */
static void sort_short(uint32_t *list, size_t count) {
  static const size_t gaps[] = {701, 301, 132, 57, 23, 10, 4, 1};
  for (size_t g = 0; g < sizeof gaps / sizeof *gaps; g++)
    for (size_t gap = gaps[g], k = gap; k < count; k++) {
      uint32_t value = list[k];
      size_t at = k;
      for (; at >= gap && list[at - gap] > value; at -= gap) list[at] = list[at - gap];
      list[at] = value;
    }
}

/* Radix sort by bytes from the lowest; all values are below n. */
static void sort_long(uint32_t *list, size_t count, size_t n) {
  uint32_t spare[CANDIDATES], *from = list, *to = spare;
  for (unsigned shift = 0; (n - 1) >> shift; shift += 8) {
    uint32_t place[256] = {0}, sum = 0, *swap = from;
    for (size_t k = 0; k < count; k++) place[from[k] >> shift & 255]++;
    for (size_t v = 0; v < 256; v++) {
      uint32_t here = place[v];
      place[v] = sum;
      sum += here;
    }
    for (size_t k = 0; k < count; k++) to[place[from[k] >> shift & 255]++] = from[k];
    from = to;
    to = swap;
  }
  if (from != list) memcpy(list, from, count * sizeof *list);
}

/* The points of the 27 cells by rising index, collected once for all points of the central cell. */
typedef struct candidates {
  size_t count; /* 0: they are few points' or more than fit */
  uint32_t point[CANDIDATES];
  double x[CANDIDATES], y[CANDIDATES], z[CANDIDATES];
} candidates;

static void gather_candidates(const build *b, const surroundings *around, candidates *c) {
  c->count = 0;
  for (int p = 0; p < around->count; c->count += around->end[p] - around->begin[p], p++)
    memcpy(c->point + c->count, b->list->order.point + around->begin[p],
           (around->end[p] - around->begin[p]) * sizeof *c->point);
  if (c->count > 128) /* above this length the radix sort is faster */
    sort_long(c->point, c->count, b->n);
  else
    sort_short(c->point, c->count);
  for (size_t k = 0; k < c->count; k++) {
    const double *x = b->x + 3 * (size_t)c->point[k];
    c->x[k] = x[0], c->y[k] = x[1], c->z[k] = x[2];
  }
}

/* Without a branch: a point that is too far is overwritten by the next one. */
static void choose_row(const build *b, const candidates *c, size_t i) {
  uint32_t row[CANDIDATES + 1];
  double px = b->x[3 * i], py = b->x[3 * i + 1], pz = b->x[3 * i + 2], reach2 = b->reach2;
  size_t count = 0;
  for (size_t k = 0; k < c->count; k++) {
    double dx = c->x[k] - px, dy = c->y[k] - py, dz = c->z[k] - pz;
    row[count] = c->point[k];
    count += (size_t)(dx * dx + dy * dy + dz * dz < reach2) & (size_t)(c->point[k] != i);
  }
  memcpy(b->list->other + b->list->row_start[i], row, count * sizeof *row);
}

/* The row of a point that shares its candidates with few: chosen in the same way, then sorted. */
static void sort_row(const build *b, const surroundings *around, size_t k) {
  uint32_t row[CANDIDATES + 1];
  const uint32_t *order = b->list->order.point;
  size_t count = 0;
  for (int p = 0; p < around->count; p++)
    for (size_t j = around->begin[p]; j < around->end[p]; j++) {
      row[count] = order[j];
      count += (size_t)(distance2(b, j, k) < b->reach2) & (size_t)(j != k);
    }
  uint32_t *to = b->list->other + b->list->row_start[order[k]];
  memcpy(to, row, count * sizeof *row);
  sort_short(to, count);
}

/* For more points than CANDIDATES: collected part by part, then sorted. */
static void collect_row(const build *b, const surroundings *around, size_t k) {
  uint32_t *row = b->list->other + b->list->row_start[b->list->order.point[k]], *into = row;
  for (int p = 0; p < around->count; p++)
    for (size_t j = around->begin[p]; j < around->end[p]; j++)
      if (j != k && distance2(b, j, k) < b->reach2) *into++ = b->list->order.point[j];
  sort_short(row, (size_t)(into - row));
}

static bool crowded(const build *b, size_t k) {
  const uint32_t *begin = b->list->cell_begin + b->list->order.key[k];
  return begin[1] - begin[0] >= CROWD;
}

static void fill_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const build *b = context;
  surroundings around;
  candidates near;
  size_t looked = SIZE_MAX;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    if (b->list->order.point[k] >= b->rows) continue;
    bool known = looked != SIZE_MAX && same_cell(b, k, looked);
    looked = k;
    if (!known) {
      look_around(b, k, &around);
      near.count = 0;
      if (crowded(b, k) && around.points <= CANDIDATES) gather_candidates(b, &around, &near);
    }
    if (near.count)
      choose_row(b, &near, b->list->order.point[k]);
    else if (around.points <= CANDIDATES)
      sort_row(b, &around, k);
    else
      collect_row(b, &around, k);
  }
}

static void find_rows(build *b, const hk_host *host, double reach) {
  size_t *row_start = b->list->row_start;
  b->grid = hk_cell_order_make(&b->list->order, host, b->x, b->n, reach);
  host->parallel_for(host, b->n, GRAIN, gather_chunk, b);
  host->parallel_for(host, b->n, GRAIN, count_chunk, b);
  for (size_t i = 0; i < b->n; i++) row_start[i + 1] += row_start[i];
}

hk_status hk_cell_list_build(hk_cell_list *l, const hk_host *host, const double *x, size_t n, double reach) {
  return hk_cell_list_build_first(l, host, x, n, n, reach);
}

hk_status hk_cell_list_build_first(hk_cell_list *l, const hk_host *host, const double *x, size_t n, size_t rows,
                                   double reach) {
  build b = {.list = l, .x = x, .n = n, .rows = rows, .reach2 = reach * reach};
  l->n = 0;
  hk_status status = hk_cell_list_reserve(l, host, n);
  if (status != HK_OK) return status;
  memset(l->row_start, 0, (n + 1) * sizeof *l->row_start);
  if (n > 1 && reach > 0) {
    find_rows(&b, host, reach);
    status = reserve_pairs(l, host, l->row_start[n]);
    if (status != HK_OK) return status;
    if (l->row_start[n]) host->parallel_for(host, n, GRAIN, fill_chunk, &b);
  }
  l->n = n;
  return HK_OK;
}
