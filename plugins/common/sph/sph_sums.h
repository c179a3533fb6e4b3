/* Sums over the neighbours of a particle of a liquid: its density, how fast that changes, and what pressures do to it.
 */
#ifndef HK_SPH_SUMS_H
#define HK_SPH_SUMS_H

#include "plugins/common/sph/sph_particles.h"

typedef struct hk_sph_rows {
  const hk_sph *sph;
  hk_neighbour_rows rows;
  const hk_periodic_box *box; /* NULL: space is open */
} hk_sph_rows;

/* `box` of these functions is that of the rows, or NULL where the compiler is to know that there is none. */

/* kg/m^3: sum of w_j W, the particle itself included. */
HK_INLINE double hk_sph_density(const hk_sph_rows *t, const hk_periodic_box *box, size_t i) {
  const hk_sph *s = t->sph;
  double sum = s->point[i][3] * s->kernel.amplitude, part[HK_SPH_NEAR];
  hk_sph_near near;
  for (size_t at = t->rows.row_start[i], end = t->rows.row_start[i + 1]; at < end;) {
    hk_sph_gather(s, box, t->rows.other, end, i, &at, &near);
    for (size_t k = 0; k < near.count; k++) part[k] = near.mass[k] * hk_sph_value(&s->kernel, near.r2[k]);
    for (size_t k = 0; k < near.count; k++) sum += part[k];
  }
  return sum;
}

/* sum += (a_i w_j + a_j w_i) (-W'/r) (x_i - x_j): of multipliers a of the densities, -(d rho/d x_i)^T a. */
HK_INLINE void hk_sph_push(const hk_sph_rows *t, const hk_periodic_box *box, size_t i, const double *a, double sum[3]) {
  const hk_sph *s = t->sph;
  double push[HK_SPH_NEAR], own = a[i], mass = s->point[i][3];
  hk_sph_near near;
  for (size_t at = t->rows.row_start[i], end = t->rows.row_start[i + 1]; at < end;) {
    hk_sph_gather(s, box, t->rows.other, end, i, &at, &near);
    for (size_t k = 0; k < near.count; k++) push[k] = own * near.mass[k] + a[near.other[k]] * mass;
    for (size_t k = 0; k < near.count; k++) push[k] *= hk_sph_slope(&s->kernel, near.r2[k]);
    for (size_t k = 0; k < near.count; k++)
      for (int c = 0; c < 3; c++) sum[c] += push[k] * near.d[c][k];
  }
}

/* kg/(m^3 s): d rho_i/dt = -sum w_j (-W'/r) (x_i - x_j).(v_i - v_j). */
HK_INLINE double hk_sph_density_rate(const hk_sph_rows *t, const hk_periodic_box *box, size_t i, const double *v) {
  const hk_sph *s = t->sph;
  double sum = 0, part[HK_SPH_NEAR];
  hk_sph_near near;
  for (size_t at = t->rows.row_start[i], end = t->rows.row_start[i + 1]; at < end;) {
    hk_sph_gather(s, box, t->rows.other, end, i, &at, &near);
    for (size_t k = 0; k < near.count; k++) {
      const double *u = v + 3 * (size_t)near.other[k];
      part[k] = near.d[0][k] * (v[3 * i] - u[0]) + near.d[1][k] * (v[3 * i + 1] - u[1]) +
                near.d[2][k] * (v[3 * i + 2] - u[2]);
    }
    for (size_t k = 0; k < near.count; k++) part[k] *= near.mass[k] * hk_sph_slope(&s->kernel, near.r2[k]);
    for (size_t k = 0; k < near.count; k++) sum -= part[k];
  }
  return sum;
}

#endif
