/* The Hessian of an energy of the squared distance, E1 H + E2 g g^T with the Hessian H and the gradient g of the
 * squared distance, and its projection onto the definite matrices.
 *
 * With the parameters q of the active points (none, one or two), the difference of points d(q) = sum_i w_i(q) x_i is
 * linear in q, and |d|^2 is least at d.d_k = 0, where d_k = dd/dq_k; with G_kl = d_k.d_l
 *     H = 2 (w w^T (x) I - sum_kl (G^-1)_kl u_k u_l^T),   u_k = dw/dq_k (x) d + w (x) d_k,
 * one formula for all kinds and sets of active points.
 *
 * In the orthonormal directions t_k in which the nearest points may move, by which w changes by a_k, and with d = delta
 * n, E1 H + E2 g g^T = 2 E1 w w^T (x) (I - sum_k t_k t_k^T) + 4 E2 delta^2 w w^T (x) n n^T
 *                       - 2 E1 sum_k (delta^2 a_k a_k^T (x) n n^T + delta (a_k w^T (x) n t_k^T + w a_k^T (x) t_k n^T))
 * (G is the unit matrix there). All of it lives in at most five of the twelve dimensions: w (x) I and a_k (x) n. In an
 * orthonormal basis of these it is a matrix of 5 x 5, of which a direction in which the nearest points do not move is
 * an eigenvector. The eigenvalues of the rest, of 1 + 2 count dimensions, come from Jacobi's rotations. */
#include "plugins/common/contact/geometry/distance_form.h"
#include "plugins/common/contact/geometry/nearest_frame.h"
#include "plugins/kit/vector3.h"

#include <string.h>

/* Basis: w/|w|, and for each of `count` directions c_k, all (x) n; then w/|w| (x) these directions. */
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

/* The matrix in the basis; returns its size. */
static int reduce(const basis *b, double E1, double E2, double A[SIZE][SIZE]) {
  int count = b->frame.count;
  double w = b->length, f = -2 * E1, delta = b->frame.distance;
  memset(A, 0, SIZE * sizeof *A);
  A[0][0] = (2 * E1 + 4 * E2 * delta * delta) * w * w;
  for (int k = 0; k < count; k++)
    for (int p = 0; p <= count; p++) {
      for (int q = 0; q <= count; q++) A[p][q] += f * delta * delta * b->a[k][p] * b->a[k][q];
      A[p][1 + count + k] = A[1 + count + k][p] = f * delta * w * b->a[k][p];
    }
  return 1 + 2 * count;
}

/* Rotates the axes p and q so that A_pq vanishes; A becomes R A R^T, and the rows of V the new axes. */
static inline void rotate(int size, double A[SIZE][SIZE], double V[SIZE][SIZE], int p, int q) {
  double d = A[q][q] - A[p][p], twice = 2 * A[p][q], root = sqrt(d * d + twice * twice);
  double t = twice / (d < 0 ? d - root : d + root), c = 1 / sqrt(1 + t * t), s = t * c;
  double change = t * A[p][q];
  A[p][p] -= change, A[q][q] += change, A[p][q] = A[q][p] = 0;
  for (int k = 0; k < size; k++) {
    double a = V[p][k], b = V[q][k];
    V[p][k] = c * a - s * b, V[q][k] = s * a + c * b;
    if (k == p || k == q) continue;
    a = A[p][k], b = A[q][k];
    A[p][k] = A[k][p] = c * a - s * b, A[q][k] = A[k][q] = s * a + c * b;
  }
}

/* The axes of a rotation in the order of a sweep. A weight and the direction that it goes with, c_k and t_k, are
 * strongly bound to each other and hardly to w, whose eigenvalue is that of the distance: they come first. Two sweeps
 * mostly do, where those by rows take three. */
typedef unsigned char axes[2];
static const axes order_of_3[] = {{1, 2}, {0, 1}, {0, 2}},
                  order_of_5[] = {{1, 3}, {2, 4}, {1, 4}, {2, 3}, {1, 2}, {3, 4}, {0, 1}, {0, 2}, {0, 3}, {0, 4}};

static double squares_above_diagonal(int size, double A[SIZE][SIZE]) {
  double sum = 0;
  for (int p = 0; p < size; p++)
    for (int q = p + 1; q < size; q++) sum += A[p][q] * A[p][q];
  return sum;
}

/* Until what is off the diagonal is rounding; sweeps converge quadratically, and more than ten are not known. What is
 * rounding by itself is left as it is. */
static inline void diagonalize(int size, const axes *order, double A[SIZE][SIZE], double V[SIZE][SIZE]) {
  double all = 2 * squares_above_diagonal(size, A);
  for (int p = 0; p < size; p++) all += A[p][p] * A[p][p];
  double least = 1e-17 * sqrt(all);
  for (int sweep = 0; sweep < 20 && squares_above_diagonal(size, A) > 1e-32 * all; sweep++)
    for (int k = 0; k < size * (size - 1) / 2; k++)
      if (fabs(A[order[k][0]][order[k][1]]) > least) rotate(size, A, V, order[k][0], order[k][1]);
}

/* A without its negative eigenvalues. */
static void project(int size, double A[SIZE][SIZE]) {
  double V[SIZE][SIZE], P[SIZE][SIZE] = {{0}};
  for (int k = 0; k < SIZE * SIZE; k++) V[k / SIZE][k % SIZE] = k / SIZE == k % SIZE;
  if (size == 3) diagonalize(3, order_of_3, A, V);
  if (size == 5) diagonalize(5, order_of_5, A, V);
  for (int e = 0; e < size; e++)
    for (int p = 0; p < size && A[e][e] > 0; p++)
      for (int q = 0; q < size; q++) P[p][q] += A[e][e] * V[e][p] * V[e][q];
  memcpy(A, P, sizeof P);
}

/* The form of the matrix A in the basis, and of `other`, the eigenvalue of w (x) the directions that do not move. */
static void expand(const basis *b, double A[SIZE][SIZE], double other, hk_distance_form *f) {
  int count = b->frame.count;
  const double(*t)[3] = b->frame.axis + 1;
  double w = b->length;
  for (int i = 0; i < 4; i++) {
    double u[SIZE] = {0};
    for (int p = 0; p < 1 + 2 * count; p++)
      for (int q = 0; q <= count; q++) u[p] += A[p][q] * b->e[q][i];
    for (int j = 0; j < 4; j++) f->g[i][j] = u[0] * b->e[0][j] + u[1] * b->e[1][j] * (count > 0);
    for (int j = 0; j < 4 && count > 1; j++) f->g[i][j] += u[2] * b->e[2][j];
    for (int c = 0; c < 4; c++) f->q[i][c] = 0;
    for (int k = 0; k < count; k++)
      for (int c = 0; c < 3; c++) f->q[i][c] += u[1 + count + k] / w * t[k][c];
  }
  memset(f->T, 0, sizeof f->T);
  for (int k = 0; k < 2; k++)
    for (int l = 0; l < 2; l++) {
      bool moves = k < count && l < count;
      double value = moves ? A[1 + count + k][1 + count + l] / (w * w) : k == l && k >= count ? other : 0;
      for (int e = 0; e < 9 && value != 0; e++) f->T[e] += value * t[k][e / 3] * t[l][e % 3];
    }
}

void hk_distance_energy_form(const hk_nearest *near, const double x[12], double E1, double E2, bool definite,
                             hk_distance_form *f) {
  basis b;
  double A[SIZE][SIZE], other = 2 * E1;
  open_basis(&b, near, x);
  int size = reduce(&b, E1, E2, A);
  if (definite) project(size, A), other = fmax(other, 0);
  expand(&b, A, other, f);
  memcpy(f->w, near->w, sizeof f->w);
  memcpy(f->n, b.frame.axis[0], 3 * sizeof *f->n);
  f->n[3] = 0;
}

void hk_distance_energy_hessian(const hk_nearest *near, const double x[12], double E1, double E2, bool definite,
                                double H[144]) {
  const size_t slot[4] = {0, 1, 2, 3};
  double row[36];
  hk_distance_form f;
  hk_distance_energy_form(near, x, E1, E2, definite, &f);
  for (int i = 0; i < 4; i++) {
    memset(row, 0, sizeof row);
    hk_distance_form_row(&f, i, slot, row);
    for (int e = 0; e < 36; e++) H[12 * (3 * i + e % 9 / 3) + 3 * (e / 9) + e % 3] = row[e];
  }
}
