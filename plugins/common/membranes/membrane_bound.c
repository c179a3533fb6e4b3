/* A bound of a membrane's stiffness. With h_m = |(p_m, q_m)| of the corners, f_u = sum p_m x_m, f_v = sum q_m x_m,
 *     u.K u <= L |sum (p_m, q_m) (x) u_m|^2 <= L (sum h_m r_m) sum h_m/r_m u_m^2
 * for any r_m > 0, by Cauchy and Schwarz; r_m^2 = 1/mass makes the bound of the frequencies smallest. L bounds the
 * eigenvalues of d^2E/d[f g]^2: that of the stress, and that of G C G^T, which are those of C G^T G, by its rows, with
 * the gradients G of the strains, G^T G = ((a, 0, c), (0, b, c), (c, c, a + b)). neo_hookean has a matrix of six rows,
 * of which the same is taken. */
#include "plugins/common/membranes/membrane.h"
#include "plugins/common/membranes/membrane_curvature.h"

/* The largest eigenvalue of C G^T G, at most; C of three rows: strains u, v, shear. */
static double of_strains(const double C[3][3], hk_metric g) {
  const double G[3][3] = {{g.a, 0, g.c}, {0, g.b, g.c}, {g.c, g.c, g.a + g.b}};
  double most = 0;
  for (int r = 0; r < 3; r++) {
    double sum = 0;
    for (int c = 0; c < 3; c++) sum += fabs(C[r][0] * G[0][c] + C[r][1] * G[1][c] + C[r][2] * G[2][c]);
    most = fmax(most, sum);
  }
  return most;
}

static double of_stress(hk_stress s) {
  double d = (s.uu - s.vv) / 2;
  return fmax(0, (s.uu + s.vv) / 2 + sqrt(d * d + s.uv * s.uv));
}

static double of_elasticity(hk_elasticity e, hk_metric g) {
  const double C[3][3] = {{e.c11, e.c12, 0}, {e.c12, e.c22, 0}, {0, 0, e.c66}};
  return of_strains(C, g);
}

static double of_neo_hookean(double mu, hk_metric g, hk_volume_term w) {
  hk_curvature k = hk_curvature_neo_hookean(mu, g, w.first, w.second);
  const double C[3][3] = {{k.uu.ff, k.uv.fg, k.uu.fg}, {k.uv.fg, k.vv.gg, k.vv.fg}, {k.uu.fg, k.vv.fg, k.uu.gg}};
  return of_strains(C, g);
}

/* L of triangle k. */
static double largest(const hk_membrane *m, const double *x, hk_stiffness_part part, size_t k) {
  double f[2][3], n = m->exponent;
  hk_membrane_deformation(m, k, x, f);
  hk_metric g = hk_membrane_metric((const double(*)[3])f);
  hk_elasticity e = hk_membrane_elasticity(m, k), scaled = hk_membrane_viscosity(m->model, e, g, 1);
  hk_volume_term w = {0, 0, 0};
  if (m->model == HK_NEO_HOOKEAN) w = hk_volume_term_at(g.a * g.b - g.c * g.c, n);
  double stress = of_stress(hk_membrane_stress(m->model, e, g, w.first));
  if (part == HK_DAMPING_WHOLE) return m->damping * of_elasticity(scaled, g);
  if (m->model == HK_NEO_HOOKEAN) return stress + of_neo_hookean(e.c66, g, w);
  return part == HK_STIFFNESS_UNDAMPED ? stress : stress + of_elasticity(scaled, g);
}

static double length(double a, double b) { return sqrt(a * a + b * b); }

void hk_membrane_bound(const hk_membrane *m, const hk_view *view, hk_stiffness_part part, double (*block)[6]) {
  for (size_t k = 0; k < m->node.count; k++) {
    const uint32_t *corner = hk_tuple(&m->node, k);
    const double B[4] = {m->row[HK_B0][k], m->row[HK_B1][k], m->row[HK_B2][k], m->row[HK_B3][k]};
    const double h[3] = {length(B[0] + B[2], B[1] + B[3]), length(B[0], B[1]), length(B[2], B[3])};
    double r[3], sum = 0, L = largest(m, view->x, part, k);
    for (int c = 0; c < 3; c++) sum += h[c] * (r[c] = sqrt(view->model->inverse_mass[corner[c]]));
    for (int c = 0; c < 3; c++) {
      if (!(r[c] > 0)) continue;
      double *into = block[corner[c]], value = L * sum * h[c] / r[c];
      into[0] += value, into[3] += value, into[5] += value;
    }
  }
}
