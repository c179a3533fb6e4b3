/* Decompositions of 3 x 3 matrices: random ones, of all ranks, with equal, tiny and huge singular values, reflections.
 */
#include "plugins/common/solids/matrix3.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static const double ROUNDING = 4e-15; /* eighteen roundings: six rotations, each of sums of products */

static uint64_t bits = 1;

/* -1 to 1. */
static double noise(void) {
  bits = bits * 6364136223846793005u + 1442695040888963407u;
  return (double)(bits >> 11) * 0x1p-52 - 1;
}

static void multiply(const double A[9], const double B[9], double M[9]) {
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) M[3 * r + c] = A[3 * r] * B[c] + A[3 * r + 1] * B[3 + c] + A[3 * r + 2] * B[6 + c];
}

static double size_of(const double A[9]) {
  double size = 0;
  for (int e = 0; e < 9; e++) size = fmax(size, fabs(A[e]));
  return size;
}

static void assert_orthogonal(const double Q[9]) {
  for (int a = 0; a < 3; a++)
    for (int b = 0; b < 3; b++)
      assert_true(fabs(Q[a] * Q[b] + Q[3 + a] * Q[3 + b] + Q[6 + a] * Q[6 + b] - (a == b)) < ROUNDING);
}

static void check(const double F[9]) {
  double U[9], s[3], V[9];
  hk_matrix3_svd(F, U, s, V);
  assert_orthogonal(U), assert_orthogonal(V);
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      double sum = 0;
      for (int k = 0; k < 3; k++) sum += U[3 * r + k] * s[k] * V[3 * c + k];
      assert_true(fabs(sum - F[3 * r + c]) <= ROUNDING * size_of(F));
    }
  for (int k = 0; k < 3; k++) assert_true(s[k] >= 0);
}

static void svd_gives_the_matrix_back(void **state) {
  (void)state;
  static const double SIZES[] = {1e-150, 1e-9, 1, 1e150}, FLAT[] = {0, 1e-16, 1e-8, 1};
  for (int k = 0; k < 20000; k++) {
    double A[9], B[9], F[9];
    for (int e = 0; e < 9; e++) A[e] = noise(), B[e] = noise();
    for (int e = 0; e < 9; e++)
      A[e] *= SIZES[k % 4] * (e % 3 == 0 ? FLAT[k / 4 % 4] : e % 3 == 1 ? FLAT[k / 16 % 4] : 1);
    multiply(A, B, F); /* ranks 1 to 3, nearly and exactly */
    check(F);
  }
}

static void svd_of_special_matrices(void **state) {
  (void)state;
  static const double LIST[][9] = {
      {0},
      {1, 0, 0, 0, 1, 0, 0, 0, 1},
      {1, 0, 0, 0, -1, 0, 0, 0, 1},
      {0, 1, 0, 0, 0, 1, 1, 0, 0},
      {0, 0, 0, 0, 5, 0, 0, 0, 0},
      {1, 1, 1, 1, 1, 1, 1, 1, 1},
      {1, 1, 0, 1, 1, 0, 0, 0, 0},
      {0, 1e-300, 0, 0, 0, 0, 0, 0, 1},
      {3e-308, 0, 0, 0, 3e-308, 1e-308, 0, 0, 1e-308},
  };
  for (size_t k = 0; k < sizeof LIST / sizeof *LIST; k++) check(LIST[k]);
}

static void eigen_gives_the_matrix_back(void **state) {
  (void)state;
  for (int k = 0; k < 20000; k++) {
    double A[9], value[3], Q[9], scale = pow(10, k % 7 * 20 - 60), near = k % 3 == 0 ? 1e-9 : 1;
    for (int r = 0; r < 3; r++)
      for (int c = r; c < 3; c++) A[3 * r + c] = A[3 * c + r] = scale * ((r == c ? 1 : 0) + near * noise());
    hk_matrix3_eigen(A, value, Q);
    assert_orthogonal(Q);
    for (int e = 0; e < 9; e++) {
      double sum = 0;
      for (int q = 0; q < 3; q++) sum += Q[3 * (e / 3) + q] * value[q] * Q[3 * (e % 3) + q];
      assert_true(fabs(sum - A[e]) <= ROUNDING * size_of(A));
    }
  }
}

static void cofactor_is_the_derivative_of_the_determinant(void **state) {
  (void)state;
  for (int k = 0; k < 100; k++) {
    double F[9], G[9], none[9];
    for (int e = 0; e < 9; e++) F[e] = noise();
    double J = hk_matrix3_cofactor(F, G);
    for (int e = 0; e < 9; e++) { /* it is linear in each entry */
      F[e] += 1;
      assert_true(fabs(hk_matrix3_cofactor(F, none) - J - G[e]) < 1e-14);
      F[e] -= 1;
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(svd_gives_the_matrix_back),
      cmocka_unit_test(svd_of_special_matrices),
      cmocka_unit_test(eigen_gives_the_matrix_back),
      cmocka_unit_test(cofactor_is_the_derivative_of_the_determinant),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
