/* Smith, de Goes and Kim, Stable neo-Hookean flesh simulation, ACM TOG 37 (2018), (14): the energy per volume is
 *     W = mu/2 (I - 3) + lambda/2 (J - alpha)^2 - mu/2 log((I + 1)/4),   alpha = 1 + 3/4 mu/lambda,
 * I = |F|^2, J = det F. It is finite for every F, inverted ones included, and its only minima are rotations. With
 * Lame's mu_L and lambda_L it is Hooke's law for small strains where mu = 4/3 mu_L and lambda = lambda_L + 5/6 mu_L
 * (16).
 *
 * With f = vec F and g = dJ/dF, the Hessian is a I + b f f^T + lambda g g^T + lambda (J - alpha) H_J with
 * a = mu (1 - 1/(I + 1)), b = 2 mu/(I + 1)^2, H_J = d^2 J/dF^2. By F = U diag(s) V^T it has six eigenvectors
 * U (e_i e_j^T -+ e_j e_i^T) V^T/sqrt(2) with eigenvalues a +- lambda (J - alpha) s_k (twists and flips, section 4.5),
 * and three among the U e_i e_i^T V^T, those of a 3 x 3 matrix. U and V may be reflections: then J = -s_0 s_1 s_2, and
 * `sign` is -1 below.
 *
 * W near rest is small of second order, while its terms are not: with the strain E = (F^T F - 1)/2 it is
 *     W = 3/4 mu (tr E - (J - 1)) + mu/2 (tr E/2 - log(1 + tr E/2)) + lambda/2 (J - 1)^2,
 * and with J^2 = det(1 + 2 E) = 1 + 2 tr E + 4 II + 8 III the first bracket is (tr E (J - 1) - 4 II - 8 III)/(1 + J),
 * which has no differences of large numbers; II is the sum of the principal minors of E, III its determinant. */
#include "plugins/common/solids/neo_hookean.h"

#include "plugins/common/solids/matrix3.h"

#include <math.h>
#include <string.h>

static const double ROOT_HALF = 0.70710678118654752440;

hk_neo_hookean hk_neo_hookean_of(double E, double nu) {
  double mu = E / (2 * (1 + nu)), lambda = E * nu / ((1 + nu) * (1 - 2 * nu));
  return (hk_neo_hookean){4.0 / 3 * mu, lambda + 5.0 / 6 * mu};
}

static double square_of(const double F[9]) {
  double sum = 0;
  for (int e = 0; e < 9; e++) sum += F[e] * F[e];
  return sum;
}

/* lambda (J - alpha) */
static double pressure_of(hk_neo_hookean m, double J) { return m.lambda * (J - 1) - 0.75 * m.mu; }

/* Green's strain, its trace, the sum of its principal minors and its determinant. */
static void strain_of(const double F[9], double E[9], double invariant[3]) {
  double minor[9];
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      double sum = 0;
      for (int k = 0; k < 3; k++) sum += F[3 * k + r] * F[3 * k + c];
      E[3 * r + c] = (sum - (r == c)) / 2;
    }
  invariant[2] = hk_matrix3_cofactor(E, minor);
  invariant[0] = E[0] + E[4] + E[8];
  invariant[1] = minor[0] + minor[4] + minor[8];
}

double hk_neo_hookean_energy(hk_neo_hookean m, const double F[9]) {
  double E[9], of[3], cofactor[9], J = hk_matrix3_cofactor(F, cofactor);
  strain_of(F, E, of);
  double bracket = J > 0 ? (of[0] * (J - 1) - 4 * of[1] - 8 * of[2]) / (1 + J) : of[0] - (J - 1);
  double half = of[0] / 2;
  return 0.75 * m.mu * bracket + m.mu / 2 * (half - log1p(half)) + m.lambda / 2 * (J - 1) * (J - 1);
}

void hk_neo_hookean_stress(hk_neo_hookean m, const double F[9], double P[9]) {
  double G[9], I = square_of(F), a = m.mu * I / (I + 1), p = pressure_of(m, hk_matrix3_cofactor(F, G));
  for (int e = 0; e < 9; e++) P[e] = a * F[e] + p * G[e];
}

/* H += factor H_J: the derivative of the entry (r, c) of the cofactor with respect to F_sd is the entry of F in the
 * third row and the third column, with the sign of both permutations. */
static void add_second_of_determinant(double factor, const double F[9], double H[81]) {
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      for (int s = 0; s < 3; s++)
        for (int d = 0; d < 3; d++) {
          if (r == s || c == d) continue;
          int same = ((s - r + 3) % 3 == 1) == ((d - c + 3) % 3 == 1);
          H[9 * (3 * r + c) + 3 * s + d] += (same ? factor : -factor) * F[3 * (3 - r - s) + 3 - c - d];
        }
}

void hk_neo_hookean_hessian(hk_neo_hookean m, const double F[9], double H[81]) {
  double G[9], I = square_of(F), a = m.mu * I / (I + 1), b = 2 * m.mu / ((I + 1) * (I + 1));
  double p = pressure_of(m, hk_matrix3_cofactor(F, G));
  for (int r = 0; r < 9; r++)
    for (int c = 0; c < 9; c++) H[9 * r + c] = (r == c ? a : 0) + b * F[r] * F[c] + m.lambda * G[r] * G[c];
  add_second_of_determinant(p, F, H);
}

/* H += value q q^T for a positive value */
static void add_mode(double value, const double q[9], double H[81]) {
  if (!(value > 0)) return;
  for (int r = 0; r < 9; r++)
    for (int c = 0; c < 9; c++) H[9 * r + c] += value * q[r] * q[c];
}

/* q = u_i v_j^T with the columns of U and V */
static void outer(const double U[9], int i, const double V[9], int j, double q[9]) {
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) q[3 * r + c] = U[3 * r + i] * V[3 * c + j];
}

/* Twist and flip in the plane of i and j. */
static void add_turns(const double U[9], const double V[9], int i, int j, double a, double turn, double H[81]) {
  double ij[9], ji[9], twist[9], flip[9];
  outer(U, i, V, j, ij);
  outer(U, j, V, i, ji);
  for (int e = 0; e < 9; e++) {
    twist[e] = ROOT_HALF * (ij[e] - ji[e]);
    flip[e] = ROOT_HALF * (ij[e] + ji[e]);
  }
  add_mode(a + turn, twist, H);
  add_mode(a - turn, flip, H);
}

void hk_neo_hookean_definite(hk_neo_hookean m, const double F[9], double H[81]) {
  double U[9], s[3], V[9], G[9], J = hk_matrix3_cofactor(F, G), I = square_of(F), A[9], value[3], Q[9];
  double a = m.mu * I / (I + 1), b = 2 * m.mu / ((I + 1) * (I + 1));
  hk_matrix3_svd(F, U, s, V);
  double sign = hk_matrix3_cofactor(U, G) * hk_matrix3_cofactor(V, G) < 0 ? -1 : 1, p = sign * pressure_of(m, J);
  memset(H, 0, 81 * sizeof *H);
  for (int i = 0; i < 3; i++) {
    int j = (i + 1) % 3, k = (i + 2) % 3;
    for (int c = 0; c < 3; c++) {
      double product = s[j] * s[k] * s[(c + 1) % 3] * s[(c + 2) % 3];
      A[3 * i + c] = b * s[i] * s[c] + m.lambda * product + (i == c ? a : p * s[3 - i - c]);
    }
    add_turns(U, V, i, j, a, p * s[k], H);
  }
  hk_matrix3_eigen(A, value, Q);
  for (int e = 0; e < 3; e++) {
    double q[9] = {0}, part[9];
    for (int i = 0; i < 3; i++) {
      outer(U, i, V, i, part);
      for (int k = 0; k < 9; k++) q[k] += Q[3 * i + e] * part[k];
    }
    add_mode(value[e], q, H);
  }
}

/* An upper bound of the largest singular value, exact for multiples of 1: |F|_2^2 <= |F|_1 |F|_infinity. */
static double norm_of(const double F[9]) {
  double rows = 0, columns = 0;
  for (int k = 0; k < 3; k++) {
    rows = fmax(rows, fabs(F[3 * k]) + fabs(F[3 * k + 1]) + fabs(F[3 * k + 2]));
    columns = fmax(columns, fabs(F[k]) + fabs(F[3 + k]) + fabs(F[6 + k]));
  }
  return sqrt(rows * columns);
}

/* Eigenvalues of b f f^T are at most b I. Those of H_J are +-s_k for twists and flips, and for the others those of a
 * matrix with the entries s_k off its diagonal, which is extreme where all s_k are the largest or 0: from -sqrt(2) to 2
 * times that one. */
double hk_neo_hookean_bound(hk_neo_hookean m, const double F[9]) {
  double G[9], I = square_of(F), a = m.mu * I / (I + 1), b = 2 * m.mu / ((I + 1) * (I + 1));
  double J = hk_matrix3_cofactor(F, G), p = pressure_of(m, J);
  return a + b * I + (p < 0 && J >= 0 ? 2 * ROOT_HALF : 2) * fabs(p) * norm_of(F);
}

/* (I - log(1 + I))/I and its derivative; where I is small, by the series I/2 - I^2/3 + I^3/4 - ... */
static void part_of(double I, double *part, double *slope) {
  if (I < 0.02) { /* then the first term left out, I^9/10, is below 1e-16 of the first */
    *part = *slope = 0;
    for (int k = 9; k >= 1; k--) {
      double c = (k % 2 ? 1.0 : -1.0) / (k + 1);
      *slope = *slope * I + k * c;
      *part = *part * I + c;
    }
    *part *= I;
  } else {
    *part = 1 - log1p(I) / I;
    *slope = (1 - *part - 1 / (1 + I)) / I;
  }
}

void hk_neo_hookean_values(hk_neo_hookean m, const double F[9], double C[10], double dC[90]) {
  double I = square_of(F), part, slope, ratio = sqrt(m.lambda / m.mu);
  part_of(I, &part, &slope);
  double w = sqrt(part), turn = w > 0 ? slope / w : 0; /* the derivative of w by F is slope/(2 w) 2 F */
  for (int r = 0; r < 9; r++) {
    C[r] = w * F[r];
    for (int c = 0; c < 9; c++) dC[9 * r + c] = (r == c ? w : 0) + turn * F[r] * F[c];
  }
  C[9] = ratio * pressure_of(m, hk_matrix3_cofactor(F, dC + 81)) / m.lambda;
  for (int c = 0; c < 9; c++) dC[81 + c] *= ratio;
}
