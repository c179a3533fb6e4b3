/* Groups of two to four particles at fixed distances, eight side by side: their steps and their factors. */
#ifndef HK_RIGID_BUNDLES_H
#define HK_RIGID_BUNDLES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { HK_RIGID_BUNDLE = 8 };
#define HK_RIGID_AT(p, q) ((p) * ((p) + 1) / 2 + (q)) /* the place of an entry of F */

/* Groups of one size, side by side: the numbers of particle i or pair p of the l-th are at [i][l], [p][l]. Pairs are
 * (0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (2, 3). Lanes beyond `used` repeat the last group. */
typedef struct hk_rigid_bundle {
  int size, used; /* particles of a group, 2 to 4; groups */
  uint32_t particle[4][HK_RIGID_BUNDLE], equation[6][HK_RIGID_BUNDLE];
  double weight[4][HK_RIGID_BUNDLE];                                 /* inverse masses, 1/kg */
  double square[6][HK_RIGID_BUNDLE], per_length[6][HK_RIGID_BUNDLE]; /* L^2, m^2; 1/L, 1/m */
  double factor[21][HK_RIGID_BUNDLE]; /* lower triangle of F, A = F F^T, by rows, its diagonal as reciprocals */
} hk_rigid_bundle;

/* Fills factor, square and per_length of a lane from the squares of the distances, whose weights are set; false: the
 * equations are dependent. */
bool hk_rigid_bundle_factorize(hk_rigid_bundle *, int lane, const double square[4][4]);
/* See hk_constraint_table; n x 3 each. False: a group did not converge; x and v of the
 * bundle are as they were. */
bool hk_rigid_bundle_shake(int width, const hk_rigid_bundle *, const double *from, double h, double *x, double *v);
/* lambda of its equations becomes `by` times the impulse. */
void hk_rigid_bundle_rattle(int width, const hk_rigid_bundle *, const double *x, double by, double *v, double *lambda);

#endif
