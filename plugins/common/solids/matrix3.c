/* Jacobi's rotations, for both decompositions: each makes two columns (of F, by one-sided rotations after Hestenes
 * 1958) or one pair of entries (of A) orthogonal, and sweeps converge quadratically. They are as accurate as the
 * numbers allow for singular matrices too, and take no square of the condition. Golub and Van Loan, Matrix
 * computations, 8.5 and 8.6.3.
 */
#include "plugins/common/solids/matrix3.h"

#include <float.h>
#include <math.h>
#include <stdbool.h>

enum { SWEEPS = 20 }; /* six do for 3 x 3 matrices */

static const int PAIR[3][2] = {{0, 1}, {0, 2}, {1, 2}};

/* Cosine and sine of the rotation that makes [[p, r], [r, q]] diagonal, by less than 45 degrees. */
static void rotation(double p, double q, double r, double *c, double *s) {
  double zeta = (q - p) / (2 * r), t = 1 / (fabs(zeta) + sqrt(1 + zeta * zeta));
  if (zeta < 0) t = -t;
  *c = 1 / sqrt(1 + t * t);
  *s = *c * t;
}

/* The columns a and b of M: (a, b) <- (c a - s b, s a + c b). */
static void turn_columns(double M[9], int a, int b, double c, double s) {
  for (int r = 0; r < 3; r++) {
    double x = M[3 * r + a], y = M[3 * r + b];
    M[3 * r + a] = c * x - s * y;
    M[3 * r + b] = s * x + c * y;
  }
}

static double column_product(const double M[9], int a, int b) {
  return M[a] * M[b] + M[3 + a] * M[3 + b] + M[6 + a] * M[6 + b];
}

static void set_identity(double M[9]) {
  for (int e = 0; e < 9; e++) M[e] = e % 4 == 0;
}

/* Turns two columns so that they are orthogonal; false: they were, to rounding. */
static bool make_orthogonal(double M[9], double V[9], int a, int b) {
  double p = column_product(M, a, a), q = column_product(M, b, b), r = column_product(M, a, b), c, s;
  if (!(fabs(r) > DBL_EPSILON * sqrt(p * q)) || r * r < DBL_MIN) return false;
  rotation(p, q, r, &c, &s);
  turn_columns(M, a, b, c, s);
  turn_columns(V, a, b, c, s);
  return true;
}

/* Sets the column a of U, that of a singular value of 0, to a unit vector that is orthogonal to the columns before. */
static void complete(double U[9], int a, int columns[3]) {
  double best[3] = {0}, most = 0;
  for (int axis = 0; axis < 3; axis++) {
    double v[3] = {axis == 0, axis == 1, axis == 2}, square = 0;
    for (int twice = 0; twice < 2; twice++)
      for (int k = 0; k < a; k++) {
        double along = 0;
        for (int r = 0; r < 3; r++) along += v[r] * U[3 * r + columns[k]];
        for (int r = 0; r < 3; r++) v[r] -= along * U[3 * r + columns[k]];
      }
    for (int r = 0; r < 3; r++) square += v[r] * v[r];
    if (square <= most) continue;
    most = square;
    for (int r = 0; r < 3; r++) best[r] = v[r];
  }
  for (int r = 0; r < 3; r++) U[3 * r + columns[a]] = best[r] / sqrt(most);
}

/* The largest column first, so that those without a direction come last. */
static void sort_columns(const double s[3], int columns[3]) {
  for (int k = 0; k < 3; k++) columns[k] = k;
  for (int k = 0; k < 3; k++) {
    int a = PAIR[k][0], b = PAIR[k][1], swap = columns[a];
    if (s[columns[a]] < s[columns[b]]) columns[a] = columns[b], columns[b] = swap;
  }
}

void hk_matrix3_svd(const double F[9], double U[9], double s[3], double V[9]) {
  int columns[3];
  bool turned = true;
  double largest = 0;
  for (int e = 0; e < 9; e++) largest = fmax(largest, fabs(F[e]));
  for (int e = 0; e < 9; e++) U[e] = largest > 0 ? F[e] / largest : 0; /* so that no square is too large or small */
  set_identity(V);
  for (int sweep = 0; sweep < SWEEPS && turned; sweep++) {
    turned = false;
    for (int k = 0; k < 3; k++) turned |= make_orthogonal(U, V, PAIR[k][0], PAIR[k][1]);
  }
  for (int k = 0; k < 3; k++) s[k] = sqrt(column_product(U, k, k));
  sort_columns(s, columns);
  for (int k = 0; k < 3; k++) {
    int a = columns[k];
    if (s[a] > DBL_EPSILON)
      for (int r = 0; r < 3; r++) U[3 * r + a] /= s[a];
    else
      complete(U, k, columns);
    s[a] *= largest;
  }
}

void hk_matrix3_eigen(const double A[9], double value[3], double Q[9]) {
  double M[9] = {A[0], A[1], A[2], A[1], A[4], A[5], A[2], A[5], A[8]};
  bool turned = true;
  set_identity(Q);
  for (int sweep = 0; sweep < SWEEPS && turned; sweep++) {
    turned = false;
    for (int k = 0; k < 3; k++) {
      int a = PAIR[k][0], b = PAIR[k][1];
      double p = M[4 * a], q = M[4 * b], r = M[3 * a + b], c, s;
      if (!(fabs(r) > DBL_EPSILON * (fabs(p) + fabs(q)) / 4) || fabs(r) < DBL_MIN) continue;
      rotation(p, q, r, &c, &s);
      turn_columns(M, a, b, c, s);
      for (int e = 0; e < 3; e++) { /* the rows, by the transpose */
        double x = M[3 * a + e], y = M[3 * b + e];
        M[3 * a + e] = c * x - s * y;
        M[3 * b + e] = s * x + c * y;
      }
      turn_columns(Q, a, b, c, s);
      turned = true;
    }
  }
  for (int k = 0; k < 3; k++) value[k] = M[4 * k];
}

double hk_matrix3_cofactor(const double F[9], double G[9]) {
  for (int r = 0; r < 3; r++) {
    const double *a = F + 3 * ((r + 1) % 3), *b = F + 3 * ((r + 2) % 3);
    for (int c = 0; c < 3; c++) G[3 * r + c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
  }
  return F[0] * G[0] + F[1] * G[1] + F[2] * G[2];
}
