/* The Hessian of an energy of the squared distance, E1 H + E2 g g^T with the Hessian H and the gradient g of the
 * squared distance, and its projection onto the definite matrices.
 *
 * In the orthonormal directions t_k in which the nearest points may move, by which w changes by a_k, and with d = delta
 * n, E1 H + E2 g g^T = 2 E1 w w^T (x) (I - sum_k t_k t_k^T) + 4 E2 delta^2 w w^T (x) n n^T
 *                       - 2 E1 sum_k (delta^2 a_k a_k^T (x) n n^T + delta (a_k w^T (x) n t_k^T + w a_k^T (x) t_k n^T))
 * (distance_derivatives.c). All of it lives in at most five of the twelve dimensions: w (x) I and a_k (x) n. In an
 * orthonormal basis of these it is a matrix of 5 x 5, whose eigenvalues come from Jacobi's rotations. */
#include "plugins/common/collision/distance.h"
#include "plugins/common/collision/nearest_frame.h"
#include "plugins/common/space/vector3.h"

#include <string.h>

/* Basis: w/|w|, c_1, c_2 (x) n, and w/|w| (x) the two other axes. */
enum { SIZE = 5 };

typedef struct basis {
  hk_nearest_frame frame;
  double length;  /* |w| */
  double e[3][4]; /* orthonormal weights: w/|w|, c_1, c_2 (0: there is none) */
  double a[2][3]; /* a_k in them */
} basis;

static double dot4(const double a[4], const double b[4]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3];
}

static void open_basis(basis *b, const hk_nearest *near, const double *x) {
  b->frame = hk_nearest_frame_of(near, x);
  b->length = sqrt(dot4(near->w, near->w));
  memset(b->e, 0, sizeof b->e);
  memset(b->a, 0, sizeof b->a);
  for (int i = 0; i < 4; i++) b->e[0][i] = near->w[i] / b->length;
  for (int k = 0; k < b->frame.count; k++) {
    double c[4];
    memcpy(c, b->frame.dw[k], sizeof c);
    for (int l = 0; l <= k; l++) {
      b->a[k][l] = dot4(c, b->e[l]);
      for (int i = 0; i < 4; i++) c[i] -= b->a[k][l] * b->e[l][i];
    }
    double length = b->a[k][k + 1] = sqrt(dot4(c, c));
    for (int i = 0; i < 4; i++) b->e[k + 1][i] = c[i] / length;
  }
}

/* The matrix in the basis. */
static void reduce(const basis *b, double E1, double E2, double A[SIZE][SIZE]) {
  double w = b->length, f = -2 * E1, delta = b->frame.distance;
  memset(A, 0, SIZE * sizeof *A);
  A[0][0] = (2 * E1 + 4 * E2 * delta * delta) * w * w;
  for (int k = 0; k < 2; k++) {
    for (int p = 0; p < 3; p++) {
      for (int q = 0; q < 3; q++) A[p][q] += f * delta * delta * b->a[k][p] * b->a[k][q];
      A[p][3 + k] = A[3 + k][p] = f * delta * w * b->a[k][p];
    }
    A[3 + k][3 + k] = k < b->frame.count ? 0 : 2 * E1 * w * w;
  }
}

/* Rotates the axes p and q so that A_pq vanishes; A becomes R A R^T, and the rows of V the new axes. */
static void rotate(double A[SIZE][SIZE], double V[SIZE][SIZE], int p, int q) {
  double h = (A[q][q] - A[p][p]) / (2 * A[p][q]);
  double t = (h < 0 ? -1 : 1) / (fabs(h) + sqrt(1 + h * h)), c = 1 / sqrt(1 + t * t), s = t * c;
  double change = t * A[p][q];
  A[p][p] -= change, A[q][q] += change, A[p][q] = A[q][p] = 0;
  for (int k = 0; k < SIZE; k++) {
    double a = V[p][k], b = V[q][k];
    V[p][k] = c * a - s * b, V[q][k] = s * a + c * b;
    if (k == p || k == q) continue;
    a = A[p][k], b = A[q][k];
    A[p][k] = A[k][p] = c * a - s * b, A[q][k] = A[k][q] = s * a + c * b;
  }
}

/* Until what is off the diagonal is rounding. Cyclic sweeps converge quadratically: five are usual, and more than ten
 * are not known. */
static void diagonalize(double A[SIZE][SIZE], double V[SIZE][SIZE]) {
  for (int k = 0; k < SIZE * SIZE; k++) V[k / SIZE][k % SIZE] = k / SIZE == k % SIZE;
  for (int sweep = 0; sweep < 20; sweep++) {
    double off = 0, all = 0;
    for (int p = 0; p < SIZE; p++) {
      all += A[p][p] * A[p][p];
      for (int q = p + 1; q < SIZE; q++) off += A[p][q] * A[p][q];
    }
    if (!(off > 1e-32 * all)) return;
    for (int p = 0; p < SIZE; p++)
      for (int q = p + 1; q < SIZE; q++)
        if (A[p][q] != 0) rotate(A, V, p, q);
  }
}

/* y: the vector of 12 with these coordinates in the basis. */
static void expand(const basis *b, const double v[SIZE], double y[12]) {
  const double(*axis)[3] = b->frame.axis;
  for (int i = 0; i < 4; i++) {
    double along = v[0] * b->e[0][i] + v[1] * b->e[1][i] + v[2] * b->e[2][i];
    for (int c = 0; c < 3; c++)
      y[3 * i + c] = along * axis[0][c] + b->e[0][i] * (v[3] * axis[1][c] + v[4] * axis[2][c]);
  }
}

static void projected(const hk_nearest *near, const double *x, double E1, double E2, double H[144]) {
  basis b;
  double A[SIZE][SIZE], V[SIZE][SIZE], y[12];
  open_basis(&b, near, x);
  reduce(&b, E1, E2, A);
  diagonalize(A, V);
  memset(H, 0, 144 * sizeof *H);
  for (int q = 0; q < SIZE; q++) {
    if (!(A[q][q] > 0)) continue;
    expand(&b, V[q], y);
    for (int i = 0; i < 12; i++)
      for (int j = 0; j < 12; j++) H[12 * i + j] += A[q][q] * y[i] * y[j];
  }
}

void hk_distance_energy_hessian(const hk_nearest *near, const double x[12], double E1, double E2, bool definite,
                                double H[144]) {
  if (definite) {
    projected(near, x, E1, E2, H);
    return;
  }
  double g[12];
  hk_distance_gradient(near, g);
  hk_distance_hessian(near, x, H);
  for (int i = 0; i < 12; i++)
    for (int j = 0; j < 12; j++) H[12 * i + j] = E1 * H[12 * i + j] + E2 * g[i] * g[j];
}
