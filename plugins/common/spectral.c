/* Spectral radius by Gelfand's formula, |M^N|^(1/N), with N = 2^28 by repeated squaring and rescaling. It needs no
 * eigenvectors, so it is safe for defective matrices, whose N^(1/N) is 1 + 7e-8. */
#include "plugins/common/spectral.h"

#include <math.h>
#include <string.h>

enum { SQUARINGS = 28 };

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
