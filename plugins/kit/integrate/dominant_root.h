/* The growth factor of a real polynomial in u = lambda - 1 from the roots that mostly set it, in less than half the
 * time that all roots take: the pair of the motion itself, next to u = 0, by Bairstow's method, or the real root next
 * to lambda = -1, where explicit methods begin to grow, by Newton's method from lambda = -2. That the others are
 * smaller is shown by the recursion of Schur and Cohn (Marden, Geometry of Polynomials, 1966, section 43), without
 * finding them. */
#ifndef HK_DOMINANT_ROOT_H
#define HK_DOMINANT_ROOT_H

#include <math.h>
#include <stdbool.h>

enum { HK_DOMINANT_DEGREE = 12, HK_DOMINANT_STEPS = 12 };
static const double hk_dominant_close = 1e-8;      /* of the last step, whose square is left */
static const double hk_dominant_margin = 1 - 1e-6; /* far above the error of the roots of a quotient */

/* Divides c by u^2 - r u - s: the quotient in b[2] to b[degree], the remainder b[1] (u - r) + b[0]. */
static inline void hk_divide_quadratic(int degree, const double *c, double r, double s, double *b) {
  b[degree] = c[degree];
  b[degree - 1] = c[degree - 1] + r * b[degree];
  for (int k = degree - 2; k >= 0; k--) b[k] = c[k] + r * b[k + 1] + s * b[k + 2];
}

/* Finds the quadratic factor next to u = 0, and the quotient as above. It begins as if the others were 0 in lambda, by
 * the first terms of c/(1 + u)^(degree - 2). */
static inline bool hk_slow_factor(int degree, const double *c, double *r, double *s, double *b) {
  double more[HK_DOMINANT_DEGREE + 1];
  double others = degree - 2, second = c[2] - others * c[1] + others * (others + 1) / 2 * c[0];
  *r = -(c[1] - others * c[0]) / second, *s = -c[0] / second;
  for (int i = 0; i < HK_DOMINANT_STEPS; i++) {
    hk_divide_quadratic(degree, c, *r, *s, b);
    hk_divide_quadratic(degree, b, *r, *s, more);
    double by = more[2] * more[2] - more[1] * more[3];
    double dr = (b[0] * more[3] - b[1] * more[2]) / by, ds = (b[1] * more[1] - b[0] * more[2]) / by;
    *r += dr, *s += ds;
    if (fabs(dr) + fabs(ds) <= hk_dominant_close * (fabs(*r) + fabs(*s))) {
      hk_divide_quadratic(degree, c, *r, *s, b);
      return true;
    }
  }
  return false;
}

/* The larger |1 + u| of the roots of u^2 - r u - s. */
static inline double hk_pair_growth(double r, double s) {
  double apart = r * r / 4 + s;
  if (apart <= 0) return sqrt(1 + r - s);
  double larger = r / 2 + copysign(sqrt(apart), r);
  return fmax(fabs(1 + larger), fabs(1 - s / larger));
}

/* The root that Newton's method finds from *u on. */
static inline bool hk_real_root(int degree, const double *c, double *u) {
  for (int i = 0; i < HK_DOMINANT_STEPS; i++) {
    double p = c[degree], d = 0;
    for (int k = degree - 1; k >= 0; k--) d = d * *u + p, p = p * *u + c[k];
    double step = p / d;
    *u -= step;
    if (fabs(step) <= hk_dominant_close * fabs(*u)) return true;
  }
  return false;
}

/* Whether all roots have |1 + u| < radius. Each step leaves a polynomial with the same number of roots outside of the
 * circle. */
static inline bool hk_roots_within(int degree, const double *c, double radius) {
  double a[HK_DOMINANT_DEGREE + 1], power = 1;
  for (int k = 0; k <= degree; k++) a[k] = c[k];
  for (int k = 0; k < degree; k++)
    for (int j = degree - 1; j >= k; j--) a[j] -= a[j + 1]; /* in lambda */
  for (int k = 0; k <= degree; k++, power *= radius) a[k] *= power;
  for (int n = degree; n > 0; n--) {
    double part = a[0] / a[n];
    if (!(fabs(part) < 1)) return false;
    for (int k = 1, m = n - 1; k <= m; k++, m--) {
      double low = a[k], high = a[m];
      a[k] = low - part * high, a[m] = high - part * low;
    }
    a[n] -= part * a[0];
    for (int k = 0; k < n; k++) a[k] = a[k + 1];
  }
  return true;
}

/* NAN where other roots set the growth factor, or may. 3 <= degree <= HK_DOMINANT_DEGREE. */
static inline double hk_dominant_growth(int degree, const double *c) {
  double b[HK_DOMINANT_DEGREE + 1], r, s, u = -3;
  double growth = hk_slow_factor(degree, c, &r, &s, b) ? hk_pair_growth(r, s) : NAN;
  if (growth > 0 && hk_roots_within(degree - 2, b + 2, growth * hk_dominant_margin)) return growth;
  if (!hk_real_root(degree, c, &u)) return NAN;
  growth = fabs(1 + u);
  b[degree] = c[degree];
  for (int k = degree - 1; k > 0; k--) b[k] = c[k] + u * b[k + 1];
  return hk_roots_within(degree - 1, b + 1, growth * hk_dominant_margin) ? growth : NAN;
}

#endif
