/* Kelvin's and Voigt's solid: beside the elastic stress acts P = F S, S = 2 mu dE/dt + lambda tr(dE/dt), where E is
 * Green's strain and dE/dt = sym(F^T dF/dt). Turning does not change E, so that angular momentum stays. The power lost
 * is 2 mu |dE/dt|^2 + lambda (tr dE/dt)^2. */
#include "plugins/common/solids/viscosity.h"

static const double ROOT2 = 1.41421356237309504880;
static const int ROW[6] = {0, 1, 2, 1, 0, 0}, COLUMN[6] = {0, 1, 2, 2, 2, 1}; /* xx yy zz yz xz xy */

hk_viscosity hk_viscosity_of(double damping, double nu) {
  return (hk_viscosity){damping / (2 * (1 + nu)), damping * nu / ((1 + nu) * (1 - 2 * nu))};
}

/* M = sym(A^T B) */
static void symmetric_product(const double A[9], const double B[9], double M[9]) {
  for (int r = 0; r < 3; r++)
    for (int c = r; c < 3; c++) {
      double sum = 0;
      for (int k = 0; k < 3; k++) sum += A[3 * k + r] * B[3 * k + c] + A[3 * k + c] * B[3 * k + r];
      M[3 * r + c] = M[3 * c + r] = sum / 2;
    }
}

/* P = F S for the rate of strain E. */
static void stress_of(hk_viscosity v, const double F[9], const double E[9], double S[9], double P[9]) {
  double trace = v.lambda * (E[0] + E[4] + E[8]);
  for (int e = 0; e < 9; e++) S[e] = 2 * v.mu * E[e] + (e % 4 == 0 ? trace : 0);
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) P[3 * r + c] = F[3 * r] * S[c] + F[3 * r + 1] * S[3 + c] + F[3 * r + 2] * S[6 + c];
}

double hk_viscosity_stress(hk_viscosity v, const double F[9], const double rate[9], double P[9]) {
  double E[9], S[9], power = 0;
  symmetric_product(F, rate, E);
  stress_of(v, F, E, S, P);
  for (int e = 0; e < 9; e++) power += S[e] * E[e];
  return power;
}

/* Column by column: a change of the rate changes the rate of strain by sym(F^T dR), one of F by sym(dF^T R), and the
 * stress by dF S beside. */
void hk_viscosity_derivatives(hk_viscosity v, const double F[9], const double rate[9], int turning, int definite,
                              double K[81], double D[81]) {
  double E[9], S[9], P[9], change[9], part[9], of[9];
  symmetric_product(F, rate, E);
  stress_of(v, F, E, S, P);
  for (int q = 0; q < 9; q++) {
    double unit[9] = {0};
    unit[q] = 1;
    symmetric_product(F, unit, change);
    stress_of(v, F, change, part, of);
    for (int e = 0; e < 9; e++) D[9 * e + q] = of[e];
    symmetric_product(unit, rate, change);
    stress_of(v, F, change, part, of);
    for (int e = 0; e < 9; e++)
      K[9 * e + q] = (turning ? of[e] : 0) + (!definite && e / 3 == q / 3 ? S[3 * (q % 3) + e % 3] : 0);
  }
}

void hk_strain_values(const double F[9], double C[6], double dC[54]) {
  for (int q = 0; q < 6; q++) {
    int a = ROW[q], b = COLUMN[q];
    double sum = 0, factor = q < 3 ? 0.5 : ROOT2 / 2;
    for (int e = 0; e < 9; e++) dC[9 * q + e] = 0;
    for (int k = 0; k < 3; k++) {
      sum += F[3 * k + a] * F[3 * k + b];
      dC[9 * q + 3 * k + a] += factor * F[3 * k + b];
      dC[9 * q + 3 * k + b] += factor * F[3 * k + a];
    }
    C[q] = factor * (sum - (q < 3));
  }
}

void hk_strain_trace(const double F[9], double *C, double dC[9]) {
  *C = -1.5;
  for (int e = 0; e < 9; e++) {
    *C += F[e] * F[e] / 2;
    dC[e] = F[e];
  }
}
