/* Finds the points closer together than a reach: for every point the row of the others, by cells. The cells are not
 * stored: points are sorted by the cell they lie in, so memory is proportional to the number of points and of pairs,
 * independent of the volume, and empty space costs nothing. Rows have the same bits for any number of threads. */
#ifndef HK_CELL_LIST_H
#define HK_CELL_LIST_H

#include "core/plugin.h"

typedef struct hk_cell_list {
  size_t n;          /* points of the last build; 0 after one that failed */
  size_t *row_start; /* n + 1 */
  uint32_t *other;   /* row_start[n]: of each i all j != i with |x_j - x_i| < reach, rising */
  /* scratch data of the build; `order` lists the points by cell, the later arrays are in that order */
  size_t room, pairs; /* numbers of points and pairs that fit the memory */
  uint32_t *number;   /* room x 3, by point: number of its cell along x, y and z */
  uint32_t *order, *spare;
  uint64_t *lane;   /* number of the cell along z and y, combined */
  uint32_t *column; /* number of the cell along x */
  double *at;       /* room x 3, one coordinate after the other */
} hk_cell_list;

/* Reserves memory for n points, growing by at least half. HK_NO_MEMORY: there are no rows, n is 0. */
hk_status hk_cell_list_reserve(hk_cell_list *, const hk_host *, size_t n);
/* Computes the rows for the points x (n x 3, finite); reach: 0, or from 1e-150 to 1e150 m. Memory is allocated only
 * when there are more points or pairs than ever before. HK_NO_MEMORY: there are no rows, n is 0. */
hk_status hk_cell_list_build(hk_cell_list *, const hk_host *, const double *x, size_t n, double reach);
void hk_cell_list_free(hk_cell_list *, const hk_host *);

#endif
