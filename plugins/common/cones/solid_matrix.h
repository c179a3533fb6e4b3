/* The matrix 1 + sum of J^T C J over impacts of rigid bodies, six rows a body, as blocks of 3 x 3. */
#ifndef HK_SOLID_MATRIX_H
#define HK_SOLID_MATRIX_H

#include "core/plugin.h"

enum { HK_SOLID_ROWS = 6 };

/* How the difference of both sides of an impact changes with the coordinates of its bodies. */
typedef struct hk_solid_sides {
  uint32_t solid[2];             /* UINT32_MAX: that side stands still */
  double J[2][3][HK_SOLID_ROWS]; /* rows: along n and twice across */
} hk_solid_sides;

typedef struct hk_solid_matrix {
  const hk_host *host;
  hk_matrix A;
  size_t solids;
  size_t *start; /* solids + 1: the neighbours of a body, itself among them, in `neighbour`, rising */
  uint32_t *neighbour;
  size_t *row_start;
  uint32_t *column, *next; /* next: room */
  double *value;
  size_t start_room, neighbour_room, row_room, column_room, next_room, value_room;
} hk_solid_matrix;

/* The pattern of `count` impacts, `stride` bytes apart, whose first member are their sides. HK_NO_MEMORY. */
hk_status hk_solid_matrix_shape(hk_solid_matrix *, size_t solids, const void *first, size_t count, size_t stride);
/* The values become those of 1. */
void hk_solid_matrix_clear(hk_solid_matrix *);
/* += J^T C J of an impact. */
void hk_solid_matrix_add(hk_solid_matrix *, const hk_solid_sides *, const double C[9]);

#endif
