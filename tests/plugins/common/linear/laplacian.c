/* The matrix of masses and weights against a dense sum over the edges, with edges that share a pair and held particles.
 */
#include "plugins/common/linear/laplacian.h"
#include "tests/support/fake_system.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <cmocka.h>

enum { N = 9, EDGES = 14 };

static const uint32_t pair[EDGES][2] = {{0, 1}, {1, 2}, {2, 0}, {1, 0}, {7, 3}, {3, 7}, {4, 8},
                                        {8, 0}, {2, 7}, {5, 6}, {6, 5}, {5, 6}, {0, 5}, {3, 4}};

static void expected(double A[N][N], const double *mass, const double *inverse_mass, const double *weight) {
  for (size_t i = 0; i < N; i++)
    for (size_t j = 0; j < N; j++) A[i][j] = i == j ? mass[i] : 0;
  for (size_t e = 0; e < EDGES; e++)
    for (size_t a = 0; a < 2; a++)
      for (size_t b = 0; b < 2; b++) A[pair[e][a]][pair[e][b]] += (a == b ? 1 : -1) * weight[e];
  for (size_t i = 0; i < N; i++)
    for (size_t j = 0; j < N; j++)
      if (inverse_mass[i] == 0 || inverse_mass[j] == 0) A[i][j] = i == j;
}

/* 1e-14: rounding of sums of up to six weights of order 1 in another order. */
static void entries_are_the_sums_of_the_edges(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){.n = N});
  hk_laplacian l = {0};
  double mass[N], inverse_mass[N], weight[EDGES], A[N][N];
  assert_int_equal(hk_laplacian_build(&l, &f->host, N, EDGES, pair), HK_OK);
  for (int held = 0; held < 2; held++) {
    for (size_t i = 0; i < N; i++) {
      mass[i] = 1 + 0.1 * (double)i;
      inverse_mass[i] = held && (i == 2 || i == 7) ? 0 : 1 / mass[i];
    }
    for (size_t e = 0; e < EDGES; e++) weight[e] = 0.3 + 0.05 * (double)e + held;
    hk_laplacian_fill(&l, mass, inverse_mass, weight);
    expected(A, mass, inverse_mass, weight);
    assert_int_equal(l.matrix.rows, N);
    assert_int_equal(l.matrix.block, 1);
    for (size_t i = 0; i < N; i++) {
      for (size_t e = l.matrix.row_start[i]; e < l.matrix.row_start[i + 1]; e++) {
        uint32_t j = l.matrix.column[e];
        if (e > l.matrix.row_start[i]) assert_true(j > l.matrix.column[e - 1]);
        if (!(fabs(l.matrix.value[e] - A[i][j]) < 1e-14))
          fail_msg("(%zu, %u): %g, not %g", i, j, l.matrix.value[e], A[i][j]);
        A[i][j] = 0;
      }
      for (size_t j = 0; j < N; j++) assert_true(A[i][j] == 0); /* nothing outside the pattern */
    }
  }
  hk_laplacian_release(&l, &f->host);
  fake_system_destroy(f);
}

static void no_edges_give_the_masses(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){.n = 3});
  hk_laplacian l = {0};
  assert_int_equal(hk_laplacian_build(&l, &f->host, 3, 0, NULL), HK_OK);
  hk_laplacian_fill(&l, (double[]){1, 2, 3}, (double[]){1, 0, 1}, NULL);
  assert_int_equal(l.matrix.row_start[3], 3);
  assert_true(l.matrix.value[0] == 1 && l.matrix.value[1] == 1 && l.matrix.value[2] == 3);
  hk_laplacian_release(&l, &f->host);
  fake_system_destroy(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(entries_are_the_sums_of_the_edges),
      cmocka_unit_test(no_edges_give_the_masses),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
