/* Finds roots by Laguerre's method, started at 0 so that small roots are found first, with deflation; a root that may
 * be the one that grows most is then refined on the whole polynomial. Of real coefficients roots come in pairs. */
#include "plugins/common/integrate/growth_factor.h"

#include <complex.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { ITERATIONS = 60 };
static const double rough = 1e-3; /* far above the error of a root of a deflated polynomial */

/* The complex product without the checks for infinity that `*` makes. */
static double complex times(double complex a, double complex b) {
  return creal(a) * creal(b) - cimag(a) * cimag(b) + (creal(a) * cimag(b) + cimag(a) * creal(b)) * I;
}

static double square(double complex a) { return creal(a) * creal(a) + cimag(a) * cimag(a); }

static double complex over(double complex a, double complex b) { return times(a, conj(b)) / square(b); }

/* A bound of |a| within a factor of root 2, for rounding. */
static double about(double complex a) { return fabs(creal(a)) + fabs(cimag(a)); }

/* The root with the positive real part, without the checks for infinity that `csqrt` makes. */
static double complex root_of(double complex a) {
  double larger = sqrt((sqrt(square(a)) + fabs(creal(a))) / 2), other = larger > 0 ? cimag(a) / (2 * larger) : 0;
  return creal(a) >= 0 ? larger + other * I : fabs(other) + copysign(larger, other) * I;
}

static double complex laguerre(int degree, const double complex *c, double complex u) {
  for (int i = 0; i < ITERATIONS; i++) {
    double complex p = c[degree], d = 0, dd = 0; /* value, derivative, half the second one */
    double size = about(c[degree]), distance = about(u);
    for (int k = degree - 1; k >= 0; k--) {
      dd = times(dd, u) + d;
      d = times(d, u) + p;
      p = times(p, u) + c[k];
      size = size * distance + about(c[k]);
    }
    if (square(p) <= 1e-32 * size * size) break; /* zero up to rounding */
    double complex G = over(d, p), GG = times(G, G), H = GG - 2 * over(dd, p);
    double complex root = root_of((degree - 1) * (degree * H - GG)), plus = G + root, minus = G - root;
    double complex by = square(plus) > square(minus) ? plus : minus, step = by == 0 ? 1 + u : over(degree, by);
    if (i % 10 == 9) step = times(step, 0.3 + 0.4 * I); /* leaves a cycle of iterates */
    u -= step;
    if (square(step) <= 1e-31 * square(u)) break;
  }
  return u;
}

/* Divides by u - root; returns the degree of the quotient. */
static int divide(int degree, double complex *c, double complex root) {
  double complex next = 0; /* the coefficient of the quotient one degree higher */
  for (int k = degree - 1; k >= 0; k--) next = c[k + 1] = c[k + 1] + times(root, next);
  memmove(c, c + 1, (size_t)degree * sizeof *c);
  return degree - 1;
}

static bool all_real(int degree, const double complex *c) {
  for (int k = 0; k <= degree; k++)
    if (cimag(c[k]) != 0) return false;
  return true;
}

/* The quotient by both roots of a pair, which is real again. */
static int divide_pair(int degree, double complex *c, double complex root) {
  degree = divide(degree, c, root);
  degree = divide(degree, c, conj(root));
  for (int k = 0; k <= degree; k++) c[k] = creal(c[k]);
  return degree;
}

double hk_complex_polynomial_growth(int degree, const double complex *c) {
  double complex left[HK_GROWTH_FACTOR_MAX + 1];
  double growth = 0;
  while (degree > 0 && c[degree] == 0) degree--;
  while (degree > 0 && c[0] == 0) {
    growth = 1;
    c++;
    degree--;
  }
  bool real = all_real(degree, c);
  memcpy(left, c, (size_t)(degree + 1) * sizeof *c);
  for (int rest = degree; rest > 0;) {
    double complex root = laguerre(rest, left, 0);
    bool most = sqrt(square(1 + root)) > growth * (1 - rough);
    if (rest < degree && most) root = laguerre(degree, c, root);
    double factor = sqrt(square(1 + root));
    if (isnan(factor)) return NAN;
    growth = fmax(growth, factor);
    bool pair = real && rest > 1 && fabs(cimag(root)) > 1e-6 * fabs(creal(root));
    rest = pair ? divide_pair(rest, left, root) : divide(rest, left, real ? creal(root) : root);
  }
  return growth;
}

double hk_polynomial_growth(int degree, const double *c) {
  double complex copy[HK_GROWTH_FACTOR_MAX + 1];
  for (int k = 0; k <= degree; k++) copy[k] = c[k];
  return hk_complex_polynomial_growth(degree, copy);
}

double hk_bdf2_growth(double hw, double hg) {
  double a = hg, b = hw * hw;
  const double c[] = {b, a + 4 * b, 1 + 3.5 * a + 6 * b, 3 + 4 * a + 4 * b, 2.25 + 1.5 * a + b};
  return hk_polynomial_growth(4, c);
}

void hk_oscillator_roots(double hw, double complex d, double complex root[2]) {
  double complex apart = csqrt(times(d, d) - 4 * hw * hw), plus = d + apart, minus = d - apart;
  root[0] = -(square(plus) > square(minus) ? plus : minus) / 2;
  root[1] = root[0] == 0 ? 0 : over(hw * hw, root[0]); /* their product is hw^2 */
}
