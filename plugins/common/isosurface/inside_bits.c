/* Which values of an array are inside, one bit each: the array is read once and in order, and blocks are made of bits
 * alone. A row of points along x has a byte for every block and one more; byte k has the points 8 k to 8 k + 7 of the
 * lattice, of which those of the layer are 0. The last byte of a row is 0, or marks a row with a value that is not
 * allowed. */
#include "plugins/common/isosurface/grid_blocks.h"

#include <string.h>

enum { ROWS = 64, BAD_ROW = 128 };

static size_t row_bytes(const hk_surface_work *w) { return w->blocks[0] + 1; }

size_t hk_inside_bytes(const hk_surface_work *w) { return row_bytes(w) * w->grid->points[1] * w->grid->points[2]; }

/* The lattice counts from the layer: point i of the grid is bit i + 1. */
static void pack_row(const double *value, size_t count, double level, uint8_t *bits) {
  size_t i = 0;
  for (; i < 7 && i < count; i++) bits[0] |= (uint8_t)((value[i] >= level) << (i + 1));
  for (; i + 8 <= count; i += 8) {
    uint64_t byte = 0; /* as wide as the values: compilers make vectors of it */
    for (unsigned k = 0; k < 8; k++) byte |= value[i + k] >= level ? (uint64_t)1 << k : 0;
    bits[(i + 1) / 8] = (uint8_t)byte;
  }
  for (; i < count; i++) bits[(i + 1) / 8] |= (uint8_t)((value[i] >= level) << (i + 1) % 8);
}

static void pack_rows(void *context, size_t begin, size_t end, size_t chunk) {
  const hk_surface_work *w = context;
  size_t count = w->grid->points[0];
  (void)chunk;
  for (size_t row = begin; row < end; row++) {
    const double *value = w->field->values + row * count;
    uint8_t *bits = w->bits + row * row_bytes(w);
    int bad = 0;
    for (size_t i = 0; i < count; i++) bad |= !hk_value_allowed(value[i]);
    pack_row(value, count, w->options->level, bits);
    if (bad) bits[w->blocks[0]] = BAD_ROW;
  }
}

bool hk_inside_pack(hk_surface_work *w, size_t bad[3]) {
  size_t rows = w->grid->points[1] * w->grid->points[2], row = 0;
  w->host->parallel_for(w->host, rows, ROWS, pack_rows, w);
  while (row < rows && !(w->bits[row * row_bytes(w) + w->blocks[0]] & BAD_ROW)) row++;
  if (row == rows) return true;
  bad[0] = 0, bad[1] = row % w->grid->points[1], bad[2] = row / w->grid->points[1];
  while (hk_value_allowed(w->field->values[hk_grid_index(w, bad)])) bad[0]++;
  return false;
}

void hk_inside_read(const hk_surface_work *w, size_t number, uint16_t inside[HK_BLOCK_ROWS]) {
  size_t corner[3];
  hk_block_corner(w, number, corner);
  memset(inside, 0, HK_BLOCK_ROWS * sizeof *inside);
  for (size_t k = 0; k < HK_BLOCK_ROWS; k++) {
    size_t y = corner[1] + k % HK_POINTS, z = corner[2] + k / HK_POINTS;
    if (hk_in_layer(w, 1, y) || hk_in_layer(w, 2, z)) continue;
    const uint8_t *bits = w->bits + ((z - 1) * w->grid->points[1] + y - 1) * row_bytes(w) + corner[0] / HK_SIDE;
    inside[k] = (uint16_t)(bits[0] | (bits[1] & 1) << HK_SIDE);
  }
}
