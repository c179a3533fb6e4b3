/* Places and normals of the vertices of a block, some at a time, so that a field is evaluated in batches. A vertex lies
 * between an inside end a and an outside end b of its edge, at a + t (b - a). On an edge into the layer around the
 * grid, b is the nearest point of the grid: the vertex stays in the box, in its middle where b would be inside as well.
 */
#include "plugins/common/isosurface/grid_blocks.h"

#include <float.h>

enum { BATCH = 64 };

typedef struct edge_end {
  size_t point[3];        /* of the lattice */
  double place[3], value; /* value: f - level */
} edge_end;

typedef struct crossing {
  edge_end a, b;
  double t, outwards[3]; /* where the gradient vanishes */
  bool capped;           /* b is in the layer */
} crossing;

typedef struct batch {
  const hk_surface_work *w;
  hk_surface_block *block;
  const double *values; /* of the block; NULL: those of the array */
  size_t first, count;
  crossing at[BATCH];
} batch;

static double point_value(const batch *b, const size_t point[3]) {
  size_t i[3], corner[3];
  for (int c = 0; c < 3; c++) i[c] = hk_grid_point(b->w, c, point[c]);
  if (!b->values) return b->w->field->values[hk_grid_index(b->w, i)];
  hk_block_corner(b->w, b->block->number, corner);
  for (int c = 0; c < 3; c++) i[c] = point[c] - corner[c];
  return b->values[(i[2] * HK_POINTS + i[1]) * HK_POINTS + i[0]];
}

static edge_end end_at(const batch *b, const size_t point[3]) {
  edge_end e = {{point[0], point[1], point[2]}, {0}, point_value(b, point) - b->w->options->level};
  for (int c = 0; c < 3; c++) e.place[c] = hk_point_place(b->w, c, point[c]);
  return e;
}

static void normalise(double n[3]) {
  double most = fmax(fabs(n[0]), fmax(fabs(n[1]), fabs(n[2])));
  for (int c = 0; c < 3; c++) n[c] /= most; /* squares neither overflow nor vanish */
  double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  for (int c = 0; c < 3; c++) n[c] /= length;
}

/* The part of the way from a to b where a line between their values is 0: a.value >= 0 > b.value. */
static double zero_between(double a, double b) { return a / (a - b); }

static crossing crossing_on(const batch *b, const size_t low[3], unsigned direction, bool low_is_inside) {
  size_t high[3] = {low[0] + (direction & 1), low[1] + (direction >> 1 & 1), low[2] + (direction >> 2)};
  const size_t *out = low_is_inside ? high : low;
  crossing k = {.a = end_at(b, low_is_inside ? low : high), .b = end_at(b, out)};
  for (int c = 0; c < 3; c++) k.capped = k.capped || hk_in_layer(b->w, c, out[c]);
  for (int c = 0; c < 3; c++) {
    bool along = (direction >> c & 1) && (!k.capped || hk_in_layer(b->w, c, out[c]));
    k.outwards[c] = !along     ? 0
                    : k.capped ? (low_is_inside ? 1 : -1)
                               : (low_is_inside ? 1 : -1) * b->w->grid->spacing[c];
  }
  normalise(k.outwards);
  k.t = k.b.value < 0 ? zero_between(k.a.value, k.b.value) : 0.5;
  return k;
}

static void place_of(const crossing *k, double x[3]) {
  for (int c = 0; c < 3; c++) x[c] = k->a.place[c] + k->t * (k->b.place[c] - k->a.place[c]);
}

/* Between `low`, where f is not below the level, and `high`, where it is; `third` is the end before the last move, NAN
 * at the beginning. */
typedef struct bracket {
  double low, high, third, at_low, at_high, at_third, best, at_best; /* t, and f - level there */
} bracket;

static void narrow(bracket *r, double t, double value) {
  if (value >= 0)
    r->third = r->low, r->at_third = r->at_low, r->low = t, r->at_low = value;
  else
    r->third = r->high, r->at_third = r->at_high, r->high = t, r->at_high = value;
}

/* The zero within the bracket of the parabola through the three points (Muller 1956), which has exactly one there, as
 * its ends differ in sign: f(low + u) = at_low + slope u + bend u (u - width). */
static double next_guess(const bracket *r) {
  double width = r->high - r->low, slope = (r->at_high - r->at_low) / width;
  double bend = ((r->at_third - r->at_low) / (r->third - r->low) - slope) / (r->third - r->high);
  double b = slope - bend * width, root = sqrt(b * b - 4 * bend * r->at_low);
  double t = r->low + (b < 0 ? 2 * r->at_low / (root - b) : -(b + root) / (2 * bend));
  if (!(t >= r->low && t <= r->high)) t = r->low + width * zero_between(r->at_low, r->at_high);
  return t;
}

static void note_not_finite(batch *b, const double x[3]) {
  if (b->block->not_finite) return;
  b->block->not_finite = true;
  for (int c = 0; c < 3; c++) b->block->place[c] = x[c];
}

/* Takes the value at x, where the vertex is, and moves it on; `best` keeps the nearest to the level up to now. */
static void move_on(batch *b, bracket *r, crossing *at, double value, const double x[3]) {
  if (!hk_value_allowed(value)) note_not_finite(b, x);
  if (!hk_value_allowed(value) || !(at->b.value < 0)) return;
  value -= b->w->options->level;
  if (fabs(value) < fabs(r->at_best)) r->best = at->t, r->at_best = value;
  narrow(r, at->t, value);
  at->t = r->at_low > 0 ? next_guess(r) : r->low;
}

/* A vertex ends at the best place that was evaluated, never at one that rounding has spoilt. */
static void project(batch *b) {
  const hk_isosurface_field *f = b->w->field;
  double place[BATCH][3], value[BATCH];
  bracket of[BATCH];
  for (size_t k = 0; k < b->count; k++)
    of[k] = (bracket){0, 1, NAN, b->at[k].a.value, b->at[k].b.value, NAN, b->at[k].t, INFINITY};
  for (unsigned step = 0; step <= b->w->options->steps; step++) {
    for (size_t k = 0; k < b->count; k++) place_of(&b->at[k], place[k]);
    f->evaluate(f->self, (const double(*)[3])place, b->count, value);
    for (size_t k = 0; k < b->count; k++) move_on(b, &of[k], &b->at[k], value[k], place[k]);
  }
  for (size_t k = 0; k < b->count; k++) b->at[k].t = of[k].best;
}

/* Central differences over the neighbours of a point of the grid, one-sided at its border. */
static void gradient_at(const hk_surface_work *w, const size_t point[3], double g[3]) {
  size_t i[3] = {hk_grid_point(w, 0, point[0]), hk_grid_point(w, 1, point[1]), hk_grid_point(w, 2, point[2])};
  for (int c = 0; c < 3; c++) {
    size_t up[3] = {i[0], i[1], i[2]}, down[3] = {i[0], i[1], i[2]};
    up[c] += i[c] + 1 < w->grid->points[c], down[c] -= i[c] > 0;
    double rise = w->field->values[hk_grid_index(w, up)] - w->field->values[hk_grid_index(w, down)];
    g[c] = rise / ((double)(up[c] - down[c]) * w->grid->spacing[c]);
  }
}

static void array_gradients(const batch *b, double gradient[][3]) {
  for (size_t k = 0; k < b->count; k++) {
    const crossing *at = &b->at[k];
    double from[3], to[3];
    gradient_at(b->w, at->a.point, from);
    gradient_at(b->w, at->b.point, to);
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
    double *g = gradient[k], most = fmax(fabs(g[0]), fmax(fabs(g[1]), fabs(g[2])));
    bool known = most > 0 && fabs(g[0]) + fabs(g[1]) + fabs(g[2]) <= DBL_MAX && !b->at[k].capped;
    for (int c = 0; c < 3; c++) normal[k][c] = known ? -g[c] : b->at[k].outwards[c];
    normalise(normal[k]);
  }
}

static void finish(batch *b) {
  double gradient[BATCH][3], (*x)[3] = b->w->found.x + b->first, margin = b->w->options->margin;
  if (b->w->options->steps > 0 && b->w->field->evaluate) project(b);
  for (size_t k = 0; k < b->count; k++) {
    b->at[k].t = fmin(fmax(b->at[k].t, margin), 1 - margin);
    place_of(&b->at[k], x[k]);
  }
  b->values ? field_gradients(b, x, gradient) : array_gradients(b, gradient);
  write_normals(b, gradient, b->w->found.normal + b->first);
  b->first += b->count, b->count = 0;
}

void hk_block_vertices(const hk_surface_work *w, size_t slot) {
  hk_surface_block *block = &w->block[slot];
  batch b = {.w = w, .block = block, .first = block->first_vertex};
  size_t corner[3];
  b.values = w->kept ? w->kept + HK_BLOCK_POINTS * slot : NULL;
  hk_block_corner(w, block->number, corner);
  for (unsigned k = 0; k < HK_BLOCK_CELLS; k++)
    for (unsigned d = 1; d < 8; d++) {
      const unsigned at[3] = {k % 8, k / 8 % 8, k / 64};
      if (!(block->crossed[k] >> (d - 1) & 1)) continue;
      size_t low[3] = {corner[0] + at[0], corner[1] + at[1], corner[2] + at[2]};
      b.at[b.count++] = crossing_on(&b, low, d, block->inside[at[2] * HK_POINTS + at[1]] >> at[0] & 1);
      if (b.count == BATCH) finish(&b);
    }
  if (b.count > 0) finish(&b);
}
