/* One implicit step of heat between cells of a substance that may melt: the enthalpies h, J/kg, for which
 *     M_i (h_i - h0_i) = tau (sum over j of g_ij (theta(h_j) - theta(h_i)) + g_wi (theta_w - theta(h_i)) + q_i),
 * with theta the integral of the conductivity over the temperature (heat_law.h), which does not fall as h rises. So
 * there is one solution for any tau, no cell becomes warmer than the warmest, and fronts need no switch (Elliott 1981,
 * On the finite element approximation of an elliptic variational inequality arising from an implicit time
 * discretization of the Stefan problem, IMA J. Numer. Anal. 1, 115). It is found by sweeps of Gauss and Seidel, each
 * cell's equation being solved exactly, which a short tau needs alone; a long one has Newton's steps between them, on
 * the cells that have a temperature to change, by conjugate gradients. The heat that cells get is the sum of the ways'
 * flows, so what one gives the other gets to rounding, wherever the iteration stops. */
#ifndef HK_IMPLICIT_HEAT_H
#define HK_IMPLICIT_HEAT_H

#include "plugins/common/gradients/gradients_loop.h"
#include "plugins/common/heat/heat_law.h"

enum { HK_HEAT_SIDES = 6 };

typedef struct hk_implicit_heat {
  const hk_host *host;
  size_t most, rows;                /* cells that there is memory for; of this step */
  double *mass, *before;            /* rows: M, kg; h0, J/kg */
  uint32_t (*other)[HK_HEAT_SIDES]; /* rows: the neighbours; the row itself where there is none */
  double (*way)[HK_HEAT_SIDES];     /* rows: g, m; 0 where there is none; the same from both of its ends */
  double *wall_way, *source;        /* rows: the sum of g_w, m; of g_w theta_w and q, W */
  double *h;                        /* rows: the solution, J/kg */
  double *heat, *given;             /* rows: J/kg, what the cell gets; of it, what walls and sources give */
  double *potential, *diagonal;     /* rows, of the iteration: theta, W/m; of Newton's matrix */
  double *vectors;                  /* most x 5 */
  double tau;                       /* s */
  const hk_heat_law *law;
  hk_gradients_loop loop;
  int sweeps, steps, iterations; /* of the last solution: of Gauss and Seidel, of Newton, and of gradients in these */
} hk_implicit_heat;

/* Memory for so many cells, also again for another number; what was there is lost. HK_NO_MEMORY: with a message. */
hk_status hk_implicit_heat_open(hk_implicit_heat *, const hk_host *, size_t most);
void hk_implicit_heat_close(hk_implicit_heat *);
/* From what is set of the rows, tau and the law to h, heat and given. tolerance: of what a cell's equation is off by,
 * by the largest at the start. HK_NOT_CONVERGED: with a message. */
hk_status hk_implicit_heat_solve(hk_implicit_heat *, double tolerance);

#endif
