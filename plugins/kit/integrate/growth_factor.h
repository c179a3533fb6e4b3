/* The growth factor of a linear recurrence: the largest modulus of the roots of its characteristic polynomial. */
#ifndef HK_GROWTH_FACTOR_H
#define HK_GROWTH_FACTOR_H

#include "plugins/kit/integrate/dominant_root.h"

#include <complex.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { HK_GROWTH_FACTOR_MAX = 12 };

/* The largest |1 + u| over the roots u of sum c_k u^k, degree <= HK_GROWTH_FACTOR_MAX. In u = lambda - 1 roots next to
 * lambda = 1 remain distinct, where a polynomial in lambda has a double root up to rounding: so the growth factor of
 * the slow modes of a scene is accurate to rounding. */
static inline double hk_polynomial_growth(int degree, const double *c);

/* The same for complex coefficients, which the recurrence of a rotating oscillator has (hk_integrator.rotation). */
static inline double hk_complex_polynomial_growth(int degree, const double _Complex *c);

/* One step of backward differences of order 2, X' = 4/3 X - 1/3 X_before + 2/3 h f(X'), on x'' = -w^2 x - g x'. With
 * u = lambda - 1 the recurrence (3 lambda^2 - 4 lambda + 1)/2 = z lambda^2, for x and v together, becomes
 * (u + 3/2 u^2)^2 + h g (u + 3/2 u^2) (1 + u)^2 + (h w)^2 (1 + u)^4 = 0. */
static inline double hk_bdf2_growth(double hw, double hg);

/* The roots z of z^2 + d z + hw^2 = 0: h times the rates of x'' = -w^2 x - (d/h) x'. The first has the larger modulus.
 */
static inline void hk_oscillator_roots(double hw, double _Complex d, double _Complex root[2]);

/* ---- how ---- */

/* Finds roots by Laguerre's method, started at 0 so that small roots are found first, with deflation; a root that may
 * be the one that grows most is then refined on the whole polynomial. Of real coefficients roots come in pairs. */

enum { HK_LAGUERRE_ITERATIONS = 60 };
static const double hk_growth_rough = 1e-3;   /* far above the error of a root of a deflated polynomial */
static const double hk_laguerre_last = 1e-16; /* square of the last step: it leaves its cube, or half of it next to a
                                                 double root, which rounding makes as uncertain */

/* The complex product without the checks for infinity that `*` makes. */
static inline double complex hk_complex_times(double complex a, double complex b) {
  return creal(a) * creal(b) - cimag(a) * cimag(b) + (creal(a) * cimag(b) + cimag(a) * creal(b)) * I;
}

static inline double hk_complex_square(double complex a) { return creal(a) * creal(a) + cimag(a) * cimag(a); }

static inline double complex hk_complex_over(double complex a, double complex b) {
  return hk_complex_times(a, conj(b)) / hk_complex_square(b);
}

/* A bound of |a| within a factor of root 2, for rounding. */
static inline double hk_complex_about(double complex a) { return fabs(creal(a)) + fabs(cimag(a)); }

/* The root with the positive real part, without the checks for infinity that `csqrt` makes. */
static inline double complex hk_complex_root(double complex a) {
  double larger = sqrt((sqrt(hk_complex_square(a)) + fabs(creal(a))) / 2),
         other = larger > 0 ? cimag(a) / (2 * larger) : 0;
  return creal(a) >= 0 ? larger + other * I : fabs(other) + copysign(larger, other) * I;
}

static inline double complex hk_laguerre(int degree, const double complex *c, double complex u) {
  for (int i = 0; i < HK_LAGUERRE_ITERATIONS; i++) {
    double complex p = c[degree], d = 0, dd = 0; /* value, derivative, half the second one */
    double size = hk_complex_about(c[degree]), distance = hk_complex_about(u);
    for (int k = degree - 1; k >= 0; k--) {
      dd = hk_complex_times(dd, u) + d;
      d = hk_complex_times(d, u) + p;
      p = hk_complex_times(p, u) + c[k];
      size = size * distance + hk_complex_about(c[k]);
    }
    if (hk_complex_square(p) <= 1e-32 * size * size) break; /* zero up to rounding */
    double complex G = hk_complex_over(d, p), GG = hk_complex_times(G, G), H = GG - 2 * hk_complex_over(dd, p);
    double complex root = hk_complex_root((degree - 1) * (degree * H - GG)), plus = G + root, minus = G - root;
    double complex by = hk_complex_square(plus) > hk_complex_square(minus) ? plus : minus,
                   step = by == 0 ? 1 + u : hk_complex_over(degree, by);
    if (i % 10 == 9) step = hk_complex_times(step, 0.3 + 0.4 * I); /* leaves a cycle of iterates */
    u -= step;
    if (hk_complex_square(step) <= hk_laguerre_last * hk_complex_square(u)) break;
  }
  return u;
}

/* Divides by u - root; returns the degree of the quotient. */
static inline int hk_polynomial_divide(int degree, double complex *c, double complex root) {
  double complex next = 0; /* the coefficient of the quotient one degree higher */
  for (int k = degree - 1; k >= 0; k--) next = c[k + 1] = c[k + 1] + hk_complex_times(root, next);
  memmove(c, c + 1, (size_t)degree * sizeof *c);
  return degree - 1;
}

static inline bool hk_polynomial_is_real(int degree, const double complex *c) {
  for (int k = 0; k <= degree; k++)
    if (cimag(c[k]) != 0) return false;
  return true;
}

/* The quotient by both roots of a pair, which is real again. */
static inline int hk_polynomial_divide_pair(int degree, double complex *c, double complex root) {
  degree = hk_polynomial_divide(degree, c, root);
  degree = hk_polynomial_divide(degree, c, conj(root));
  for (int k = 0; k <= degree; k++) c[k] = creal(c[k]);
  return degree;
}

/* A root of a polynomial that is left: of two roots the larger one. */
static inline double complex hk_polynomial_root(int degree, const double complex *c) {
  if (degree > 2) return hk_laguerre(degree, c, 0);
  if (degree == 1) return -hk_complex_over(c[0], c[1]);
  double complex root = hk_complex_root(hk_complex_times(c[1], c[1]) - 4 * hk_complex_times(c[2], c[0]));
  double complex plus = c[1] + root, minus = c[1] - root;
  return -hk_complex_over(hk_complex_square(plus) > hk_complex_square(minus) ? plus : minus, 2 * c[2]);
}

static inline double hk_complex_polynomial_growth(int degree, const double complex *c) {
  double complex left[HK_GROWTH_FACTOR_MAX + 1];
  double growth = 0;
  while (degree > 0 && c[degree] == 0) degree--;
  while (degree > 0 && c[0] == 0) {
    growth = 1;
    c++;
    degree--;
  }
  bool real = hk_polynomial_is_real(degree, c);
  memcpy(left, c, (size_t)(degree + 1) * sizeof *c);
  for (int rest = degree; rest > 0;) {
    double complex root = hk_polynomial_root(rest, left);
    bool most = sqrt(hk_complex_square(1 + root)) > growth * (1 - hk_growth_rough);
    if (rest < degree && most) root = hk_laguerre(degree, c, root);
    double factor = sqrt(hk_complex_square(1 + root));
    if (isnan(factor)) return NAN;
    growth = fmax(growth, factor);
    bool pair = real && rest > 1 && fabs(cimag(root)) > 1e-6 * fabs(creal(root));
    rest = pair ? hk_polynomial_divide_pair(rest, left, root)
                : hk_polynomial_divide(rest, left, real ? creal(root) : root);
  }
  return growth;
}

/* The growth factor of a cubic with real coefficients from its real root near -1, by Newton's method, and the quadratic
 * that is left, whose roots 1 + u have the product 1 - p + q. NAN where that is not sharp: where the root is not found
 * or not alone, and next to 1 + 2e-7, where growth begins for largest_step.c. A limit takes some thousand growth
 * factors, and a scene of few particles some hundred steps. */
static inline double hk_cubic_growth(const double *c) {
  double u = -1, slope = 0, step = 1;
  for (int i = 0; i < 12 && fabs(step) > 1e-9 * fabs(u); i++) {
    slope = (3 * c[3] * u + 2 * c[2]) * u + c[1];
    step = (((c[3] * u + c[2]) * u + c[1]) * u + c[0]) / slope;
    u -= step;
  }
  if (!(fabs(step) <= 1e-9 * fabs(u)) || !(fabs(slope) > 1e-2 * fabs(c[3]) * (1 + u * u))) return NAN;
  double q = -c[0] / (c[3] * u), p = (q - c[1] / c[3]) / u, rest = p * p / 4 - q, larger = 0;
  if (rest > 0) larger = -p / 2 - copysign(sqrt(rest), p);
  double pair = rest > 0 ? fmax(fabs(1 + larger), fabs(1 + q / larger)) : sqrt(1 - p + q);
  double growth = fmax(fabs(1 + u), pair);
  return growth < 1 + 0.5e-7 || growth > 1 + 3.5e-7 ? growth : NAN;
}

static inline double hk_polynomial_growth(int degree, const double *c) {
  bool whole = degree >= 3 && c[degree] != 0 && c[0] != 0;
  double growth = !whole ? NAN : degree == 3 ? hk_cubic_growth(c) : hk_dominant_growth(degree, c);
  if (!isnan(growth)) return growth;
  double complex copy[HK_GROWTH_FACTOR_MAX + 1];
  for (int k = 0; k <= degree; k++) copy[k] = c[k];
  return hk_complex_polynomial_growth(degree, copy);
}

static inline double hk_bdf2_growth(double hw, double hg) {
  double a = hg, b = hw * hw;
  const double c[] = {b, a + 4 * b, 1 + 3.5 * a + 6 * b, 3 + 4 * a + 4 * b, 2.25 + 1.5 * a + b};
  return hk_polynomial_growth(4, c);
}

static inline void hk_oscillator_roots(double hw, double complex d, double complex root[2]) {
  double complex apart = csqrt(hk_complex_times(d, d) - 4 * hw * hw), plus = d + apart, minus = d - apart;
  root[0] = -(hk_complex_square(plus) > hk_complex_square(minus) ? plus : minus) / 2;
  root[1] = root[0] == 0 ? 0 : hk_complex_over(hw * hw, root[0]); /* their product is hw^2 */
}

#endif
