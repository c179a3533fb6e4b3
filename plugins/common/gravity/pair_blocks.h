/* -dF/dx of gravitation between pairs: with d = x_j - x_i, s^2 = d^2 + softening^2, k = G m_i m_j,
 *     K_ii += k (1/s^3 - 3 d d^T/s^5), and minus that at (i, j). */
#ifndef HK_PAIR_BLOCKS_H
#define HK_PAIR_BLOCKS_H

#include "plugins/common/gravity/direct_sum.h"

/* Blocks are those of all pairs, so that their memory limits the number of bodies: 2,000 take some 600 MB. */
enum { HK_PAIR_BLOCKS_MOST = 2000 };

void hk_pair_pattern(const hk_gravity_bodies *, hk_pattern *);
/* x: n x 3; of `view` the masses. */
void hk_pair_jacobian(const hk_gravity_bodies *, const hk_view *view, double G, double softening, const hk_blocks *);

#endif
