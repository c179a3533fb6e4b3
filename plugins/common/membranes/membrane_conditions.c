/* Membranes as elements, E = 1/2 c11 sum C^2 over three numbers C of each triangle, so that C is a strain:
 * baraff_witkin  |f_u| - 1,  sqrt(c22/c11) (|f_v| - 1),  sqrt(c66/c11) c
 * stvk           e_u + r e_v,  sqrt(c22/c11 - r^2) e_v,  sqrt(c66/c11) c,  r = c12/c11 (Cholesky's factor).
 * Viscous forces -damping c11 (dC/dt) grad C are then those of membrane_model.h. */
#include "plugins/common/membranes/membrane.h"

#include "plugins/kit/vector3.h"

/* Gradients by the corners of a number with the derivatives p and q by f_u and f_v. */
static void to_corners(const hk_membrane *m, size_t k, const double p[3], const double q[3], double (*g)[3]) {
  for (int c = 0; c < 3; c++) {
    g[1][c] = m->row[HK_B0][k] * p[c] + m->row[HK_B1][k] * q[c];
    g[2][c] = m->row[HK_B2][k] * p[c] + m->row[HK_B3][k] * q[c];
    g[0][c] = -(g[1][c] + g[2][c]);
  }
}

static void scale(double to[3], double s, const double a[3]) {
  for (int c = 0; c < 3; c++) to[c] = s * a[c];
}

/* Strains along u and v, and their derivatives s f_u, s f_v. */
static void stretches(hk_membrane_model model, hk_metric g, double e[2], double s[2]) {
  const double a[2] = {g.a, g.b};
  for (int d = 0; d < 2; d++) {
    e[d] = model == HK_STVK ? (a[d] - 1) / 2 : sqrt(a[d]) - 1;
    s[d] = model == HK_STVK ? 1 : a[d] > HK_MEMBRANE_TINY ? hk_inverse_length(a[d]) : 0;
  }
}

void hk_membrane_conditions(const void *self, const double *x, size_t begin, size_t end, double *C, double (*dC)[3]) {
  const hk_membrane *m = self;
  for (size_t k = begin; k < end; k++, C += 3, dC += 9) {
    hk_elasticity c = hk_membrane_elasticity(m, k);
    double f[2][3], e[2], s[2], p[3], q[3], r = c.c12 / c.c11, v = sqrt(c.c22 / c.c11 - r * r), w = sqrt(c.c66 / c.c11);
    const double none[3] = {0};
    hk_membrane_deformation(m, k, x, f);
    hk_metric g = hk_membrane_metric((const double(*)[3])f);
    stretches(m->model, g, e, s);
    C[0] = e[0] + r * e[1], C[1] = v * e[1], C[2] = w * g.c;
    scale(p, s[0], f[0]), scale(q, r * s[1], f[1]);
    to_corners(m, k, p, q, dC);
    scale(q, v * s[1], f[1]);
    to_corners(m, k, none, q, dC + 3);
    scale(p, w, f[1]), scale(q, w, f[0]);
    to_corners(m, k, p, q, dC + 6);
  }
}
