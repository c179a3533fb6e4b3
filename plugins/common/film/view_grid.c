#include "plugins/common/film/view_grid.h"

#include <math.h>
#include <string.h>

enum { GAP = 2 }; /* pixels between cells, at least; what is left over makes them wider */

static hk_view_grid with_columns(size_t count, int columns, int width, int height) {
  int rows = ((int)count + columns - 1) / columns;
  hk_view_grid m = {count, columns, rows, 0, 0, width, height};
  m.width = (width - GAP * (columns - 1)) / columns, m.height = (height - GAP * (rows - 1)) / rows;
  return m;
}

static double fault(const hk_view_grid *m) {
  double empty = m->columns * m->rows - (double)m->count;
  return fabs(log(3. * m->width / (4. * m->height))) + log(2) * empty;
}

hk_view_grid hk_view_grid_for(size_t count, int width, int height) {
  hk_view_grid best = with_columns(count, 1, width, height);
  for (int columns = 2; columns <= (int)count; columns++) {
    hk_view_grid other = with_columns(count, columns, width, height);
    bool fits = other.width > 0 && other.height > 0;
    if (fits && (best.height <= 0 || fault(&other) < fault(&best))) best = other;
  }
  return best;
}

/* Cells are evenly spaced from one edge of the picture to the other. */
static int place(int k, int cells, int full, int cell) { return cells == 1 ? 0 : k * (full - cell) / (cells - 1); }

void hk_view_grid_put(const hk_view_grid *m, size_t k, const unsigned char *cell, unsigned char *picture) {
  int left = place((int)k % m->columns, m->columns, m->full_width, m->width);
  int bottom = place(m->rows - 1 - (int)k / m->columns, m->rows, m->full_height, m->height);
  for (int y = 0; y < m->height; y++)
    memcpy(picture + ((size_t)(bottom + y) * (size_t)m->full_width + (size_t)left) * 4,
           cell + (size_t)y * (size_t)m->width * 4, (size_t)m->width * 4);
}
