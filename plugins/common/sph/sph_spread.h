/* How evenly the particles of a liquid are spread: pairs that have come together, and the way to go apart. */
#ifndef HK_SPH_SPREAD_H
#define HK_SPH_SPREAD_H

#include "plugins/common/sph/sph_list.h"
#include "plugins/common/sph/sph_sums.h"

/* Of the particles of the liquid the part whose nearest neighbour of the liquid is closer than half a spacing, but for
 * those at a surface, of which there is none in a liquid that is `full`; 0: there are none. `rows` are those of the
 * view, after hk_sph_begin. */
double hk_sph_paired(const hk_sph_rows *rows, const hk_view *view, bool full);

/* way, n x 3: of each particle of the list's liquid the slope down which the others are fewer, by its mass,
 *     way_i = (R/m_i) sum_j m_i m_j/rho0 (1 + (W_ij/W(dx))^4/5) (-W'/r) (x_i - x_j), without a unit;
 * 0 of others. Lind, Xu, Stansby and Rogers 2012, J. Comput. Phys. 231, equations 19 and 22: particles are shifted by
 * it times an area. Their middle stays where no walls are, as pairs go opposite ways. */
void hk_sph_way_apart(const hk_sph *, const hk_sph_list *, const hk_view *view, double (*way)[3]);

#endif
