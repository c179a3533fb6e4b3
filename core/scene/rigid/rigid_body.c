/* A rigid body as a few particles: masses m/4 at the distances a_k s_k along the principal axes, a_k = sqrt(S_k/m),
 * s = (1,1,1), (1,-1,-1), (-1,1,-1), (-1,-1,1). The sums of their masses, of their first and of their second moments
 * are the body's, and so are energy, momenta and equations of motion, under any forces: the equimomental tetrahedron
 * (Routh, Dynamics of a System of Rigid Bodies I, art. 33 to 38). A flat body is three masses m/3 on an ellipse, at
 * sqrt(2) (a_1 cos u, a_2 sin u) a third of a turn apart; a rod is two masses m/2 at a and -a.
 *
 * The point at the distances p from the centre along the principal axes is sum w_k x_k with
 *     w_k = (1 + sum_j q_kj p_j / a_j^2) / count,
 * since the combinations of the q_k with these are the axes themselves. */
#include "core/scene/rigid/rigid.h"

#include <math.h>
#include <string.h>

static const double least_extent = 1e-6; /* relative to the largest */

/* Jacobi's rotations (Golub and Van Loan, Matrix Computations, 8.5): A becomes diagonal, V has the eigenvectors as
 * columns. What is diagonal stays as it is. */
static void diagonalise(double A[3][3], double V[3][3]) {
  enum { SWEEPS = 50 };
  for (int sweep = 0; sweep < SWEEPS; sweep++) {
    double off = fabs(A[0][1]) + fabs(A[0][2]) + fabs(A[1][2]);
    if (off <= 1e-17 * (fabs(A[0][0]) + fabs(A[1][1]) + fabs(A[2][2]))) return;
    for (int p = 0; p < 2; p++)
      for (int q = p + 1; q < 3; q++) {
        if (A[p][q] == 0) continue;
        double theta = (A[q][q] - A[p][p]) / (2 * A[p][q]);
        double t = (theta < 0 ? -1 : 1) / (fabs(theta) + sqrt(theta * theta + 1)), c = 1 / sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < 3; k++) {
          double x = A[k][p], y = A[k][q];
          A[k][p] = c * x - s * y, A[k][q] = s * x + c * y;
        }
        for (int k = 0; k < 3; k++) {
          double x = A[p][k], y = A[q][k], u = V[k][p], w = V[k][q];
          A[p][k] = c * x - s * y, A[q][k] = s * x + c * y;
          V[k][p] = c * u - s * w, V[k][q] = s * u + c * w;
        }
        A[p][q] = A[q][p] = 0;
      }
  }
}

/* Principal axes by falling second moments; equal ones keep their order. */
static void find_axes(const hk_moments *m, hk_rigid_body *b) {
  double A[3][3], V[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  int order[3] = {0, 1, 2};
  memcpy(A, m->second, sizeof A);
  diagonalise(A, V);
  for (int pass = 0; pass < 2; pass++)
    for (int k = 0; k < 2; k++)
      if (A[order[k + 1]][order[k + 1]] > A[order[k]][order[k]]) {
        int swapped = order[k];
        order[k] = order[k + 1], order[k + 1] = swapped;
      }
  for (int k = 0; k < 3; k++) {
    b->a[k] = sqrt(fmax(0, A[order[k]][order[k]]) / m->mass);
    for (int c = 0; c < 3; c++) b->axes[3 * c + k] = V[c][order[k]];
  }
  const double *P = b->axes;
  double det =
      P[0] * (P[4] * P[8] - P[5] * P[7]) - P[1] * (P[3] * P[8] - P[5] * P[6]) + P[2] * (P[3] * P[7] - P[4] * P[6]);
  for (int c = 0; c < 3 && det < 0; c++) b->axes[3 * c + 2] = -b->axes[3 * c + 2];
}

static void find_places(hk_rigid_body *b) {
  static const double corner[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  static const double third[3][2] = {{0, 1}, {-0.86602540378443864676, -0.5}, {0.86602540378443864676, -0.5}};
  for (size_t i = 0; i < b->count; i++)
    for (int k = 0; k < b->dimensions; k++)
      b->q[i][k] = b->dimensions == 3   ? b->a[k] * corner[i][k]
                   : b->dimensions == 2 ? b->a[k] * third[i][k] * 1.41421356237309504880
                                        : b->a[k] * (i ? -1 : 1);
}

const char *hk_rigid_body_of(const hk_moments *m, hk_rigid_body *b) {
  *b = (hk_rigid_body){.mass = m->mass};
  double size = 0;
  for (int p = 0; p < 9; p++) size += fabs(m->second[p]);
  if (!isfinite(size) || !isfinite(m->mass)) return "mass and moments have to be finite";
  if (!(m->mass > 0)) return "a mass above 0 kg is needed";
  memcpy(b->center, m->center, sizeof b->center);
  find_axes(m, b);
  if (!(b->a[0] > 0)) return "a body without extent does not turn: use scene:particle for it";
  for (b->dimensions = 3; b->a[b->dimensions - 1] <= least_extent * b->a[0]; b->dimensions--)
    b->a[b->dimensions - 1] = 0;
  b->count = (size_t)b->dimensions + 1;
  find_places(b);
  return NULL;
}

double hk_rigid_body_inertia(const hk_rigid_body *b, int k) {
  double p = b->a[(k + 1) % 3], q = b->a[(k + 2) % 3];
  return b->mass * (p * p + q * q);
}

static void turn(const double R[9], const double y[3], double to[3]) {
  for (int c = 0; c < 3; c++) to[c] = R[3 * c] * y[0] + R[3 * c + 1] * y[1] + R[3 * c + 2] * y[2];
}

void hk_rigid_body_place(const hk_rigid_body *b, const double origin[3], const double R[9], const double velocity[3],
                         const double spin[3], double *x, double *v) {
  double center[3];
  turn(R, b->center, center);
  for (size_t i = 0; i < b->count; i++) {
    double inside[3], r[3];
    turn(b->axes, b->q[i], inside);
    turn(R, inside, r);
    for (size_t c = 0, d = 1, e = 2; c < 3; c++, d = (d + 1) % 3, e = (e + 1) % 3) {
      x[3 * i + c] = origin[c] + center[c] + r[c];
      v[3 * i + c] = velocity[c] + spin[d] * r[e] - spin[e] * r[d];
    }
  }
}

double hk_rigid_body_weights(const hk_rigid_body *b, const double y[3], double weight[4]) {
  double p[3] = {0}, off = 0;
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < 3; c++) p[k] += b->axes[3 * c + k] * (y[c] - b->center[c]);
  for (int k = b->dimensions; k < 3; k++) off += p[k] * p[k];
  for (size_t i = 0; i < 4; i++) weight[i] = i < b->count ? 1 : 0;
  for (size_t i = 0; i < b->count; i++) {
    for (int k = 0; k < b->dimensions; k++) weight[i] += b->q[i][k] * p[k] / (b->a[k] * b->a[k]);
    weight[i] /= (double)b->count;
  }
  return sqrt(off);
}
