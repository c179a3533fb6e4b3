/* Plain searches: see plain_search.h. */
#include "tools/native/common/plain_search.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static char sentence[256];

static const char *say(const char *format, ...) {
  va_list list;
  va_start(list, format);
  vsnprintf(sentence, sizeof sentence, format, list);
  va_end(list);
  return sentence;
}

/* ---- rows ---- */

/* Of squares of distances that are computed in another order. */
static const double rounding = 1e-12;

static double distance2(const double *x, size_t i, size_t j) {
  double dx = x[3 * j] - x[3 * i], dy = x[3 * j + 1] - x[3 * i + 1], dz = x[3 * j + 2] - x[3 * i + 2];
  return dx * dx + dy * dy + dz * dz;
}

static const char *check_row(const hk_neighbour_rows *rows, size_t i) {
  if (rows->row_start[i + 1] < rows->row_start[i]) return say("the row of particle %zu ends before it begins", i + 1);
  for (size_t k = rows->row_start[i]; k < rows->row_start[i + 1]; k++) {
    size_t j = rows->other[k];
    if (j >= rows->n) return say("the row of particle %zu names a particle that there is not", i + 1);
    if (j == i) return say("the row of particle %zu has the particle itself", i + 1);
    if (k > rows->row_start[i] && rows->other[k - 1] == j)
      return say("the row of particle %zu has particle %zu twice", i + 1, j + 1);
    if (k > rows->row_start[i] && rows->other[k - 1] > j) return say("the row of particle %zu does not rise", i + 1);
  }
  return NULL;
}

static bool has(const hk_neighbour_rows *rows, size_t i, size_t j) {
  size_t low = rows->row_start[i], high = rows->row_start[i + 1];
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (rows->other[middle] < j)
      low = middle + 1;
    else
      high = middle;
  }
  return low < rows->row_start[i + 1] && rows->other[low] == j;
}

const char *hk_compare_rows(const hk_neighbour_rows *rows, const double *x, size_t n, double radius) {
  const char *wrong = NULL;
  if (rows->n != n) return say("its rows are of %zu particles, of %zu that there are", rows->n, n);
  if (!(rows->reach >= radius)) return say("its reach is %g m, where %g m was asked for", rows->reach, radius);
  if (n && rows->row_start[0] != 0) return say("the first row does not begin at 0");
  for (size_t i = 0; i < n && !wrong; i++) wrong = check_row(rows, i);
  for (size_t i = 0; i < n && !wrong; i++) {
    size_t next = rows->row_start[i], end = rows->row_start[i + 1];
    for (size_t j = 0; j < n; j++) { /* what is missing in both rows is seen in the first */
      while (next < end && rows->other[next] < j) next++;
      bool there = next < end && rows->other[next] == j;
      if (there && !has(rows, j, i))
        return say("particle %zu is in the row of particle %zu, and not the other way round", j + 1, i + 1);
      if (!there && j > i && distance2(x, i, j) < radius * radius * (1 - rounding))
        return say("it misses particle %zu in the row of particle %zu, %g m away, closer than %g m", j + 1, i + 1,
                   sqrt(distance2(x, i, j)), radius);
    }
  }
  return wrong;
}

const char *hk_compare_with_kept(hk_kept_rows *kept, const hk_neighbour_rows *rows) {
  size_t n = rows->n, starts = (n + 1) * sizeof *kept->row_start;
  size_t pairs = n ? rows->row_start[n] * sizeof *kept->other : 0;
  bool alike = kept->row_start && kept->n == n && (n == 0 || memcmp(kept->row_start, rows->row_start, starts) == 0) &&
               (pairs == 0 || memcmp(kept->other, rows->other, pairs) == 0);
  if (kept->row_start && !alike && kept->number == rows->number)
    return say("its rows changed, and their `number` is still %llu", (unsigned long long)rows->number);
  hk_kept_rows_free(kept);
  *kept = (hk_kept_rows){n, rows->number, malloc(starts + 1), malloc(pairs + 1)};
  if (!kept->row_start || !kept->other) return say("no memory to keep the rows");
  if (n) memcpy(kept->row_start, rows->row_start, starts);
  if (pairs) memcpy(kept->other, rows->other, pairs);
  return NULL;
}

void hk_kept_rows_free(hk_kept_rows *kept) {
  free(kept->row_start);
  free(kept->other);
  kept->row_start = NULL;
  kept->other = NULL;
}

/* ---- octrees ---- */

enum { LEAF = 8 };

typedef struct octree_case {
  const hk_octree *tree;
  const double *x;
  double extent; /* m, of all its points */
} octree_case;

static const char *check_box(const octree_case *o, size_t k) {
  const hk_octree_cell *cell = &o->tree->cell[k];
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, side = 0;
  for (size_t p = cell->begin; p < (size_t)cell->begin + cell->count; p++)
    for (size_t c = 0; c < 3; c++) {
      low[c] = fmin(low[c], o->x[3 * (size_t)o->tree->order[p] + c]);
      high[c] = fmax(high[c], o->x[3 * (size_t)o->tree->order[p] + c]);
    }
  for (size_t c = 0; c < 3; c++) {
    side = fmax(side, high[c] - low[c]);
    if (cell->low[c] > low[c] || cell->high[c] < high[c])
      return say("a point of cell %zu is outside of the cell's box, which ends at %.17g m", k,
                 cell->low[c] > low[c] ? cell->low[c] : cell->high[c]);
    if (cell->low[c] < low[c] - 1e-9 * o->extent || cell->high[c] > high[c] + 1e-9 * o->extent)
      return say("the box of cell %zu is larger than that of its points", k);
  }
  if (cell->next == k + 1 && cell->count > LEAF && side > ldexp(o->extent, -20))
    return say("cell %zu has no parts, and %u points within %g m, which can be told apart", k, cell->count, side);
  return NULL;
}

/* The cells inside cell k, from k + 1 on, have its points one after the other. */
static const char *check_parts(const octree_case *o, size_t k) {
  const hk_octree_cell *cell = &o->tree->cell[k];
  if (cell->next <= k || cell->next > o->tree->cells) return say("cell %zu goes on at cell %u", k, cell->next);
  if ((size_t)cell->begin + cell->count > o->tree->points || cell->count == 0)
    return say("cell %zu has points that there are not, or none", k);
  size_t at = cell->begin;
  for (size_t part = k + 1; part < cell->next; part = o->tree->cell[part].next) {
    const hk_octree_cell *inner = &o->tree->cell[part];
    if (inner->next <= part || inner->next > cell->next)
      return say("cell %zu, a part of cell %zu, goes on outside of it", part, k);
    if (inner->begin != at) return say("the parts of cell %zu leave points out, or share some", k);
    at += inner->count;
  }
  if (cell->next > k + 1 && at != (size_t)cell->begin + cell->count)
    return say("the parts of cell %zu do not have all of its points", k);
  return NULL;
}

/* Every particle that was asked for stands in `order` once. */
static const char *check_order(const hk_octree *tree, const uint32_t *list, size_t count, size_t n) {
  unsigned char *state = calloc(n + 1, 1); /* 1: asked for, 2: found */
  const char *wrong = state ? NULL : say("no memory for the particles");
  for (size_t k = 0; state && k < count; k++) state[list ? list[k] : k] = 1;
  for (size_t k = 0; k < count && !wrong; k++) {
    size_t i = tree->order[k];
    if (i >= n || state[i] == 0)
      wrong = say("`order` names particle %zu, which was not asked for", i + 1);
    else if (state[i] == 2)
      wrong = say("`order` has particle %zu twice", i + 1);
    else
      state[i] = 2;
  }
  free(state);
  return wrong;
}

const char *hk_compare_octree(const hk_octree *tree, const double *x, const uint32_t *list, size_t count, size_t n) {
  octree_case o = {tree, x, 0};
  if (tree->points != count) return say("it has %zu points, of %zu that it was asked for", tree->points, count);
  const char *wrong = check_order(tree, list, count, n);
  if (!wrong && count &&
      (tree->cells == 0 || tree->cell[0].begin != 0 || tree->cell[0].count != count ||
       tree->cell[0].next != tree->cells))
    wrong = say("the first cell is not the root, which has all points and all cells");
  if (wrong || count == 0) return wrong;
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t p = 0; p < count; p++)
    for (size_t c = 0; c < 3; c++) {
      low[c] = fmin(low[c], x[3 * (size_t)tree->order[p] + c]);
      high[c] = fmax(high[c], x[3 * (size_t)tree->order[p] + c]);
    }
  for (size_t c = 0; c < 3; c++) o.extent = fmax(o.extent, high[c] - low[c]);
  for (size_t k = 0; k < tree->cells && !wrong; k++) wrong = check_parts(&o, k);
  for (size_t k = 0; k < tree->cells && !wrong; k++) wrong = check_box(&o, k);
  return wrong;
}

/* ---- trees of boxes ---- */

typedef struct found {
  unsigned char *times; /* that each item was found */
  const hk_box *box;
  double p[3];
  size_t items;
  bool strange;
} found;

static void note(void *context, uint32_t item) {
  found *f = context;
  if (item < f->items)
    f->times[item]++;
  else
    f->strange = true;
}

static double to_box2(const hk_box *box, const double p[3]) {
  double sum = 0;
  for (size_t c = 0; c < 3; c++) {
    double off = fmax(0, fmax(box->low[c] - p[c], p[c] - box->high[c]));
    sum += off * off;
  }
  return sum;
}

static double to_item2(void *context, uint32_t item, double best2) {
  const found *f = context;
  (void)best2;
  return to_box2(&f->box[item], f->p);
}

static const char *check_overlaps(const hk_bvh *tree, found *f, size_t asked) {
  memset(f->times, 0, f->items + 1);
  f->strange = false;
  hk_bvh_overlaps(tree, f->box, &f->box[asked], note, f);
  if (f->strange) return say("its tree has an item that there is not");
  for (size_t j = 0; j < f->items; j++) {
    bool overlaps = hk_box_overlap(&f->box[asked], &f->box[j]);
    if (f->times[j] > 1) return say("its tree has box %zu twice", j + 1);
    if (overlaps && f->times[j] == 0)
      return say("a search of its tree misses box %zu, which overlaps box %zu", j + 1, asked + 1);
  }
  return NULL;
}

static const char *check_nearest(const hk_bvh *tree, found *f, size_t asked) {
  double best2 = INFINITY;
  for (size_t c = 0; c < 3; c++) f->p[c] = f->box[asked].high[c] + 0.3 * (double)(c + 1);
  for (size_t j = 0; j < f->items; j++) best2 = fmin(best2, to_box2(&f->box[j], f->p));
  double got = hk_bvh_nearest(tree, f->p, INFINITY, to_item2, f);
  if (!(fabs(got - best2) <= 1e-12 * best2))
    return say("a search of its tree finds %g m as the least distance, and it is %g m", sqrt(got), sqrt(best2));
  return NULL;
}

const char *hk_compare_bvh(const hk_bvh *tree, const hk_box *box, size_t items) {
  found f = {.times = calloc(items + 1, 1), .box = box, .items = items};
  const char *wrong = f.times ? NULL : say("no memory for the boxes");
  if (!wrong && (!tree || tree->items != items)) wrong = say("its tree is not of the %zu boxes", items);
  size_t stride = items / 200 + 1;
  for (size_t i = 0; i < items && !wrong; i += stride) {
    wrong = check_overlaps(tree, &f, i);
    if (!wrong) wrong = check_nearest(tree, &f, i);
  }
  free(f.times);
  return wrong;
}
