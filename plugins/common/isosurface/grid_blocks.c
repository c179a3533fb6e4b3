/* What the blocks of a grid hold: values, which points are inside, which edges the surface crosses, and their
 * triangles. The number of a vertex is that of its block's first one, and of the crossed edges before its own, by
 * points and then by directions; so neighbours find it without a table of edges. */
#include "plugins/common/isosurface/grid_blocks.h"

#include <string.h>

static void evaluate(const hk_surface_work *w, const size_t corner[3], double *value) {
  double place[HK_BLOCK_POINTS][3];
  if (w->field->lattice) {
    double axis[3][HK_POINTS];
    for (size_t k = 0; k < 3 * HK_POINTS; k++)
      axis[k / HK_POINTS][k % HK_POINTS] =
          hk_point_place(w, (int)(k / HK_POINTS), corner[k / HK_POINTS] + k % HK_POINTS);
    w->field->lattice(w->field->self, axis[0], axis[1], axis[2], value);
    return;
  }
  for (size_t k = 0; k < HK_BLOCK_POINTS; k++) {
    place[k][0] = hk_point_place(w, 0, corner[0] + k % HK_POINTS);
    place[k][1] = hk_point_place(w, 1, corner[1] + k / HK_POINTS % HK_POINTS);
    place[k][2] = hk_point_place(w, 2, corner[2] + k / (HK_POINTS * HK_POINTS));
  }
  w->field->evaluate(w->field->self, (const double(*)[3])place, HK_BLOCK_POINTS, value);
}

static unsigned within(const hk_surface_work *w, int axis, size_t corner) {
  unsigned bits = 0;
  for (unsigned k = 0; k < HK_POINTS; k++) bits |= (unsigned)!hk_in_layer(w, axis, corner + k) << k;
  return bits;
}

static void mark_inside(const hk_surface_work *w, const size_t corner[3], const double *values, uint16_t *inside) {
  unsigned in_x = within(w, 0, corner[0]), in_y = within(w, 1, corner[1]), in_z = within(w, 2, corner[2]);
  for (unsigned row = 0; row < HK_BLOCK_ROWS; row++) {
    const double *value = values + (size_t)HK_POINTS * row;
    unsigned bits = 0;
    for (unsigned k = 0; k < HK_POINTS; k++) bits |= (unsigned)(value[k] >= w->options->level) << k;
    bool outside = !(in_y >> row % HK_POINTS & 1) || !(in_z >> row / HK_POINTS & 1);
    inside[row] = (uint16_t)(outside ? 0 : bits & in_x);
  }
}

size_t hk_known_place(const hk_surface_work *w, const size_t point[3], size_t *block) {
  size_t at[3];
  for (int c = 0; c < 3; c++) at[c] = hk_grid_point(w, c, point[c]) + 1;
  *block = (at[2] / HK_SIDE * w->blocks[1] + at[1] / HK_SIDE) * w->blocks[0] + at[0] / HK_SIDE;
  return (at[2] % HK_SIDE * HK_SIDE + at[1] % HK_SIDE) * HK_SIDE + at[0] % HK_SIDE;
}

static void known_block(const hk_surface_work *w, size_t number, double value[HK_BLOCK_POINTS]) {
  size_t corner[3], block;
  hk_block_corner(w, number, corner);
  for (size_t k = 0; k < HK_BLOCK_POINTS; k++) {
    size_t point[3] = {corner[0] + k % HK_POINTS, corner[1] + k / HK_POINTS % HK_POINTS,
                       corner[2] + k / (HK_POINTS * HK_POINTS)};
    size_t offset = hk_known_place(w, point, &block);
    value[k] = w->known->value[w->known->slot[block]][offset];
  }
}

bool hk_block_evaluate(const hk_surface_work *w, size_t number, double value[HK_BLOCK_POINTS],
                       uint16_t inside[HK_BLOCK_ROWS], size_t *bad) {
  size_t corner[3];
  unsigned wrong = 0;
  hk_block_corner(w, number, corner);
  w->known ? known_block(w, number, value) : evaluate(w, corner, value);
  for (size_t k = 0; k < HK_BLOCK_POINTS; k++) wrong |= !hk_value_allowed(value[k]);
  for (*bad = 0; wrong && hk_value_allowed(value[*bad]);) ++*bad;
  mark_inside(w, corner, value, inside);
  return !wrong;
}

bool hk_block_excluded(const hk_surface_work *w, size_t number) {
  size_t corner[3];
  double low[3], high[3], range[2];
  bool layer = false;
  if (w->known) return !w->known->visited[number];
  if (!w->field->bounds) return false;
  hk_block_corner(w, number, corner);
  for (int c = 0; c < 3; c++) {
    low[c] = hk_point_place(w, c, corner[c]), high[c] = hk_point_place(w, c, corner[c] + HK_SIDE);
    layer = layer || hk_in_layer(w, c, corner[c]) || hk_in_layer(w, c, corner[c] + HK_SIDE);
  }
  w->field->bounds(w->field->self, low, high, range);
  return range[1] < w->options->level || (range[0] >= w->options->level && !layer);
}

bool hk_block_at_border(const hk_surface_work *w, size_t number, const uint16_t *inside, size_t *point) {
  size_t corner[3];
  bool border = false;
  hk_block_corner(w, number, corner);
  for (int c = 0; c < 3; c++) border = border || corner[c] == 0 || corner[c] + HK_SIDE >= w->grid->points[c];
  for (*point = 0; border && *point < HK_BLOCK_POINTS; ++*point) {
    size_t at[3] = {*point % HK_POINTS, *point / HK_POINTS % HK_POINTS, *point / (HK_POINTS * HK_POINTS)};
    unsigned row = inside[*point / HK_POINTS];
    if (row == 0) *point += HK_SIDE; /* to its last point */
    if (!(row >> at[0] & 1)) continue;
    for (int c = 0; c < 3; c++)
      if (corner[c] + at[c] == 1 || corner[c] + at[c] == w->grid->points[c]) return true;
  }
  return false;
}

enum { FULL_ROW = (1 << HK_POINTS) - 1 };

bool hk_block_mixed(const uint16_t *inside) {
  unsigned any = 0, all = FULL_ROW;
  for (size_t row = 0; row < HK_BLOCK_ROWS; row++) any |= inside[row], all &= inside[row];
  return any != 0 && all != FULL_ROW;
}

/* Whether the surface crosses no cell between four rows of points. */
static bool is_plain(const uint16_t *row) {
  unsigned any = row[0] | row[1] | row[HK_POINTS] | row[HK_POINTS + 1];
  unsigned all = row[0] & row[1] & row[HK_POINTS] & row[HK_POINTS + 1];
  return any == 0 || all == FULL_ROW;
}

static unsigned count_bits(unsigned byte) {
  byte -= byte >> 1 & 0x55;
  byte = (byte & 0x33) + (byte >> 2 & 0x33);
  return (byte + (byte >> 4)) & 15;
}

void hk_block_count(const hk_surface_work *w, hk_surface_block *b) {
  static const uint8_t along_axes = 1 << 0 | 1 << 1 | 1 << 3;
  uint8_t directions = w->options->method == HK_MARCHING_CUBES ? along_axes : 127;
  b->vertices = b->triangles = 0;
  memset(b->crossed, 0, sizeof b->crossed);
  for (unsigned k = 0; k < HK_BLOCK_CELLS; k++) {
    unsigned row = k / 64 * HK_POINTS + k / 8 % 8;
    if (k % 8 == 0 && is_plain(b->inside + row)) { /* `before` of points without a vertex is not asked for */
      k += HK_SIDE - 1;
      continue;
    }
    unsigned mask = hk_cell_mask(b->inside, row, k % 8);
    b->before[k] = (uint16_t)b->vertices;
    b->crossed[k] = (uint8_t)((mask >> 1 ^ (mask & 1 ? 127 : 0)) & directions);
    b->vertices += count_bits(b->crossed[k]);
    b->triangles += w->cases[mask].triangles;
  }
}

typedef struct neighbours { /* bit c: the next block on axis c */
  const hk_surface_block *of[8];
} neighbours;

static neighbours find_neighbours(const hk_surface_work *w, size_t number) {
  neighbours n = {{NULL}};
  size_t corner[3];
  hk_block_corner(w, number, corner);
  for (size_t k = 0; k < 8; k++) {
    size_t at[3];
    bool exists = true;
    for (size_t c = 0; c < 3; c++) {
      at[c] = corner[c] / HK_SIDE + (k >> c & 1);
      exists = exists && at[c] < w->blocks[c];
    }
    uint32_t slot = exists ? w->slot[(at[2] * w->blocks[1] + at[1]) * w->blocks[0] + at[0]] : hk_no_slot;
    n.of[k] = slot == hk_no_slot ? NULL : &w->block[slot];
  }
  return n;
}

static uint32_t vertex(const neighbours *n, unsigned x, unsigned y, unsigned z, unsigned edge) {
  x += edge & 1, y += edge >> 1 & 1, z += edge >> 2 & 1; /* up to 8, the first point of the next block */
  const hk_surface_block *b = n->of[x / HK_SIDE | (y / HK_SIDE) << 1 | (z / HK_SIDE) << 2];
  unsigned point = (z % HK_SIDE * HK_SIDE + y % HK_SIDE) * HK_SIDE + x % HK_SIDE, direction = edge >> 3;
  unsigned lower = b->crossed[point] & ((1U << (direction - 1)) - 1);
  return (uint32_t)(b->first_vertex + b->before[point] + count_bits(lower));
}

void hk_block_triangles(const hk_surface_work *w, size_t slot) {
  const hk_surface_block *b = &w->block[slot];
  neighbours n = find_neighbours(w, b->number);
  uint32_t(*triangle)[3] = w->found.triangle + b->first_triangle;
  for (unsigned k = 0; k < HK_BLOCK_CELLS; k++) {
    const unsigned cell[3] = {k % 8, k / 8 % 8, k / 64}, row = cell[2] * HK_POINTS + cell[1];
    if (cell[0] == 0 && is_plain(b->inside + row)) {
      k += HK_SIDE - 1;
      continue;
    }
    const hk_cell_case *c = &w->cases[hk_cell_mask(b->inside, row, cell[0])];
    uint32_t number[64];
    for (unsigned e = 0; e < c->edges; e++) number[c->used[e]] = vertex(&n, cell[0], cell[1], cell[2], c->used[e]);
    for (unsigned t = 0; t < c->triangles; t++, triangle++)
      for (int corner = 0; corner < 3; corner++) (*triangle)[corner] = number[c->edge[t][corner]];
  }
}
