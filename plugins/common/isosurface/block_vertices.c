/* Places and normals of the vertices of a block, some at a time, so that a field is evaluated in batches. A vertex lies
 * between an inside end a and an outside end b of its edge, at a + t (b - a). On an edge into the layer around the
 * grid, b is the nearest point of the grid: the vertex stays in the box, in its middle where b would be inside as well.
 */
#include "plugins/common/isosurface/edge_root.h"
#include "plugins/common/isosurface/grid_blocks.h"

#include <float.h>
#include <string.h>

enum { BATCH = 64 };

typedef struct axis_point { /* a point of the block on one axis */
  double place;             /* m */
  size_t offset;            /* what it adds to the index of a value */
  size_t up, down;          /* steps to the neighbours on the grid, 0 where there is none, in the array */
  double rate;              /* 1 / their distance, 1/m */
  bool layer;               /* in the layer around the grid */
} axis_point;

typedef struct crossing {
  uint8_t a[3], b[3]; /* points of the block */
  double at_a, at_b;  /* f - level: at_a >= 0 */
  double t;
  bool capped; /* b is in the layer */
} crossing;

typedef struct batch {
  const hk_surface_work *w;
  hk_surface_block *block;
  const double *values; /* of the block, or of the array */
  axis_point axis[3][HK_POINTS];
  size_t first, count;
  crossing at[BATCH];
} batch;

static void fill_axes(batch *b) {
  const hk_isosurface_grid *grid = b->w->grid;
  size_t corner[3], stride[3] = {1, HK_POINTS, HK_POINTS * HK_POINTS};
  hk_block_corner(b->w, b->block->number, corner);
  if (!b->w->kept) stride[1] = grid->points[0], stride[2] = grid->points[0] * grid->points[1];
  for (int c = 0; c < 3; c++)
    for (size_t k = 0; k < HK_POINTS; k++) {
      size_t i = hk_grid_point(b->w, c, corner[c] + k);
      axis_point *p = &b->axis[c][k];
      p->place = hk_point_place(b->w, c, corner[c] + k);
      p->offset = stride[c] * (b->w->kept ? k : i);
      p->up = i + 1 < grid->points[c] ? stride[c] : 0, p->down = i > 0 ? stride[c] : 0;
      p->rate = 1 / ((p->up && p->down ? 2 : 1) * grid->spacing[c]);
      p->layer = hk_in_layer(b->w, c, corner[c] + k);
    }
}

static size_t index_of(const batch *b, const uint8_t point[3]) {
  return b->axis[0][point[0]].offset + b->axis[1][point[1]].offset + b->axis[2][point[2]].offset;
}

static void normalise(double n[3]) {
  double square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
  if (!(square > 1e-200 && square < 1e200)) { /* squares overflow or vanish */
    double most = fmax(fabs(n[0]), fmax(fabs(n[1]), fabs(n[2])));
    for (int c = 0; c < 3; c++) n[c] /= most;
    square = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
  }
  double scale = 1 / sqrt(square);
  for (int c = 0; c < 3; c++) n[c] *= scale;
}

static crossing crossing_on(const batch *b, unsigned point, unsigned direction, bool low_is_inside) {
  const uint8_t low[3] = {point % 8, point / 8 % 8, (uint8_t)(point / 64)};
  crossing k = {.capped = false};
  for (unsigned c = 0; c < 3; c++) {
    uint8_t high = (uint8_t)(low[c] + (direction >> c & 1));
    k.a[c] = low_is_inside ? low[c] : high, k.b[c] = low_is_inside ? high : low[c];
    k.capped |= b->axis[c][k.b[c]].layer;
  }
  k.at_a = b->values[index_of(b, k.a)] - b->w->options->level;
  k.at_b = b->values[index_of(b, k.b)] - b->w->options->level;
  k.t = k.at_b < 0 ? hk_zero_between(k.at_a, k.at_b) : 0.5;
  return k;
}

/* From the inside to the outside along the edge, or out of the box where b is in the layer. */
static void edge_direction(const batch *b, const crossing *k, double n[3]) {
  for (int c = 0; c < 3; c++) {
    int step = k->b[c] - k->a[c];
    n[c] = !k->capped ? step * b->w->grid->spacing[c] : b->axis[c][k->b[c]].layer ? step : 0;
  }
}

static void place_of(const batch *b, const crossing *k, double x[3]) {
  for (int c = 0; c < 3; c++) {
    double from = b->axis[c][k->a[c]].place;
    x[c] = from + k->t * (b->axis[c][k->b[c]].place - from);
  }
}

static void note_not_finite(batch *b, const double x[3]) {
  if (b->block->not_finite) return;
  b->block->not_finite = true;
  for (int c = 0; c < 3; c++) b->block->place[c] = x[c];
}

/* Takes the value at x, where the vertex is, and moves it on; `best` keeps the nearest to the level up to now. */
static void move_on(batch *b, hk_edge_root *r, crossing *at, double value, const double x[3]) {
  if (!hk_value_allowed(value)) note_not_finite(b, x);
  if (!hk_value_allowed(value) || !(at->at_b < 0)) return;
  value -= b->w->options->level;
  at->t = hk_edge_root_move(r, at->t, value);
}

/* A vertex ends at the best place that was evaluated, never at one that rounding has spoilt. */
static void project(batch *b) {
  const hk_isosurface_field *f = b->w->field;
  double place[BATCH][3], value[BATCH];
  hk_edge_root of[BATCH];
  for (size_t k = 0; k < b->count; k++) of[k] = hk_edge_root_open(b->at[k].at_a, b->at[k].at_b, b->at[k].t);
  for (unsigned step = 0; step <= b->w->options->steps; step++) {
    for (size_t k = 0; k < b->count; k++) place_of(b, &b->at[k], place[k]);
    f->evaluate(f->self, (const double(*)[3])place, b->count, value);
    for (size_t k = 0; k < b->count; k++) move_on(b, &of[k], &b->at[k], value[k], place[k]);
  }
  for (size_t k = 0; k < b->count; k++) b->at[k].t = of[k].best;
}

/* Central differences over the neighbours of a point of the grid, one-sided at its border. */
static void gradient_at(const batch *b, const uint8_t point[3], double g[3]) {
  const double *value = b->values + index_of(b, point);
  for (int c = 0; c < 3; c++) {
    const axis_point *p = &b->axis[c][point[c]];
    g[c] = (value[p->up] - *(value - p->down)) * p->rate;
  }
}

static void array_gradients(const batch *b, double gradient[][3]) {
  for (size_t k = 0; k < b->count; k++) {
    const crossing *at = &b->at[k];
    double from[3], to[3];
    gradient_at(b, at->a, from);
    gradient_at(b, at->b, to);
    for (int c = 0; c < 3; c++) gradient[k][c] = from[c] + at->t * (to[c] - from[c]);
  }
}

/* Central differences of the field over a 32nd of the spacing, within the box. */
static void field_gradients(const batch *b, double (*x)[3], double gradient[][3]) {
  const hk_isosurface_field *f = b->w->field;
  const hk_isosurface_grid *grid = b->w->grid;
  double place[2 * BATCH][3], value[2 * BATCH];
  for (int c = 0; c < 3; c++) {
    double low = grid->origin[c], high = hk_point_place(b->w, c, grid->points[c]), reach = grid->spacing[c] / 64;
    for (size_t k = 0; k < 2 * b->count; k++) {
      for (int d = 0; d < 3; d++) place[k][d] = x[k / 2][d];
      place[k][c] = k % 2 ? fmin(x[k / 2][c] + reach, high) : fmax(x[k / 2][c] - reach, low);
    }
    f->evaluate(f->self, (const double(*)[3])place, 2 * b->count, value);
    for (size_t k = 0; k < b->count; k++)
      gradient[k][c] = (value[2 * k + 1] - value[2 * k]) / (place[2 * k + 1][c] - place[2 * k][c]);
  }
}

static void write_normals(const batch *b, double gradient[][3], double (*normal)[3]) {
  for (size_t k = 0; k < b->count; k++) {
    const double *g = gradient[k];
    double size = fabs(g[0]) + fabs(g[1]) + fabs(g[2]);
    for (int c = 0; c < 3; c++) normal[k][c] = -g[c];
    if (!(size > 0 && size <= DBL_MAX) || b->at[k].capped) edge_direction(b, &b->at[k], normal[k]);
    normalise(normal[k]);
  }
}

static void finish(batch *b) {
  double gradient[BATCH][3], (*x)[3] = b->w->found.x + b->first, margin = b->w->options->margin;
  if (b->w->options->steps > 0 && b->w->kept) project(b);
  for (size_t k = 0; k < b->count; k++) {
    double t = b->at[k].t;
    b->at[k].t = t < margin ? margin : t > 1 - margin ? 1 - margin : t;
    place_of(b, &b->at[k], x[k]);
  }
  if (b->w->found.normal) {
    b->w->kept ? field_gradients(b, x, gradient) : array_gradients(b, gradient);
    write_normals(b, gradient, b->w->found.normal + b->first);
  }
  b->first += b->count, b->count = 0;
}

void hk_block_vertices(const hk_surface_work *w, size_t slot) {
  hk_surface_block *block = &w->block[slot];
  batch b;
  b.w = w, b.block = block, b.first = block->first_vertex, b.count = 0;
  b.values = w->kept ? w->kept + HK_BLOCK_POINTS * slot : w->field->values;
  fill_axes(&b);
  for (unsigned k = 0; k < HK_BLOCK_CELLS; k++) {
    static const uint8_t none[HK_SIDE];
    if (k % HK_SIDE == 0 && memcmp(block->crossed + k, none, sizeof none) == 0) {
      k += HK_SIDE - 1;
      continue;
    }
    for (unsigned left = block->crossed[k], d = 1; left; left >>= 1, d++) {
      if (!(left & 1)) continue;
      b.at[b.count++] = crossing_on(&b, k, d, block->inside[k / 64 * HK_POINTS + k / 8 % 8] >> k % 8 & 1);
      if (b.count == BATCH) finish(&b);
    }
  }
  if (b.count > 0) finish(&b);
}
