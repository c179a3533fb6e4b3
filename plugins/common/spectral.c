/* Spectral radius by Gelfand's formula, |M^N|^(1/N), with N = 2^45 by repeated squaring and rescaling. It needs no
 * eigenvectors, so it is safe for defective matrices, whose N^(1/N) is 1 + 1e-12. Roots by Laguerre's method from 0,
 * which finds small roots first, with deflation; every root is then refined on the whole polynomial. */
#include "plugins/common/spectral.h"

#include <complex.h>
#include <math.h>
#include <string.h>

enum { SQUARINGS = 45, ITERATIONS = 60 };

static double largest(int n, const double *A) {
  double m = 0;
  for (int k = 0; k < n * n; k++) m = fmax(m, fabs(A[k]));
  return m;
}

double hk_spectral_radius(int n, const double *M) {
  double A[HK_SPECTRAL_MAX * HK_SPECTRAL_MAX], B[HK_SPECTRAL_MAX * HK_SPECTRAL_MAX], logarithm = 0, weight = 1;
  memcpy(A, M, (size_t)(n * n) * sizeof *A);
  for (int k = 0; k < SQUARINGS; k++) {
    double m = largest(n, A);
    if (m == 0) return 0;
    logarithm += weight * log(m);
    weight /= 2;
    for (int i = 0; i < n; i++)
      for (int j = 0; j < n; j++) {
        double sum = 0;
        for (int l = 0; l < n; l++) sum += A[n * i + l] / m * (A[n * l + j] / m);
        B[n * i + j] = sum;
      }
    memcpy(A, B, (size_t)(n * n) * sizeof *A);
  }
  double m = largest(n, A);
  return m == 0 ? 0 : exp(logarithm + weight * log(m));
}

static double complex laguerre(int degree, const double complex *c, double complex u) {
  for (int i = 0; i < ITERATIONS; i++) {
    double complex p = c[degree], d = 0, dd = 0; /* value, derivative, half the second one */
    for (int k = degree - 1; k >= 0; k--) {
      dd = dd * u + d;
      d = d * u + p;
      p = p * u + c[k];
    }
    if (p == 0) break;
    double complex G = d / p, H = G * G - 2 * dd / p, root = csqrt((degree - 1) * (degree * H - G * G));
    double complex plus = G + root, minus = G - root, by = cabs(plus) > cabs(minus) ? plus : minus;
    double complex step = by == 0 ? 1 + u : degree / by;
    if (i % 10 == 9) step *= 0.3; /* out of a rare cycle */
    u -= step;
    if (cabs(step) <= 3e-16 * cabs(u)) break;
  }
  return u;
}

double hk_polynomial_growth(int degree, const double *c) {
  double complex whole[HK_SPECTRAL_MAX + 1], left[HK_SPECTRAL_MAX + 1];
  double growth = 0;
  while (degree > 0 && c[degree] == 0) degree--;
  while (degree > 0 && c[0] == 0) {
    growth = 1;
    c++;
    degree--;
  }
  for (int k = 0; k <= degree; k++) left[k] = whole[k] = c[k];
  for (int rest = degree; rest > 0; rest--) {
    double complex root = laguerre(degree, whole, laguerre(rest, left, 0)), carry = left[rest];
    growth = fmax(growth, cabs(1 + root));
    for (int k = rest - 1; k >= 0; k--) {
      double complex kept = left[k];
      left[k] = carry;
      carry = kept + carry * root;
    }
  }
  return growth;
}
