/* One tetrahedron with linear shape functions: its shape at rest, and the constant deformation gradient in it. */
#ifndef HK_TETRAHEDRON_H
#define HK_TETRAHEDRON_H

#include <stdint.h>

typedef struct hk_tetrahedron {
  double slope[4][3]; /* 1/m, the gradients of the members' shape functions at rest; their sum is 0 */
  double volume;      /* m^3, at rest: positive where 1, 2, 3 run against the clock seen from 0 outside their plane */
} hk_tetrahedron;

/* Positive where x_1 - x_0, x_2 - x_0, x_3 - x_0 are right-handed, m^3. */
double hk_tetrahedron_volume(const double *x, const uint32_t member[4]);
void hk_tetrahedron_slopes(const double *x, const uint32_t member[4], double slope[4][3]); /* of its volume, m^2 */
/* The slopes are infinite or NaN where the volume is 0. */
hk_tetrahedron hk_tetrahedron_of(const double *x, const uint32_t member[4]);
double hk_tetrahedron_longest(const double *x, const uint32_t member[4]); /* m, its longest edge */

/* F = sum of y_m slope_m^T, 3 x 3: the deformation gradient of positions y = x, its rate of velocities. */
void hk_tetrahedron_gradient(const hk_tetrahedron *, const double *y, const uint32_t member[4], double F[9]);
/* load_m = -volume P slope_m, N, for a stress P, Pa. */
void hk_tetrahedron_load(const hk_tetrahedron *, const double P[9], double (*load)[3]);
/* K_mq = volume slope_m^T H slope_q, 12 x 12, for a derivative H of P by F, 9 x 9. */
void hk_tetrahedron_matrix(const hk_tetrahedron *, const double H[81], double K[144]);

#endif
