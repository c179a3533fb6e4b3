/* A V-cycle for the pressure of a liquid: the preconditioner with which conjugate gradients take about as many
 * iterations on a large grid as on a small one. Each level has half the cells of the one before along each axis, as
 * whole blocks of eight; between two blocks is half the sum of the numbers between their cells, which is the equation
 * discretised anew with cells of twice the size and the same walls (half: Braess 1995, Computing 55, 379). Corrections
 * are linear between blocks that are joined (Kwak 1999, SIAM J. Sci. Comput. 21, 552), and residuals go to the coarse
 * level by the transpose; Jacobi's sweeps before and after are the same, so the cycle is symmetric and positive
 * definite. As McAdams, Sifakis, Teran 2010, without their pieces at the boundary: walls and surface are in the
 * numbers.
 *
 * Its numbers are of single precision, which is enough for a preconditioner and half the memory. */
#ifndef HK_VCYCLE_H
#define HK_VCYCLE_H

#include "core/plugin.h"

enum { HK_VCYCLE_LEVELS = 34 };

/* One grid, with a layer of cells outside on either side, the first axis along memory. */
typedef struct hk_vcycle_level {
  size_t cells[3], stride[3], size;
  uint32_t *begin, *end; /* of rows: the cells of the liquid are in between; as places in arrays */
  float *side[3];        /* the number that stands for the next cell along an axis, positive; 0: none */
  float *diagonal;       /* 0 where there is no unknown */
  float *inverse;        /* of it; 0 there as well */
  float *x, *y, *b;
} hk_vcycle_level;

typedef struct hk_vcycle {
  const hk_host *host;
  int levels;
  hk_vcycle_level level[HK_VCYCLE_LEVELS];
} hk_vcycle;

/* Bytes for each cell of the grid. */
double hk_vcycle_bytes(void);
/* A grid of so many cells, along memory first. HK_NO_MEMORY: without a message. */
hk_status hk_vcycle_open(hk_vcycle *, const hk_host *, const size_t cells[3]);
void hk_vcycle_close(hk_vcycle *);
/* Before the numbers of another matrix: all of the finest level become 0. Its `side` and `diagonal` are then set. */
void hk_vcycle_clear(hk_vcycle *);
/* The numbers of all levels from those of the finest. */
void hk_vcycle_build(hk_vcycle *);
/* From b of the finest level to x. */
void hk_vcycle_run(hk_vcycle *);

#endif
