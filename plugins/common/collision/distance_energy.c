/* The Hessian of an energy of the squared distance, E1 H + E2 g g^T with the Hessian H and the gradient g of the
 * squared distance, and its projection onto the definite matrices.
 *
 * Both live in at most five dimensions of the twelve: with the unit vector n of d, and with the derivatives c_k of the
 * weights w by the parameters of the active points (distance.c), they are spanned by w (x) I and c_k (x) n. In an
 * orthonormal basis of these the matrix is 5 x 5, and its eigenvalues come from Jacobi's rotations. */
#include "plugins/common/collision/distance.h"
#include "plugins/common/space/vector3.h"

#include <string.h>

enum { MOST = 5 };

static double dot4(const double a[4], const double b[4]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

/* Orthonormal vectors whose first is along d, or any where d is 0. */
static void frame_of(const double d[3], double t[3][3]) {
  double length = hk_length(d);
  int least = 0;
  memset(t, 0, 9 * sizeof **t);
  if (length > 0)
    for (int c = 0; c < 3; c++) t[0][c] = d[c] / length;
  else
    t[0][0] = 1;
  for (int c = 1; c < 3; c++)
    if (fabs(t[0][c]) < fabs(t[0][least])) least = c;
  double axis[3] = {least == 0, least == 1, least == 2};
  hk_cross(t[1], t[0], axis);
  double l = hk_length(t[1]);
  for (int c = 0; c < 3; c++) t[1][c] /= l;
  hk_cross(t[2], t[0], t[1]);
}

/* Orthonormal weights: those of the nearest points, and what changes them, beside these. Returns their number. */
static int orthonormal_weights(const hk_nearest *near, const double *x, double e[3][4]) {
  double dw[2][4], d[2][3];
  int count = 1 + hk_nearest_directions(near, x, dw, d);
  for (int k = 0; k < count; k++) {
    double c[4];
    memcpy(c, k == 0 ? near->w : dw[k - 1], sizeof c);
    for (int l = 0; l < k; l++) {
      double s = dot4(c, e[l]);
      for (int i = 0; i < 4; i++) c[i] -= s * e[l][i];
    }
    double length = sqrt(dot4(c, c));
    for (int i = 0; i < 4; i++) e[k][i] = c[i] / length;
  }
  return count;
}

/* Q: orthonormal rows that span the range of the Hessian. Returns their number. */
static int basis_of(const hk_nearest *near, const double *x, double Q[MOST][12]) {
  double t[3][3], e[3][4];
  frame_of(near->d, t);
  int weights = orthonormal_weights(near, x, e), rows = 2 + weights;
  for (int q = 0; q < rows; q++)
    for (int k = 0; k < 12; k++) Q[q][k] = q < 3 ? e[0][k / 3] * t[q][k % 3] : e[q - 2][k / 3] * t[0][k % 3];
  return rows;
}

/* A = Q H Q^T */
static void reduce(const double *H, double Q[MOST][12], int rows, double A[MOST][MOST]) {
  for (int p = 0; p < rows; p++) {
    double row[12] = {0};
    for (int i = 0; i < 12; i++)
      for (int j = 0; j < 12; j++) row[j] += Q[p][i] * H[12 * i + j];
    for (int q = 0; q < rows; q++) {
      A[p][q] = 0;
      for (int j = 0; j < 12; j++) A[p][q] += row[j] * Q[q][j];
    }
  }
}

/* Rotates the rows p and q of the basis so that A_pq vanishes; A becomes R A R^T. */
static void rotate(double A[MOST][MOST], double Q[MOST][12], int rows, int p, int q) {
  double h = (A[q][q] - A[p][p]) / (2 * A[p][q]);
  double t = (h < 0 ? -1 : 1) / (fabs(h) + sqrt(1 + h * h)), c = 1 / sqrt(1 + t * t), s = t * c;
  for (int k = 0; k < rows; k++) {
    double a = A[p][k], b = A[q][k];
    A[p][k] = c * a - s * b, A[q][k] = s * a + c * b;
  }
  for (int k = 0; k < rows; k++) {
    double a = A[k][p], b = A[k][q];
    A[k][p] = c * a - s * b, A[k][q] = s * a + c * b;
  }
  for (int k = 0; k < 12; k++) {
    double a = Q[p][k], b = Q[q][k];
    Q[p][k] = c * a - s * b, Q[q][k] = s * a + c * b;
  }
}

/* Until what is off the diagonal is rounding. Cyclic sweeps converge quadratically: five are usual, and more than ten
 * are not known. */
static void diagonalize(double A[MOST][MOST], double Q[MOST][12], int rows) {
  for (int sweep = 0; sweep < 20; sweep++) {
    double off = 0, all = 0;
    for (int p = 0; p < rows; p++)
      for (int q = 0; q < rows; q++) all += A[p][q] * A[p][q], off += p == q ? 0 : A[p][q] * A[p][q];
    if (!(off > 1e-32 * all)) return;
    for (int p = 0; p < rows; p++)
      for (int q = p + 1; q < rows; q++)
        if (A[p][q] != 0) rotate(A, Q, rows, p, q);
  }
}

static void project(const hk_nearest *near, const double *x, double H[144]) {
  double Q[MOST][12], A[MOST][MOST];
  int rows = basis_of(near, x, Q);
  reduce(H, Q, rows, A);
  diagonalize(A, Q, rows);
  memset(H, 0, 144 * sizeof *H);
  for (int q = 0; q < rows; q++)
    for (int i = 0; i < 12 && A[q][q] > 0; i++)
      for (int j = 0; j < 12; j++) H[12 * i + j] += A[q][q] * Q[q][i] * Q[q][j];
}

void hk_distance_energy_hessian(const hk_nearest *near, const double x[12], double E1, double E2, bool definite,
                                double H[144]) {
  double g[12];
  hk_distance_gradient(near, g);
  hk_distance_hessian(near, x, H);
  for (int i = 0; i < 12; i++)
    for (int j = 0; j < 12; j++) H[12 * i + j] = E1 * H[12 * i + j] + E2 * g[i] * g[j];
  if (definite) project(near, x, H);
}
