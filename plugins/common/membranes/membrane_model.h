/* The energies of a membrane. A triangle has the deformation F = [f_u f_v], 3 x 2, by which the warp and the weft of
 * its rest shape became f_u and f_v. All energies are functions of the metric a = f_u.f_u, b = f_v.f_v, c = f_u.f_v
 * alone, so no rotation changes them, and forces follow from the stress S (Piola's second): dE/df_u = S_uu f_u + S_uv
 * f_v, dE/df_v = S_uv f_u + S_vv f_v. Per area at rest:
 *
 * baraff_witkin  1/2 c11 (|f_u| - 1)^2 + 1/2 c22 (|f_v| - 1)^2 + 1/2 c66 c^2, the conditions of Baraff and Witkin 1998
 *     with the weight sqrt(area) in place of area (Kim 2020), by which refinement changes nothing.
 * stvk           1/2 (c11 e_u^2 + 2 c12 e_u e_v + c22 e_v^2 + c66 c^2) with Green's strains e_u = (a - 1)/2,
 *     e_v = (b - 1)/2: St. Venant and Kirchhoff, orthotropic.
 * neo_hookean    1/2 mu (a + b - 2 + W(t)), t = a b - c^2, W = (t^-n - 1)/n, n = nu/(1 - nu): the solid with the energy
 *     1/2 mu (I_1 - 3 + (J^(-2 beta) - 1)/beta), beta = nu/(1 - 2 nu) (Ogden; Blatz and Ko with f = 1) in plane stress,
 *     where the thickness is stretched by t^(-n/2). A strip that is pulled to the length s has the width s^-nu, for any
 *     s; nu = 1/2 is the incompressible one, W = 1/t - 1, and nu = 0 has W = -ln t. Below t = 1/100, a tenth of the
 *     area, W goes on as its parabola: forces stay finite and smooth where a triangle has no area.
 *
 * c11 to c66 in the code are those times the area of the triangle, N m; mu is c66. Viscous stress is `damping`, s,
 * times the elasticity at rest times the rate of strain: of Green's strain, or of |f_u| and |f_v| for baraff_witkin. */
#ifndef HK_MEMBRANE_MODEL_H
#define HK_MEMBRANE_MODEL_H

#include <math.h>
#include <stdbool.h>

typedef enum hk_membrane_model { HK_BARAFF_WITKIN, HK_STVK, HK_NEO_HOOKEAN } hk_membrane_model;

#define HK_MEMBRANE_INLINE static inline __attribute__((always_inline))

/* Below this |f|^2 a direction has no length: its 1/|f| is beyond the range of numbers. */
#define HK_MEMBRANE_TINY 1e-290

/* Numbers of one triangle: of its elasticity, times its area, N m, and its metric. */
typedef struct hk_elasticity {
  double c11, c22, c12, c66;
} hk_elasticity;

typedef struct hk_metric {
  double a, b, c;
} hk_metric;

typedef struct hk_stress {
  double uu, vv, uv;
} hk_stress;

/* W and its derivatives by t. */
typedef struct hk_volume_term {
  double W, first, second;
} hk_volume_term;

static inline hk_volume_term hk_volume_term_exact(double t, double n) {
  double first = -1 / (n == 0 ? t : n == 1 ? t * t : pow(t, n + 1)), lost = log(t);
  return (hk_volume_term){n == 0 ? -lost : expm1(-n * lost) / n, first, -(n + 1) * first / t};
}

static inline hk_volume_term hk_volume_term_at(double t, double n) {
  const double least = 0.01;
  if (t >= least) return hk_volume_term_exact(t, n);
  hk_volume_term w = hk_volume_term_exact(least, n);
  double d = t - least;
  return (hk_volume_term){w.W + d * (w.first + d * w.second / 2), w.first + d * w.second, w.second};
}

/* W' alone. */
static inline double hk_volume_slope(double t, double n) {
  if (t >= 0.01) return -1 / (n == 0 ? t : n == 1 ? t * t : pow(t, n + 1));
  return hk_volume_term_at(t, n).first;
}

/* W'', where W' is there. */
static inline double hk_volume_bend(double t, double n, double slope) {
  return t >= 0.01 ? -(n + 1) * slope / t : hk_volume_term_at(t, n).second;
}

/* 1/|f| for |f|^2 = a; 1, at which there is no stress, where it has no direction. */
HK_MEMBRANE_INLINE double hk_inverse_length(double a) { return 1 / sqrt(a > HK_MEMBRANE_TINY ? a : 1); }

/* slope: W', of neo_hookean. */
HK_MEMBRANE_INLINE hk_stress hk_membrane_stress(hk_membrane_model model, hk_elasticity m, hk_metric g, double slope) {
  if (model == HK_BARAFF_WITKIN)
    return (hk_stress){m.c11 * (1 - hk_inverse_length(g.a)), m.c22 * (1 - hk_inverse_length(g.b)), m.c66 * g.c};
  if (model == HK_NEO_HOOKEAN)
    return (hk_stress){m.c66 * (1 + slope * g.b), m.c66 * (1 + slope * g.a), -m.c66 * slope * g.c};
  double eu = (g.a - 1) / 2, ev = (g.b - 1) / 2;
  return (hk_stress){m.c11 * eu + m.c12 * ev, m.c12 * eu + m.c22 * ev, m.c66 * g.c};
}

/* The viscous elasticity of a triangle, of which stress and power follow: that at rest, seen from its lengths. */
HK_MEMBRANE_INLINE hk_elasticity hk_membrane_viscosity(hk_membrane_model model, hk_elasticity m, hk_metric g,
                                                       double damping) {
  double u = damping, v = damping;
  if (model == HK_BARAFF_WITKIN)
    u *= hk_inverse_length(g.a) * hk_inverse_length(g.a), v *= hk_inverse_length(g.b) * hk_inverse_length(g.b);
  return (hk_elasticity){m.c11 * u, m.c22 * v, m.c12 * damping, m.c66 * damping};
}

/* rate: f_u.df_u/dt, f_v.df_v/dt, dc/dt; of `viscosity`. */
HK_MEMBRANE_INLINE hk_stress hk_membrane_drag(hk_elasticity viscosity, hk_metric rate) {
  return (hk_stress){viscosity.c11 * rate.a + viscosity.c12 * rate.b, viscosity.c12 * rate.a + viscosity.c22 * rate.b,
                     viscosity.c66 * rate.c};
}

/* J */
static inline double hk_membrane_energy(hk_membrane_model model, hk_elasticity m, hk_metric g, double n) {
  double eu = (g.a - 1) / 2, ev = (g.b - 1) / 2;
  if (model == HK_NEO_HOOKEAN) return m.c66 / 2 * (2 * (eu + ev) + hk_volume_term_at(g.a * g.b - g.c * g.c, n).W);
  if (model == HK_BARAFF_WITKIN) eu = sqrt(g.a) - 1, ev = sqrt(g.b) - 1;
  return (m.c11 * eu * eu + 2 * m.c12 * eu * ev + m.c22 * ev * ev + m.c66 * g.c * g.c) / 2;
}

#endif
