/* Jacobian blocks of damped springs, by the layout of spring_kernel.h. With n = d/l the force on j is
 * f = -(k (l - L) + c u.n) n, so for x = x_j - x_i
 *     -df/dx = (k - b) n n^T + b I + (c/l) n (u - (u.n) n)^T,   b = k (1 - L/l) + (c/l) u.n,   -df/dv = c n n^T.
 * The last term of df/dx, due to the rotation of the damping's direction, is the only unsymmetric term:
 * HK_WANT_SYMMETRIC omits it. The other terms have the eigenvalues k, b, b; HK_WANT_DEFINITE replaces a negative b by
 * 0. In a method that linearises once a step the tension k (l - L) in b is the one that its last linearisation foretold
 * (hk_blocks): the multiplier in place of k C, as in Tournier and others 2015, Stable constrained dynamics, ACM TOG 34.
 * At l = 0 there is no direction: the block is k I when L = 0, otherwise 0. */
#ifndef HK_SPRING_BLOCKS_H
#define HK_SPRING_BLOCKS_H

#include "plugins/common/springs/spring_kernel.h"

/* Names four blocks per spring, (i,i), (i,j), (j,i), (j,j), in the layout's order. */
void hk_spring_pattern(const hk_spring_layout *, hk_pattern *pattern);
/* Adds the blocks. Parts run in parallel where they share no particle and thus no block. */
void hk_spring_blocks(const hk_spring_layout *, const hk_host *host, const double *x, const double *v,
                      const hk_blocks *into);

/* J, 1/2 k (l - L)^2, summed in the layout's order, like the bound: neighbours are near in memory. */
double hk_spring_energy(const hk_spring_layout *, const double *x);
/* As hk_force.stiffness_bound, see edge_stiffness.c. */
void hk_spring_stiffness_bound(const hk_spring_layout *, const hk_view *, hk_stiffness_part, double (*block)[6]);

#endif
