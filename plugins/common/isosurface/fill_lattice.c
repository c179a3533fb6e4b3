/* The lattice of a filling: values at its points, where the surface crosses its edges, and which points move there. A
 * point moves to the nearest cut of its edges that is closer than a part of the edge, 0.24999 of long ones and 0.41189
 * of short ones (Labelle and Shewchuk 2007, table 2: the best angles); the cuts at it are none any more. */
#include "plugins/common/isosurface/edge_root.h"
#include "plugins/common/isosurface/fill_lattice.h"

#include <string.h>

enum { BATCH = 256 };

static const double long_part = 0.24999, short_part = 0.41189;

hk_status hk_fill_allocate(hk_fill_work *w, void *array, size_t count, size_t size, const char *what) {
  size_t most = w->options->most_bytes ? w->options->most_bytes : SIZE_MAX;
  void *memory = NULL;
  bool fits = count <= (SIZE_MAX / 2 - w->bytes) / size && w->bytes + count * size <= most;
  if (fits) memory = w->host->allocate(w->host, count * size);
  if (!memory)
    return w->host->fail(w->host, HK_NO_MEMORY,
                         "isosurface: %zu %s need %.3g MB beside %.3g MB, %s: take a larger cell or a smaller box",
                         count, what, 1e-6 * (double)count * (double)size, 1e-6 * (double)w->bytes,
                         fits ? "which the system does not give" : "and no more memory is allowed");
  memcpy(array, &memory, sizeof memory);
  w->bytes += count * size;
  return HK_OK;
}

/* ---- points and edges ---- */

typedef struct lattice_point {
  size_t at[3];
  bool centre;
} lattice_point;

static lattice_point point_of(const hk_fill_work *w, size_t p) {
  const size_t *n = w->grid->points;
  bool centre = p >= w->corners;
  size_t k = centre ? p - w->corners : p, nx = n[0] - centre, ny = n[1] - centre;
  return (lattice_point){{k % nx, k / nx % ny, k / nx / ny}, centre};
}

static uint32_t corner_number(const hk_fill_work *w, size_t x, size_t y, size_t z) {
  return (uint32_t)((z * w->grid->points[1] + y) * w->grid->points[0] + x);
}

void hk_fill_place(const hk_fill_work *w, size_t point, double x[3]) {
  lattice_point p = point_of(w, point);
  for (int c = 0; c < 3; c++)
    x[c] = w->grid->origin[c] + ((double)p.at[c] + (p.centre ? 0.5 : 0)) * w->grid->spacing[c];
}

bool hk_fill_is_long(const hk_fill_work *w, uint32_t p, uint32_t q) { return (p < w->corners) == (q < w->corners); }

unsigned hk_fill_edges(const hk_fill_work *w, size_t point, uint32_t end[11]) {
  lattice_point p = point_of(w, point);
  const size_t *n = w->grid->points;
  size_t step[3] = {1, n[0] - p.centre, (n[0] - p.centre) * (n[1] - p.centre)};
  unsigned count = 0;
  for (int c = 0; c < 3; c++)
    if (p.at[c] + 1 < n[c] - p.centre) end[count++] = (uint32_t)(point + step[c]);
  for (size_t k = 0; k < 8 && p.centre; k++)
    end[count++] = corner_number(w, p.at[0] + (k & 1), p.at[1] + (k >> 1 & 1), p.at[2] + (k >> 2));
  return count;
}

/* ---- values ---- */

static void evaluate_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  hk_fill_work *w = context;
  double place[BATCH][3];
  (void)chunk;
  for (size_t p = begin; p < end; p++) hk_fill_place(w, p, place[p - begin]);
  w->field->evaluate(w->field->self, (const double(*)[3])place, end - begin, w->value + begin);
}

static bool at_border(const hk_fill_work *w, size_t point) {
  lattice_point p = point_of(w, point);
  for (int c = 0; c < 3; c++)
    if (p.at[c] == 0 || p.at[c] + 1 == w->grid->points[c] - p.centre) return true;
  return false;
}

static hk_status take_values(hk_fill_work *w) {
  double low = INFINITY, high = -INFINITY, x[3];
  for (size_t p = 0; p < w->points; p++) {
    double value = w->value[p];
    if (!(fabs(value) <= 1e300)) {
      hk_fill_place(w, p, x);
      return w->host->fail(w->host, HK_NOT_FINITE,
                           "isosurface: the field is %g at (%g, %g, %g): give a finite number there, of at most 1e300 "
                           "in size",
                           value, x[0], x[1], x[2]);
    }
    low = fmin(low, value), high = fmax(high, value);
    w->value[p] = value - w->options->level;
    w->side[p] = (int8_t)((w->value[p] > 0) - (w->value[p] < 0));
    w->first[p] = w->moved[p] = w->number[p] = hk_fill_none;
    if (w->side[p] < 0 || !at_border(w, p)) continue;
    hk_fill_place(w, p, x);
    return w->host->fail(
        w->host, HK_BAD_PARAM,
        "isosurface: the surface leaves the box, or comes nearer to its faces than half a cell: at (%g, "
        "%g, %g) the field is %g and the level %g: take a larger box",
        x[0], x[1], x[2], value, w->options->level);
  }
  if (high > w->options->level) return HK_OK;
  return w->host->fail(w->host, HK_BAD_PARAM,
                       "isosurface: nothing is inside in the box: the field is from %g to %g on the lattice and the "
                       "level %g: take another level, another box or a smaller cell",
                       low, high, w->options->level);
}

/* ---- cuts ---- */

static void list_cuts(hk_fill_work *w) {
  uint32_t end[11];
  w->cuts = 0;
  for (uint32_t p = 0; p < w->points; p++)
    for (unsigned k = 0, count = hk_fill_edges(w, p, end); k < count; k++) {
      if (w->side[p] * w->side[end[k]] >= 0) continue;
      uint32_t number = (uint32_t)w->cuts++, a = w->side[p] > 0 ? p : end[k], b = w->side[p] > 0 ? end[k] : p;
      if (!w->cut) continue;
      w->cut[number] = (hk_fill_cut){a, b, {w->first[a], w->first[b]}, hk_fill_none, {0}};
      w->first[a] = w->first[b] = number;
    }
}

static void place_on(const hk_fill_work *w, const hk_fill_cut *cut, double t, double x[3]) {
  double a[3], b[3];
  hk_fill_place(w, cut->inside, a);
  hk_fill_place(w, cut->outside, b);
  for (int c = 0; c < 3; c++) x[c] = a[c] + t * (b[c] - a[c]);
}

/* A value that is not finite leaves a cut where it was. */
static void find_cuts(void *context, size_t begin, size_t end, size_t chunk) {
  hk_fill_work *w = context;
  hk_edge_root root[BATCH];
  double t[BATCH], x[BATCH][3], value[BATCH];
  (void)chunk;
  for (size_t k = begin; k < end; k++) {
    const hk_fill_cut *cut = &w->cut[k];
    t[k - begin] = hk_zero_between(w->value[cut->inside], w->value[cut->outside]);
    root[k - begin] = hk_edge_root_open(w->value[cut->inside], w->value[cut->outside], t[k - begin]);
  }
  for (unsigned step = 0; step <= w->options->steps; step++) {
    for (size_t k = begin; k < end; k++) place_on(w, &w->cut[k], t[k - begin], x[k - begin]);
    w->field->evaluate(w->field->self, (const double(*)[3])x, end - begin, value);
    for (size_t k = 0; k < end - begin; k++)
      if (fabs(value[k]) <= 1e300) t[k] = hk_edge_root_move(&root[k], t[k], value[k] - w->options->level);
  }
  for (size_t k = begin; k < end; k++) place_on(w, &w->cut[k], root[k - begin].best, w->cut[k].x);
}

static hk_status allocate_points(hk_fill_work *w) {
  hk_status status = hk_fill_allocate(w, &w->value, w->points, sizeof *w->value, "values of the lattice");
  if (status == HK_OK) status = hk_fill_allocate(w, &w->side, w->points, sizeof *w->side, "sides of points");
  if (status == HK_OK) status = hk_fill_allocate(w, &w->first, w->points, sizeof *w->first, "lists of cuts");
  if (status == HK_OK) status = hk_fill_allocate(w, &w->moved, w->points, sizeof *w->moved, "marks of points");
  if (status == HK_OK) status = hk_fill_allocate(w, &w->number, w->points, sizeof *w->number, "numbers of points");
  return status;
}

hk_status hk_fill_survey(hk_fill_work *w) {
  const size_t *n = w->grid->points;
  double points = 2 * (double)n[0] * (double)n[1] * (double)n[2];
  if (points > 1e9)
    return w->host->fail(w->host, HK_NO_MEMORY, "isosurface: a lattice of %.3g points: take a larger cell", points);
  w->corners = n[0] * n[1] * n[2];
  w->points = w->corners + (n[0] - 1) * (n[1] - 1) * (n[2] - 1);
  hk_status status = allocate_points(w);
  if (status != HK_OK) return status;
  w->host->parallel_for(w->host, w->points, BATCH, evaluate_chunk, w);
  status = take_values(w);
  if (status != HK_OK) return status;
  list_cuts(w);
  status = hk_fill_allocate(w, &w->cut, w->cuts, sizeof *w->cut, "cuts of the lattice");
  if (status != HK_OK) return status;
  list_cuts(w);
  w->host->parallel_for(w->host, w->cuts, BATCH, find_cuts, w);
  return HK_OK;
}

/* ---- points onto the surface ---- */

/* The nearest cut at p that is close enough to move it there, or hk_fill_none. */
static uint32_t violating(const hk_fill_work *w, uint32_t p) {
  uint32_t nearest = hk_fill_none;
  double least = INFINITY, at[3];
  hk_fill_place(w, p, at);
  for (uint32_t k = w->first[p]; k != hk_fill_none;) {
    const hk_fill_cut *cut = &w->cut[k];
    uint32_t other = cut->inside == p ? cut->outside : cut->inside;
    double end[3], distance = 0, length = 0;
    hk_fill_place(w, other, end);
    for (int c = 0; c < 3; c++) {
      distance += (cut->x[c] - at[c]) * (cut->x[c] - at[c]);
      length += (end[c] - at[c]) * (end[c] - at[c]);
    }
    double part = hk_fill_is_long(w, p, other) ? long_part : short_part;
    if (w->side[other] != 0 && distance < part * part * length && distance < least) least = distance, nearest = k;
    k = cut->next[cut->inside == p ? 0 : 1];
  }
  return nearest;
}

void hk_fill_move_points(hk_fill_work *w) {
  for (uint32_t p = 0; p < w->points; p++) {
    if (w->side[p] == 0 || w->first[p] == hk_fill_none) continue;
    uint32_t cut = violating(w, p);
    if (cut == hk_fill_none) continue;
    w->moved[p] = cut;
    w->side[p] = 0;
  }
}
