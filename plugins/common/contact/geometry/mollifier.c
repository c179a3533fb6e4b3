/* The factor of nearly parallel edges, m(c) of c = |n|^2, n = u x v, for the edges u and v. The derivatives of c are
 *     dc/du = 2 v x n,   dc/dv = 2 n x u,
 *     d2c/du2 = 2 (|v|^2 I - v v^T),   d2c/dv2 = 2 (|u|^2 I - u u^T),   d2c/du dv = 2 (2 u v^T - v u^T - u.v I). */
#include "plugins/common/contact/geometry/distance.h"
#include "plugins/kit/vector3.h"

#include <string.h>

/* The matrix d2c/du2 (from v), and by symmetry d2c/dv2 (from u). */
static double own(const double v[3], int r, int c) { return 2 * ((r == c ? hk_dot(v, v) : 0) - v[r] * v[c]); }

static double mixed(const double u[3], const double v[3], int r, int c) {
  return 2 * (2 * u[r] * v[c] - v[r] * u[c] - (r == c ? hk_dot(u, v) : 0));
}

/* d2c/de_p de_q of the edges e_0 = u and e_1 = v. */
static double second(const double u[3], const double v[3], int p, int q, int r, int c) {
  if (p == q) return own(p == 0 ? v : u, r, c);
  return p == 0 ? mixed(u, v, r, c) : mixed(u, v, c, r);
}

/* The derivative of an edge by x_i is the unit matrix with this sign. */
static int sign_of(int i) { return i % 2 == 0 ? -1 : 1; }

static void hessian(const double u[3], const double v[3], const double by_c[12], double m1, double m2, double H[144]) {
  for (int i = 0; i < 4; i++)
    for (int j = 0; j < 4; j++)
      for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
          H[12 * (3 * i + r) + 3 * j + c] =
              m2 * by_c[3 * i + r] * by_c[3 * j + c] + m1 * sign_of(i) * sign_of(j) * second(u, v, i / 2, j / 2, r, c);
}

double hk_edge_mollifier(const double x[12], double limit, double g[12], double H[144]) {
  double u[3], v[3], n[3], by_edge[2][3], by_c[12];
  hk_subtract(u, x + 3, x);
  hk_subtract(v, x + 9, x + 6);
  hk_cross(n, u, v);
  double part = hk_dot(n, n) / limit;
  if (part >= 1) {
    if (g) memset(g, 0, 12 * sizeof *g);
    if (H) memset(H, 0, 144 * sizeof *H);
    return 1;
  }
  double m1 = 2 * (1 - part) / limit, m2 = -2 / (limit * limit);
  hk_cross(by_edge[0], v, n);
  hk_cross(by_edge[1], n, u);
  for (int k = 0; k < 12; k++) by_c[k] = 2 * sign_of(k / 3) * by_edge[k / 6][k % 3];
  for (int k = 0; k < 12 && g; k++) g[k] = m1 * by_c[k];
  if (H) hessian(u, v, by_c, m1, m2, H);
  return (2 - part) * part;
}
