/* The viscosity of a liquid's cells where it differs from particle to particle. */
#ifndef HK_CELL_VISCOSITY_H
#define HK_CELL_VISCOSITY_H

#include "plugins/common/mac_grid/liquid_grid.h"

/* In `create`: finds what the plugin with that label publishes as `local_viscosity`, *values, n, Pa s, and makes room
 * for *cell, size. `constant`: another viscosity, Pa s, which is to be 0. HK_BAD_PARAM: it is not, or nothing publishes
 * one; HK_NO_MEMORY. */
hk_status hk_cell_viscosity_open(const hk_host *, const hk_model *, const char *label, double constant, size_t size,
                                 const double *const **values, double **cell);

/* Particles by cells: those of cell c are particle[start[c]] to particle[start[c + 1] - 1], places in `index`, which
 * has the scene's. */
typedef struct hk_cell_particles {
  const uint32_t *start, *particle, *index;
} hk_cell_particles;

/* cell: size, Pa s, of each cell the geometric mean of its particles' viscosities, and of one without particles that of
 * its neighbours with some; 0: it has none either. viscosity: of the scene's particles, Pa s; those not above 0 do not
 * count. */
void hk_cell_viscosity(const hk_liquid_grid *, const hk_host *, const hk_cell_particles *, const double *viscosity,
                       double *cell);

/* The harmonic mean of those above 0, by which a shear across layers of the cells has its stress; 0: there are none. */
static inline double hk_viscosity_between(const double *cell, const size_t *at, int cells) {
  double sum = 0;
  int count = 0;
  for (int k = 0; k < cells; k++)
    if (cell[at[k]] > 0) sum += 1 / cell[at[k]], count++;
  return count ? count / sum : 0;
}

#endif
