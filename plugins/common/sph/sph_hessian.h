/* The stiffness of a liquid whose energy is a sum over its particles of functions of their densities,
 *     K = sum_i b_i g_i g_i^T + a_i H_i,   g_i = d rho_i/dx,   H_i = d2 rho_i/dx2,
 * a_i and b_i the first and second derivative of the energy by rho_i. Two particles that have a neighbour in common act
 * on each other, so a row has blocks for all within two kernels: in a plane about 110 of a kernel of 3 spacings, in
 * space 740, of which K and D take 100 kB a particle. Bounds without blocks come from the same sum. */
#ifndef HK_SPH_HESSIAN_H
#define HK_SPH_HESSIAN_H

#include "plugins/common/sph/sph_sums.h"

/* Which blocks there are, row by row: those of row i are column[row_start[i]] to column[row_start[i + 1] - 1], rising.
 */
typedef struct hk_sph_ring {
  size_t *row_start; /* n + 1 */
  uint32_t *column, *mark;
  size_t rows_room, room, mark_room;
  uint64_t number;  /* of the neighbours that they are from; 0: none */
  hk_status failed; /* of the last naming */
} hk_sph_ring;

/* What the sum is of. */
typedef struct hk_sph_bends {
  const double *slope, *bend; /* n: a_i, J m^3/kg; b_i, J m^6/kg^2; 0: none */
  bool definite;              /* of the second part only what makes it stiffer, pair by pair */
} hk_sph_bends;

void hk_sph_ring_name(hk_sph_ring *, hk_sph *, const hk_view *view, hk_pattern *into);
/* K of the ring's blocks, N/m, after the slopes and bends of these positions. */
hk_status hk_sph_ring_add(const hk_sph_ring *, const hk_sph_rows *, const hk_sph_bends *, const hk_view *view,
                          const hk_blocks *into);
/* block (n x 6: xx, xy, xz, yy, yz, zz) += P_i with u.K u <= sum_i u_i.P_i u_i. */
void hk_sph_bound_pairs(const hk_sph_rows *, const hk_sph_bends *, const hk_view *view, double (*block)[6]);

#endif
