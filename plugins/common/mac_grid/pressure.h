/* Poisson's equation of a liquid's pressure on the cells of a grid, and its solution by conjugate gradients, with the
 * modified incomplete Cholesky factors of level 0 where there are few cells (Bridson 2015, section 5.3; Gustafsson
 * 1978) and a V-cycle where there are many (vcycle.h). The rows are in the order of memory; sums are taken in pieces of
 * fixed length, so that threads do not change bits. */
#ifndef HK_PRESSURE_H
#define HK_PRESSURE_H

#include "plugins/common/gradients/gradients_loop.h"
#include "plugins/common/mac_grid/liquid_grid.h"
#include "plugins/common/mac_grid/moving_walls.h"
#include "plugins/common/mac_grid/vcycle.h"

/* AUTO: by the number of cells. */
typedef enum hk_pressure_way { HK_PRESSURE_AUTO, HK_PRESSURE_FACTORS, HK_PRESSURE_VCYCLE } hk_pressure_way;

typedef struct hk_pressure {
  const hk_host *host;
  size_t most, rows;
  uint32_t *cell;        /* rows: where it is in arrays of the grid */
  uint32_t *next[3];     /* rows: the row beyond it along an axis; `rows`: none */
  uint32_t *prior[3];    /* rows: the row before it; `rows`: none */
  double *diagonal;      /* rows, 1/m^2 */
  double *side[3];       /* rows + 1: the number that stands for that neighbour, positive; 0: there is none */
  double *pivot;         /* rows + 1: 1/sqrt of the factor's diagonal */
  double *b;             /* rows: the right-hand side */
  double *x;             /* rows + 1: the first guess, then the solution */
  double *r, *z, *s, *q; /* rows + 1 */
  uint32_t *part;        /* rows: number of the connected part, from 0 */
  double *sums;          /* of pieces */
  int iterations;        /* of the last solution */
  hk_moving_walls walls; /* what bodies add to the matrix; of none of them count is 0 */
  hk_gradients_loop loop;
  hk_pressure_way way; /* asked for */
  bool cycles;         /* the V-cycle is the preconditioner */
  hk_vcycle vcycle;
  int axis[3]; /* of the vcycle's axes */
  double unit; /* 1/m^2, by which the vcycle's numbers are divided */
} hk_pressure;

/* Memory for all cells of the grid. HK_NO_MEMORY: without a message. */
hk_status hk_pressure_open(hk_pressure *, const hk_host *, const hk_liquid_grid *);
void hk_pressure_close(hk_pressure *);
/* The preconditioner of the matrix whose numbers and neighbours have been set. */
void hk_pressure_prepare(hk_pressure *);
/* Solves for x to |r| <= tolerance |b|, or to `floor`, what rounding of b comes to (largest numbers). Of a part that no
 * surface touches, whose matrix is singular, the mean of b is taken away. False: it was not reached. */
bool hk_pressure_solve(hk_pressure *, double tolerance, double floor);

#endif
