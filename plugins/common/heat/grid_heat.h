/* Heat between particles through the cells of a grid. Enthalpies go to the centres of cells with the bilinear or
 * trilinear weights of a particle-in-cell method, one implicit step between the cells follows (implicit_heat.h), and
 * the particles get its changes with the same weights: so sum m h is kept to rounding. What is finer than the cells,
 * which such a grid does not see, decays at the rate pi^2 D/cell^2, D the largest diffusivity, of the shortest wave
 * that it knows. What the particles of a cell lack of its change afterwards they get in a second round, so that
 * resolved fields keep their order, 2. A particle whose share of that would make it warmer or colder than all that is
 * about it (the molten one of a cell that melts, beside solid ones) leaves it to the others of its cells. */
#ifndef HK_GRID_HEAT_H
#define HK_GRID_HEAT_H

#include "plugins/common/heat/implicit_heat.h"
#include "plugins/common/mac_grid/liquid_grid.h"

/* A face of the box, low x, high x, low y, ...: heat comes through it at a temperature, or as a flux, or not at all. */
typedef struct hk_heat_face {
  double temperature, flux; /* K, 0: none; W/m^2 */
} hk_heat_face;

typedef struct hk_grid_heat {
  hk_liquid_grid grid; /* without arrays */
  hk_implicit_heat cells;
  hk_heat_law law;
  hk_heat_face face[6];
  double density; /* kg/m^3 */
  double tolerance;
  double *mass, *sum; /* size: kg; of a kind of numbers with the mass, then their mean */
  double *room[2];    /* size: J, that particles of a cell could lose and gain within what is about them */
  uint32_t *row;      /* size: of the cells; HK_LIQUID_NONE: nothing is there */
  uint32_t *cell;     /* rows */
} hk_grid_heat;

/* The grid has been laid. HK_NO_MEMORY: with a message. */
hk_status hk_grid_heat_open(hk_grid_heat *, const hk_host *);
void hk_grid_heat_close(hk_grid_heat *, const hk_host *);
/* change, given: n, J/kg, of the listed particles in tau, s, what they get, and of that from faces; finer: n, J/kg, of
 * it, what decayed that is finer than cells. x: n x 3, m; mass: n, kg; h: n, J/kg; over: n, for its own use.
 * HK_NOT_CONVERGED: with a message. */
hk_status hk_grid_heat_step(hk_grid_heat *, const uint32_t *index, size_t count, const double *x, const double *mass,
                            const double *h, double tau, double *change, double *given, double *over);

#endif
