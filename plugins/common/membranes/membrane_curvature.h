/* Second derivatives of the energies of membrane_model.h: with the elasticity times the area,
 *     d^2E/df_u^2 = uu.i I + uu.ff f f^T + uu.fg (f g^T + g f^T) + uu.gg g g^T,    f = f_u, g = f_v,
 * the same for vv, and d^2E/df_u df_v = uv.i I + uv.ff f f^T + uv.fg f g^T + uv.gf g f^T + uv.gg g g^T.
 *
 * Definite ones: baraff_witkin has the closed forms of Kim 2020, for each condition by itself. A stretch has the
 * eigenvalues c (1 - 1/|f|) across f, which is clamped at 0, and c along it. The shear 1/2 c66 c^2 has the positive
 * ones l = (a + b + sqrt((a + b)^2 + 12 c^2))/2 with (c f + l g, c g + l f), and |c| twice, with the vectors (w, s w),
 * s the sign of c, w across d = f + s g; the others are left out. neo_hookean is the same in all directions: in
 * the frame in which c = 0 its matrix falls apart into the stresses along the normal, the two stretches, and the turn
 * and the shear between them (Smith, de Goes and Kim 2019), each of which is projected. stvk: S (x) I is projected, by
 * the eigenvalues of S, and the rest, which has none below 0, is kept: above the projection of the whole by no more
 * than the pressure in the plane. */
#ifndef HK_MEMBRANE_CURVATURE_H
#define HK_MEMBRANE_CURVATURE_H

#include "plugins/common/membranes/membrane_model.h"

typedef struct hk_curvature {
  struct {
    double i, ff, fg, gg;
  } uu, vv;
  struct {
    double i, ff, fg, gf, gg;
  } uv;
} hk_curvature;

/* A symmetric matrix of two rows without its negative eigenvalues. */
HK_MEMBRANE_INLINE hk_stress hk_positive_part(hk_stress s) {
  double mean = (s.uu + s.vv) / 2, d = (s.uu - s.vv) / 2, r = sqrt(d * d + s.uv * s.uv);
  double high = mean + r > 0 ? mean + r : 0, low = mean - r > 0 ? mean - r : 0;
  double even = (high + low) / 2, part = (high - low) / 2 / (r > 0 ? r : 1);
  return (hk_stress){even + part * d, even - part * d, part * s.uv};
}

/* `elastic` g_x g_y^T of the strains x, y alone: of stvk, and of damping. */
HK_MEMBRANE_INLINE hk_curvature hk_curvature_of_strains(hk_elasticity e) {
  return (hk_curvature){{0, e.c11, 0, e.c66}, {0, e.c66, 0, e.c22}, {0, 0, e.c12, e.c66, 0}};
}

HK_MEMBRANE_INLINE void hk_curvature_add_stress(hk_curvature *k, hk_stress s) {
  k->uu.i += s.uu, k->vv.i += s.vv, k->uv.i += s.uv;
}

HK_MEMBRANE_INLINE void hk_curvature_add_definite_shear(hk_curvature *k, double c66, hk_metric g) {
  double both = g.a + g.b, c = g.c, l = (both + sqrt(both * both + 12 * c * c)) / 2;
  double norm = (c * c + l * l) * both + 4 * c * c * l, q = c66 * l / (norm > HK_MEMBRANE_TINY ? norm : 1);
  double s = c < 0 ? -1 : 1, h = c66 * s * c / 2, dd = both + 2 * s * c, o = h / (dd > HK_MEMBRANE_TINY ? dd : 1);
  double own = q * c * c - o, other = q * l * l - o, mixed = q * c * l - s * o;
  k->uu.i += h, k->uu.ff += own, k->uu.fg += mixed, k->uu.gg += other;
  k->vv.i += h, k->vv.ff += other, k->vv.fg += mixed, k->vv.gg += own;
  k->uv.i += s * h, k->uv.ff += mixed, k->uv.fg += own, k->uv.gf += other, k->uv.gg += mixed;
}

HK_MEMBRANE_INLINE hk_curvature hk_curvature_baraff_witkin(hk_elasticity m, hk_metric g, bool definite) {
  double u = hk_inverse_length(g.a), v = hk_inverse_length(g.b), su = m.c11 * (1 - u), sv = m.c22 * (1 - v);
  su = definite && su < 0 ? 0 : su, sv = definite && sv < 0 ? 0 : sv;
  hk_curvature k = {{su, (m.c11 - su) * u * u, 0, 0}, {sv, 0, 0, (m.c22 - sv) * v * v}, {0, 0, 0, 0, 0}};
  if (definite)
    hk_curvature_add_definite_shear(&k, m.c66, g);
  else
    k.uu.gg += m.c66, k.vv.ff += m.c66, k.uv.i += m.c66 * g.c, k.uv.gf += m.c66;
  return k;
}

HK_MEMBRANE_INLINE hk_curvature hk_curvature_stvk(hk_elasticity m, hk_metric g, bool definite) {
  hk_curvature k = hk_curvature_of_strains(m);
  hk_stress s = hk_membrane_stress(HK_STVK, m, g, 0);
  hk_curvature_add_stress(&k, definite ? hk_positive_part(s) : s);
  return k;
}

/* first, second: W' and W''. */
HK_MEMBRANE_INLINE hk_curvature hk_curvature_neo_hookean(double mu, hk_metric g, double first, double second) {
  double aa = 2 * mu * second * g.b * g.b, ab = 2 * mu * (second * g.a * g.b + first), bb = 2 * mu * second * g.a * g.a;
  double ac = -2 * mu * second * g.b * g.c, bc = -2 * mu * second * g.a * g.c;
  double cc = mu * (2 * g.c * g.c * second - first);
  return (hk_curvature){
      {mu * (1 + first * g.b), aa, ac, cc}, {mu * (1 + first * g.a), cc, bc, bb}, {-mu * first * g.c, ac, ab, cc, bc}};
}

/* Where f and g are at right angles, c = 0. */
HK_MEMBRANE_INLINE hk_curvature hk_curvature_neo_hookean_definite(double mu, hk_metric g, double first, double second) {
  double a = g.a, b = g.b, J = sqrt(a * b), s1 = mu * (1 + first * b), s2 = mu * (1 + first * a);
  hk_stress e = hk_positive_part((hk_stress){s1 + 2 * mu * second * a * b * b, s2 + 2 * mu * second * a * a * b,
                                             2 * mu * J * (first + second * a * b)});
  double w = -mu * first * J, x = w > mu ? (mu + w) / 2 : mu, y = w > mu ? x : w;
  double p = a > HK_MEMBRANE_TINY ? 1 / a : 0, q = b > 1e-20 * a && b > HK_MEMBRANE_TINY ? 1 / b : 0, r = sqrt(p * q);
  s1 = s1 > 0 ? s1 : 0, s2 = s2 > 0 ? s2 : 0;
  return (hk_curvature){
      {s1, (e.uu - s1) * p, 0, (x - s1) * q}, {s2, (x - s2) * p, 0, (e.vv - s2) * q}, {0, 0, e.uv * r, y * r, 0}};
}

/* The turn (p, q) into the frame f' = p f + q g, g' = p g - q f with c = 0 and a >= b. */
HK_MEMBRANE_INLINE void hk_principal_turn(hk_metric g, double *p, double *q) {
  double d = (g.a - g.b) / 2, r = sqrt(d * d + g.c * g.c), safe = r > 0 ? r : 1, size = d < 0 ? -d : d;
  double large = sqrt((1 + (r > 0 ? size / safe : 1)) / 2), small = (g.c < 0 ? -g.c : g.c) / safe / (2 * large);
  double turn = d < 0 ? large : small;
  *p = d < 0 ? small : large;
  *q = g.c < 0 ? -turn : turn;
}

#endif
