/* What is asked of a liquid before it starts: the size of its cells, and whether what is there suits them. */
#ifndef HK_LIQUID_START_H
#define HK_LIQUID_START_H

#include "plugins/common/liquid/liquid.h"

/* m: of cubes or squares with the mean volume of a particle twice the side. */
double hk_liquid_default_cell(const hk_view *, const uint32_t *index, size_t count, double density, const double low[3],
                              const double high[3]);
/* HK_BAD_PARAM, with a message: a particle is outside the box. */
hk_status hk_liquid_check_start(const hk_liquid *, const hk_view *, const uint32_t *index, size_t count);
/* After hk_liquid_find_surface of the first step: the part by which the density of particles within the liquid is off,
 * in the mean or, where their masses say that there are several densities, from place to place. A warning says so; 0:
 * by less than may be, or the liquid has too few cells within to say. Later it would not be seen: it is evened. */
double hk_liquid_off_at_start(const hk_liquid *, const hk_liquid_particles *);
/* x, n x 3. HK_BAD_PARAM, with a message: particles that another liquid keeps out of walls are in the box of this one,
 * whose own are at `own`. */
hk_status hk_liquid_check_isolated(const hk_liquid *, const bool *const *own, const hk_view *, const double *x);
/* Of particles that are born outside of it. */
void hk_liquid_warn_of_births(const hk_liquid *, const hk_view *, const uint32_t *index, size_t count);
/* Of obstacles, and of gaps between them and to the sides of the box, that are thinner than two cells. */
void hk_liquid_warn_of_walls(hk_liquid *);
/* The obstacles and inflows of the scene are its walls; what `carried` says is kept out of them by the liquid. Returns
 * HK_FAILED, with a message, where there is no service of them, HK_BAD_PARAM where there are too many liquids. */
hk_status hk_liquid_find_walls(hk_liquid *, const bool *const *carried);

#endif
