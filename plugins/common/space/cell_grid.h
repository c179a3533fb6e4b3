/* The cells of a cell list: which number a cell has, and the points in the order of their cells. Cells are slightly
 * wider than the reach, so that all neighbours of a point lie in the 27 cells around it. Cell (x, y, z) has the number
 * x + lane(y, z): in a box that is not much larger than the points are many, lanes follow each other and no two cells
 * share a number; elsewhere lanes begin at a hash of y and z (Teschner and others 2003), so that memory does not grow
 * with the box. Cells that share a number only add candidates. */
#ifndef HK_CELL_GRID_H
#define HK_CELL_GRID_H

#include "core/plugin.h"

enum {
  HK_CELLS_PER_POINT = 4 /* up to which lanes follow each other; there are never more cells, but for the least 4 */
};

typedef struct hk_cell_grid {
  double low[3], width;  /* m, half of the smallest coordinates and of a cell's width */
  size_t cells;          /* numbers of cells are below this */
  uint64_t per_y, per_z; /* a lane begins at per_y y + per_z z, */
  unsigned shift;        /* shifted to the right, modulo the number of cells; 0: lanes follow each other */
} hk_cell_grid;

/* Points in the order of their cells, and of one cell in their own. */
typedef struct hk_cell_order {
  size_t room;         /* points that fit the memory */
  uint32_t *key;       /* number of a point's cell, in this order */
  uint32_t *point;     /* which point it is */
  uint32_t *spare_key; /* scratch data of the sort */
  uint32_t *spare;
  uint32_t *tally;
  double (*extent)[6];
} hk_cell_order;

/* The cell of a coordinate along axis c, from 1, so that the cell before the first exists and belongs to no point. Half
 * of every length, so that the distance of the largest doubles does not overflow. */
static inline uint32_t hk_cell_along(const hk_cell_grid *g, double at, size_t c) {
  return 1 + (uint32_t)((at / 2 - g->low[c]) / g->width);
}

static inline size_t hk_cell_lane(const hk_cell_grid *g, uint64_t y, uint64_t z) {
  return (g->per_y * y + g->per_z * z) >> g->shift;
}

/* Where lanes follow each other the sum is always below the number of cells. */
static inline size_t hk_cell_number(const hk_cell_grid *g, size_t lane, size_t x) {
  return g->shift ? (lane + x) & (g->cells - 1) : lane + x;
}

bool hk_cell_order_reserve(hk_cell_order *, const hk_host *, size_t n); /* n new points; false: no memory */
void hk_cell_order_free(hk_cell_order *, const hk_host *);
/* Chooses the cells for points x (n x 3, n > 0, finite) and a reach, m, and orders the points by them. */
hk_cell_grid hk_cell_order_make(hk_cell_order *, const hk_host *, const double *x, size_t n, double reach);

#endif
