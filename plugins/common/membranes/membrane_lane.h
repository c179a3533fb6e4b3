/* One triangle of a block, of the forces (membrane_kernel.c) and of their products for adjoints
 * (membrane_transposed.c). */
#ifndef HK_MEMBRANE_LANE_H
#define HK_MEMBRANE_LANE_H

#include "plugins/common/membranes/membrane.h"

enum { BLOCK = 64 };

typedef struct deformation {
  double u[3], v[3];
} deformation;

/* That of the sides d, of the triangle r, by its numbers HK_B0 to HK_B3. */
HK_MEMBRANE_INLINE deformation deform(const double number[HK_MEMBRANE_ROWS][BLOCK], const double d[2][3][BLOCK],
                                      int r) {
  deformation f;
  for (int c = 0; c < 3; c++) {
    f.u[c] = number[HK_B0][r] * d[0][c][r] + number[HK_B2][r] * d[1][c][r];
    f.v[c] = number[HK_B1][r] * d[0][c][r] + number[HK_B3][r] * d[1][c][r];
  }
  return f;
}

HK_MEMBRANE_INLINE double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

HK_MEMBRANE_INLINE hk_metric metric(const deformation *f) {
  return (hk_metric){dot(f->u, f->u), dot(f->v, f->v), dot(f->u, f->v)};
}

/* Of the deformations f and their change w. */
HK_MEMBRANE_INLINE hk_metric rate_of(const deformation *f, const deformation *w) {
  return (hk_metric){dot(f->u, w->u), dot(f->v, w->v), dot(f->u, w->v) + dot(f->v, w->u)};
}

#endif
