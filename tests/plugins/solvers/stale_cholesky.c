/* The solver stale_cholesky on matrices that drift: residuals are what is asked for, old factors serve, they are
 * renewed when that pays, and what is not definite is refused. */
#include "tests/support/solver_matrix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 24, ROWS = SIDE * SIDE, UNKNOWNS = 3 * ROWS, MATRICES = 60 };

static void open_grid(test_solver *s, int threads) {
  test_solver_open(s, "stale_cholesky", threads);
  test_matrix_begin(s, ROWS);
  for (size_t i = 0; i < ROWS; i++) {
    if (i % SIDE) test_matrix_pair(s, i, i - 1);
    if (i >= SIDE) test_matrix_pair(s, i, i - SIDE);
  }
  test_matrix_end(s, 3);
  test_matrix_fill(s, 0.01);
  assert_int_equal(test_solver_analyze(s), HK_OK);
}

/* The k-th matrix: rows and columns scaled by numbers that go apart with k, so that it stays symmetric and definite. */
static void drift(test_solver *s, const double *first, double by) {
  const hk_matrix *A = &s->A;
  for (size_t r = 0; r < ROWS; r++)
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++) {
      double row = 1 + by * (double)(r % 97) / 97, column = 1 + by * (double)(A->column[e] % 97) / 97;
      for (size_t p = 0; p < 9; p++) A->value[9 * e + p] = row * column * first[9 * e + p];
    }
}

typedef struct outcome {
  int iterations[MATRICES];
  double x[UNKNOWNS];
} outcome;

static void solve_all(outcome *o, int threads, double rate, double tolerance) {
  test_solver s;
  open_grid(&s, threads);
  size_t count = 9 * s.A.row_start[ROWS];
  static double first[9 * 5 * ROWS], b[UNKNOWNS]; /* the random numbers of every call are those of the first */
  if (first[0] == 0) memcpy(first, s.A.value, count * sizeof *first);
  for (size_t e = 0; e < UNKNOWNS; e++) b[e] = (double)(e % 11) - 5;
  for (int k = 0; k < MATRICES; k++) {
    hk_solve_info info = {.tolerance = tolerance};
    drift(&s, first, rate * k);
    assert_int_equal(test_solver_factorize(&s), HK_OK);
    assert_int_equal(test_solver_solve(&s, b, o->x, &info), HK_OK);
    o->iterations[k] = info.iterations;
    assert_true(test_matrix_residual(&s.A, b, o->x) <= 1.2 * tolerance); /* 1.1 by the solver's own products */
  }
  test_solver_close(&s);
}

/* Matrices solved by a factor of their own: in floats, whose rounding is 6e-8, two iterations for a residual of 1e-9.
 */
static int factorized(const outcome *o) {
  int count = 0;
  for (int k = 0; k < MATRICES; k++) count += o->iterations[k] <= 2;
  return count;
}

static void old_factors_serve_while_they_are_near(void **state) {
  (void)state;
  static outcome o;
  solve_all(&o, 1, 1e-4, 1e-3);
  assert_int_equal(o.iterations[0], 1);
  assert_true(o.iterations[MATRICES - 1] <= 3);
  solve_all(&o, 1, 0.5, 1e-9);
  assert_true(factorized(&o) >= MATRICES - 8); /* tries after 1, 3, 7, 15, 31 and every 31 matrices */
}

/* Two particles joined by a spring 1e9 times as stiff as what holds them, as neighbours in a row: floats lose the mass
 * and cannot be factorized, doubles can. */
static void what_floats_cannot_hold_is_factorized_in_doubles(void **state) {
  (void)state;
  test_solver s;
  double b[UNKNOWNS], x[UNKNOWNS];
  open_grid(&s, 1);
  memset(s.A.value, 0, 9 * s.A.row_start[ROWS] * sizeof(double));
  for (size_t i = 0; i < ROWS; i++)
    for (size_t c = 0; c < 3; c++) {
      double k = 1e9, joined = (double)(i % SIDE > 0) + (double)(i % SIDE < SIDE - 1);
      test_matrix_block(&s, i, i)[4 * c] = 1 + k * joined;
      if (i % SIDE) test_matrix_block(&s, i, i - 1)[4 * c] = test_matrix_block(&s, i - 1, i)[4 * c] = -k;
    }
  for (size_t e = 0; e < UNKNOWNS; e++) b[e] = (double)(e % 11) - 5;
  assert_int_equal(test_solver_factorize(&s), HK_OK);
  hk_solve_info info = {.tolerance = 1e-6};
  assert_int_equal(test_solver_solve(&s, b, x, &info), HK_OK);
  assert_true(test_matrix_residual(&s.A, b, x) <= 1.2e-6);
  test_solver_close(&s);
}

static void bits_do_not_depend_on_threads(void **state) {
  (void)state;
  static outcome one, two;
  solve_all(&one, 1, 0.01, 1e-3);
  solve_all(&two, 2, 0.01, 1e-3);
  assert_memory_equal(&one, &two, sizeof one);
}

static void what_is_not_definite_is_refused(void **state) {
  (void)state;
  test_solver s;
  double b[UNKNOWNS], x[UNKNOWNS];
  open_grid(&s, 1);
  for (size_t e = 0; e < UNKNOWNS; e++) b[e] = 1;
  assert_int_equal(test_solver_factorize(&s), HK_OK);
  assert_int_equal(test_solver_solve(&s, b, x, NULL), HK_OK);
  for (size_t e = 0; e < 9 * s.A.row_start[ROWS]; e++) s.A.value[e] = -s.A.value[e];
  assert_int_equal(test_solver_factorize(&s), HK_OK); /* the old factor is kept */
  assert_int_equal(test_solver_solve(&s, b, x, NULL), HK_NOT_CONVERGED);
  test_solver_close(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(old_factors_serve_while_they_are_near),
      cmocka_unit_test(what_floats_cannot_hold_is_factorized_in_doubles),
      cmocka_unit_test(bits_do_not_depend_on_threads),
      cmocka_unit_test(what_is_not_definite_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
