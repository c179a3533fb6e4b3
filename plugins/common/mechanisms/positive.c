#include "plugins/common/mechanisms/positive.h"

#include <math.h>
#include <string.h>

enum { N = HK_POSITIVE_ROWS, SWEEPS = 30 };

static double off_diagonal(const double *A) {
  double sum = 0;
  for (int r = 0; r < N; r++)
    for (int c = 0; c < N; c++) sum += r == c ? 0 : A[N * r + c] * A[N * r + c];
  return sum;
}

static void turn_rows(double *A, int p, int q, double c, double s) {
  for (int k = 0; k < N; k++) {
    double a = A[N * p + k], b = A[N * q + k];
    A[N * p + k] = c * a - s * b;
    A[N * q + k] = s * a + c * b;
  }
}

static void turn_columns(double *A, int p, int q, double c, double s) {
  for (int k = 0; k < N; k++) {
    double a = A[N * k + p], b = A[N * k + q];
    A[N * k + p] = c * a - s * b;
    A[N * k + q] = s * a + c * b;
  }
}

/* Turns rows and columns so that A_pq vanishes; the rows of V are the directions. */
static void rotate(double *A, double *V, int p, int q) {
  if (A[N * p + q] == 0) return;
  double theta = (A[N * q + q] - A[N * p + p]) / (2 * A[N * p + q]);
  double t = copysign(1, theta) / (fabs(theta) + sqrt(theta * theta + 1)), c = 1 / sqrt(t * t + 1);
  turn_rows(A, p, q, c, t * c);
  turn_columns(A, p, q, c, t * c);
  turn_rows(V, p, q, c, t * c);
}

void hk_without_negative(double *A) {
  double V[N * N] = {0}, size = 0, D[N * N];
  for (int e = 0; e < N * N; e++) size += A[e] * A[e];
  for (int k = 0; k < N; k++) V[(N + 1) * k] = 1;
  memcpy(D, A, sizeof D);
  for (int sweep = 0; sweep < SWEEPS && off_diagonal(D) > 1e-30 * size; sweep++)
    for (int p = 0; p < N; p++)
      for (int q = p + 1; q < N; q++) rotate(D, V, p, q);
  for (int k = 0; k < N; k++)
    for (int r = 0; r < N && D[(N + 1) * k] < 0; r++)
      for (int c = 0; c < N; c++) A[N * r + c] -= D[(N + 1) * k] * V[N * k + r] * V[N * k + c];
}
