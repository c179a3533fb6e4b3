/* Finds the points closer together than a reach: for every point the row of the others, by cells. Memory is
 * proportional to the number of points and of pairs, independent of the volume: where there are many more cells than
 * points, cells share numbers. Rows have the same bits for any number of threads. */
#ifndef HK_CELL_LIST_H
#define HK_CELL_LIST_H

#include "plugins/common/space/cell_grid.h"

typedef struct hk_cell_list {
  size_t n;          /* points of the last build; 0 after one that failed */
  size_t *row_start; /* n + 1 */
  uint32_t *other;   /* row_start[n]: of each i all j != i with |x_j - x_i| < reach, rising */
  /* scratch data of the build */
  size_t room, pairs; /* numbers of points and pairs that fit the memory */
  hk_cell_order order;
  uint32_t *cell_begin; /* of each cell, and behind the last: the first of its points in `order` */
  double *at;           /* room x 3, one coordinate after the other, in this order */
} hk_cell_list;

/* Reserves memory for n points, growing by at least half. HK_NO_MEMORY: there are no rows, n is 0. */
hk_status hk_cell_list_reserve(hk_cell_list *, const hk_host *, size_t n);
/* Computes the rows for the points x (n x 3, finite); reach: 0, or from 1e-150 to 1e150 m. Memory is allocated only
 * when there are more points or pairs than ever before. HK_NO_MEMORY: there are no rows, n is 0. */
hk_status hk_cell_list_build(hk_cell_list *, const hk_host *, const double *x, size_t n, double reach);
/* The rows of the first `rows` points alone, among all; those of the others are empty. */
hk_status hk_cell_list_build_first(hk_cell_list *, const hk_host *, const double *x, size_t n, size_t rows,
                                   double reach);
void hk_cell_list_free(hk_cell_list *, const hk_host *);

#endif
