/* Cell lists (Hockney and Eastwood 1981, section 8.4) on sorted points. Cells are slightly wider than the reach, so
 * that all neighbours of a point lie in the 27 cells around it. Points are numbered by cell along each axis and sorted
 * by (z, y, x) with a radix sort; the cells of one z and y are then one contiguous part of the list, called a lane, and
 * the 27 cells are nine parts, whose ends only move forward while the list is traversed. Rows are counted, placed by a
 * prefix sum in the order of points, filled and sorted, so the result depends neither on threads nor on the order of
 * points in space. */
#include "plugins/common/space/cell_list.h"

#include <string.h>

enum { GRAIN = 512, LANES = 9, DIGIT = 11, VALUES = 1 << DIGIT, CANDIDATES = 2048 };

/* Cell numbers are below 2^31, so the rounding of a coordinate in units of cells is below 2^-21 and less than the
 * widening: two points closer than the reach are never two cells apart. */
static const double widening = 1 + 0x1p-16, narrowest = 0x1p-31, least_width = 1e-290;

/* ---- memory ---- */

void hk_cell_list_free(hk_cell_list *l, const hk_host *host) {
  void *memory[] = {l->row_start, l->other, l->number, l->order, l->spare, l->lane, l->column, l->at};
  for (size_t k = 0; k < sizeof memory / sizeof *memory; k++) host->release(host, memory[k]);
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
  l->number = host->allocate(host, 3 * room * sizeof *l->number);
  l->order = host->allocate(host, room * sizeof *l->order);
  l->spare = host->allocate(host, room * sizeof *l->spare);
  l->lane = host->allocate(host, room * sizeof *l->lane);
  l->column = host->allocate(host, room * sizeof *l->column);
  l->at = host->allocate(host, 3 * room * sizeof *l->at);
  bool fine = l->row_start && l->number && l->order && l->spare && l->lane && l->column && l->at;
  return fine ? HK_OK : no_memory(l, host, n, "particles");
}

static hk_status reserve_pairs(hk_cell_list *l, const hk_host *host, size_t pairs) {
  if (pairs <= l->pairs) return HK_OK;
  size_t room = l->pairs + l->pairs / 2;
  if (room < pairs) room = pairs;
  host->release(host, l->other);
  l->other = room < SIZE_MAX / sizeof *l->other ? host->allocate(host, room * sizeof *l->other) : NULL;
  l->pairs = room;
  return l->other ? HK_OK : no_memory(l, host, pairs, "pairs of particles (a smaller radius has fewer)");
}

/* ---- cells ---- */

typedef struct build {
  hk_cell_list *list;
  const double *x;
  size_t n;
  double low[3], width, reach2; /* m, m, m^2 */
} build;

/* Computes with half of every length, so that the distance of the largest doubles does not overflow. */
static void choose_cells(build *b, double reach) {
  double extent = 0;
  for (size_t c = 0; c < 3; c++) {
    double low = b->x[c], high = low;
    for (size_t i = 1; i < b->n; i++) {
      double at = b->x[3 * i + c];
      low = at < low ? at : low;
      high = at > high ? at : high;
    }
    b->low[c] = low / 2;
    extent = fmax(extent, high / 2 - low / 2);
  }
  b->width = fmax(fmax(reach / 2 * widening, extent * narrowest), least_width);
  b->reach2 = reach * reach;
}

/* Numbers cells from 1, so that the number below the first cell exists and belongs to no point. */
static void number_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const build *b = context;
  (void)chunk;
  for (size_t i = begin; i < end; i++) {
    b->list->order[i] = (uint32_t)i;
    for (size_t c = 0; c < 3; c++)
      b->list->number[c * b->n + i] = 1 + (uint32_t)((b->x[3 * i + c] / 2 - b->low[c]) / b->width);
  }
}

/* One pass of the radix sort, by DIGIT bits; it is stable. */
static void sort_by_digit(hk_cell_list *l, size_t n, const uint32_t *number, unsigned shift) {
  size_t place[VALUES] = {0}, sum = 0;
  for (size_t i = 0; i < n; i++) place[number[i] >> shift & (VALUES - 1)]++;
  for (size_t v = 0; v < VALUES; v++) {
    size_t count = place[v];
    place[v] = sum;
    sum += count;
  }
  for (size_t k = 0; k < n; k++) l->spare[place[number[l->order[k]] >> shift & (VALUES - 1)]++] = l->order[k];
  uint32_t *sorted = l->spare;
  l->spare = l->order;
  l->order = sorted;
}

static void sort_by_cell(hk_cell_list *l, size_t n) {
  for (size_t c = 0; c < 3; c++) {
    const uint32_t *number = l->number + c * n;
    uint32_t largest = 0;
    for (size_t i = 0; i < n; i++) largest = number[i] > largest ? number[i] : largest;
    for (unsigned shift = 0; shift < 32 && largest >> shift; shift += DIGIT) sort_by_digit(l, n, number, shift);
  }
}

static void gather_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const build *b = context;
  hk_cell_list *l = b->list;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    size_t i = l->order[k];
    l->column[k] = l->number[i];
    l->lane[k] = (uint64_t)l->number[2 * b->n + i] << 32 | l->number[b->n + i];
    for (size_t c = 0; c < 3; c++) l->at[c * b->n + k] = b->x[3 * i + c];
  }
}

/* ---- rows ---- */

/* The nine parts of the list that hold the neighbours of one cell. */
typedef struct surroundings {
  size_t begin[LANES], end[LANES];
} surroundings;

static uint64_t lane_beside(uint64_t lane, int p) {
  uint64_t up = (uint64_t)1 << 32;
  return lane - up - 1 + (uint64_t)(p / 3) * up + (uint64_t)(p % 3);
}

static bool before(const hk_cell_list *l, size_t k, uint64_t lane, uint32_t column) {
  return l->lane[k] < lane || (l->lane[k] == lane && l->column[k] < column);
}

static size_t first_of(const build *b, uint64_t lane, uint32_t column) {
  size_t low = 0, high = b->n;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (before(b->list, middle, lane, column))
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* Finds the parts, starting from those of the previous cell in the list; for the `first` cell by bisection. */
static void look_around(const build *b, size_t k, bool first, surroundings *around) {
  const hk_cell_list *l = b->list;
  uint32_t column = l->column[k];
  for (int p = 0; p < LANES; p++) {
    uint64_t lane = lane_beside(l->lane[k], p);
    size_t begin = first ? first_of(b, lane, column - 1) : around->begin[p], end;
    while (begin < b->n && before(l, begin, lane, column - 1)) begin++;
    end = !first && around->end[p] > begin ? around->end[p] : begin;
    while (end < b->n && before(l, end, lane, column + 2)) end++;
    around->begin[p] = begin;
    around->end[p] = end;
  }
}

static bool same_cell(const hk_cell_list *l, size_t a, size_t b) {
  return l->lane[a] == l->lane[b] && l->column[a] == l->column[b];
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
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    size_t count = 0;
    if (k == begin || !same_cell(b->list, k, k - 1)) look_around(b, k, k == begin, &around);
    for (int p = 0; p < LANES; p++) count += count_piece(b, k, around.begin[p], around.end[p]);
    b->list->row_start[b->list->order[k] + 1] = count - 1; /* without the point itself */
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
  size_t count; /* 0: there are more than fit */
  uint32_t point[CANDIDATES];
  double x[CANDIDATES], y[CANDIDATES], z[CANDIDATES];
} candidates;

static void gather_candidates(const build *b, const surroundings *around, candidates *c) {
  size_t count = 0;
  for (int p = 0; p < LANES; p++) count += around->end[p] - around->begin[p];
  c->count = 0;
  if (count > CANDIDATES) return;
  for (int p = 0; p < LANES; c->count += around->end[p] - around->begin[p], p++)
    memcpy(c->point + c->count, b->list->order + around->begin[p],
           (around->end[p] - around->begin[p]) * sizeof *c->point);
  if (count > 128) /* above this length the radix sort is faster */
    sort_long(c->point, count, b->n);
  else
    sort_short(c->point, count);
  for (size_t k = 0; k < count; k++) {
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

/* For more points than CANDIDATES: collected part by part, then sorted. */
static void collect_row(const build *b, const surroundings *around, size_t k) {
  uint32_t *row = b->list->other + b->list->row_start[b->list->order[k]], *into = row;
  for (int p = 0; p < LANES; p++)
    for (size_t j = around->begin[p]; j < around->end[p]; j++)
      if (j != k && distance2(b, j, k) < b->reach2) *into++ = b->list->order[j];
  sort_short(row, (size_t)(into - row));
}

static void fill_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const build *b = context;
  surroundings around;
  candidates near;
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    if (k == begin || !same_cell(b->list, k, k - 1)) {
      look_around(b, k, k == begin, &around);
      gather_candidates(b, &around, &near);
    }
    if (near.count)
      choose_row(b, &near, b->list->order[k]);
    else
      collect_row(b, &around, k);
  }
}

static void find_rows(build *b, const hk_host *host) {
  hk_cell_list *l = b->list;
  host->parallel_for(host, b->n, GRAIN, number_chunk, b);
  sort_by_cell(l, b->n);
  host->parallel_for(host, b->n, GRAIN, gather_chunk, b);
  host->parallel_for(host, b->n, GRAIN, count_chunk, b);
  for (size_t i = 0; i < b->n; i++) l->row_start[i + 1] += l->row_start[i];
}

hk_status hk_cell_list_build(hk_cell_list *l, const hk_host *host, const double *x, size_t n, double reach) {
  build b = {.list = l, .x = x, .n = n};
  l->n = 0;
  hk_status status = hk_cell_list_reserve(l, host, n);
  if (status != HK_OK) return status;
  memset(l->row_start, 0, (n + 1) * sizeof *l->row_start);
  if (n > 1 && reach > 0) {
    choose_cells(&b, reach);
    find_rows(&b, host);
    status = reserve_pairs(l, host, l->row_start[n]);
    if (status != HK_OK) return status;
    if (l->row_start[n]) host->parallel_for(host, n, GRAIN, fill_chunk, &b);
  }
  l->n = n;
  return HK_OK;
}
