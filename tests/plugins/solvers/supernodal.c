/* The multifrontal factorization: residuals are rounding, known inverses come out, what is not positive definite is
 * refused with its place, bits depend neither on threads nor on what was solved before. */
#include "tests/support/solver_matrix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* A ring of `rows` with `chords` random further pairs. */
static void ring(test_solver *s, size_t rows, size_t block, size_t chords) {
  test_matrix_begin(s, rows);
  for (size_t k = 0; k < rows && rows > 1; k++) test_matrix_pair(s, k, (k + 1) % rows);
  for (size_t k = 0; k < chords; k++) test_matrix_pair(s, k % rows, (size_t)((test_noise() + 0.5) * (double)rows));
  test_matrix_end(s, block);
  test_matrix_fill(s, 0.5);
}

static void grid(test_solver *s, size_t side, size_t block) {
  test_matrix_begin(s, side * side);
  for (size_t i = 0; i < side * side; i++) {
    if (i % side) test_matrix_pair(s, i, i - 1);
    if (i >= side) test_matrix_pair(s, i, i - side);
  }
  test_matrix_end(s, block);
  test_matrix_fill(s, 0.5);
}

static size_t unknowns(const test_solver *s) { return s->A.rows * s->A.block; }

/* Condition numbers are below 1000; a Cholesky solve leaves a residual of some eps |A||x|/|b|. */
static void check_solution(test_solver *s) {
  double *b = calloc(2 * unknowns(s), sizeof *b), *x = b + unknowns(s);
  hk_solve_info info = {-1, -1, 0};
  for (size_t k = 0; k < unknowns(s); k++) b[k] = test_noise();
  assert_int_equal(test_solver_solve(s, b, x, &info), HK_OK);
  assert_int_equal(info.iterations, 0);
  assert_true(test_matrix_residual(&s->A, b, x) < 1e-14);
  free(b);
}

static void systems_are_solved_to_rounding(void **state) {
  (void)state;
  static const size_t sizes[][3] = {{1, 1, 0}, {2, 3, 0}, {50, 1, 60}, {40, 3, 80}, {7, 2, 3}, {700, 3, 700}};
  test_solver s;
  test_solver_open(&s, "supernodal", 1);
  for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) { /* new patterns on one instance */
    ring(&s, sizes[k][0], sizes[k][1], sizes[k][2]);
    assert_int_equal(test_solver_analyze(&s), HK_OK);
    for (int again = 0; again < 2; again++) { /* new numbers on one pattern */
      test_matrix_fill(&s, 0.5);
      assert_int_equal(test_solver_factorize(&s), HK_OK);
      check_solution(&s);
      check_solution(&s);
    }
  }
  test_solver_close(&s);
}

/* Particles that nothing joins are trees of their own, without rows below. */
static void separate_parts_are_solved(void **state) {
  (void)state;
  test_solver s;
  test_solver_open(&s, "supernodal", 2);
  test_matrix_begin(&s, 500);
  for (size_t i = 0; i + 7 < 500; i += 7) test_matrix_pair(&s, i, i + 3);
  test_matrix_end(&s, 3);
  test_matrix_fill(&s, 0.1);
  assert_int_equal(test_solver_analyze(&s), HK_OK);
  assert_int_equal(test_solver_factorize(&s), HK_OK);
  check_solution(&s);
  test_solver_close(&s);
}

static void bits_do_not_depend_on_threads(void **state) {
  (void)state;
  enum { SIDE = 30, COUNT = 3 * SIDE * SIDE };
  static double x[2][COUNT], b[COUNT], first[9 * 5 * SIDE * SIDE];
  for (size_t k = 0; k < COUNT; k++) b[k] = test_noise();
  for (int k = 0; k < 2; k++) {
    test_solver s;
    test_solver_open(&s, "supernodal", k + 1);
    grid(&s, SIDE, 3);
    size_t count = 9 * s.A.row_start[s.A.rows];
    if (k)
      memcpy(s.A.value, first, count * sizeof *first);
    else
      memcpy(first, s.A.value, count * sizeof *first);
    assert_int_equal(test_solver_analyze(&s), HK_OK);
    assert_int_equal(test_solver_factorize(&s), HK_OK);
    assert_int_equal(test_solver_solve(&s, b, x[k], NULL), HK_OK);
    test_solver_close(&s);
  }
  assert_memory_equal(x[0], x[1], sizeof x[0]);
}

static void what_is_not_definite_is_refused_with_its_place(void **state) {
  (void)state;
  test_solver s;
  double b[3 * 400] = {0}, x[3 * 400];
  test_solver_open(&s, "supernodal", 1);
  grid(&s, 20, 3);
  assert_int_equal(test_solver_analyze(&s), HK_OK);
  static const size_t at[] = {0, 210, 399};
  for (size_t k = 0; k < 3; k++) {
    double *block = test_matrix_block(&s, at[k], at[k]), kept = block[4];
    char place[64];
    block[4] = -1000; /* more than what is before it can make up for: the pivot is this row's */
    s.e.error = (hk_error){0};
    assert_int_equal(test_solver_factorize(&s), HK_NOT_CONVERGED);
    snprintf(place, sizeof place, "%zuth particle's y", at[k] + 1);
    if (!strstr(s.e.error.text, place)) fail_msg("no '%s' in: %s", place, s.e.error.text);
    assert_int_equal(test_solver_solve(&s, b, x, NULL), HK_FAILED);
    block[4] = kept;
    assert_int_equal(test_solver_factorize(&s), HK_OK);
    check_solution(&s);
  }
  test_matrix_block(&s, 5, 5)[0] = NAN;
  assert_int_equal(test_solver_factorize(&s), HK_NOT_CONVERGED);
  test_solver_close(&s);
}

static void what_was_not_analysed_is_refused(void **state) {
  (void)state;
  test_solver s;
  double b[90] = {0}, x[90];
  test_solver_open(&s, "supernodal", 1);
  ring(&s, 30, 3, 4);
  assert_int_equal(test_solver_factorize(&s), HK_FAILED);
  assert_int_equal(test_solver_analyze(&s), HK_OK);
  assert_int_equal(test_solver_solve(&s, b, x, NULL), HK_FAILED);
  ring(&s, 29, 3, 4);
  assert_int_equal(test_solver_factorize(&s), HK_FAILED);
  test_solver_close(&s);
}

/* Of a path with weights 1 and ends held, A = tridiagonal (-1, 2, -1), the inverse is
 * min(i, j)(n + 1 - max(i, j))/(n + 1). Condition 4 n^2/pi^2 = 1e4: 1e-11. Several right-hand sides as one by one. */
static void a_known_inverse_comes_out(void **state) {
  (void)state;
  enum { COUNT = 150 };
  static const size_t at[3] = {0, 70, 149};
  test_solver s;
  test_solver_open(&s, "supernodal", 1);
  test_matrix_begin(&s, COUNT);
  for (size_t i = 0; i + 1 < COUNT; i++) test_matrix_pair(&s, i, i + 1);
  test_matrix_end(&s, 1);
  for (size_t i = 0; i < COUNT; i++) {
    *test_matrix_block(&s, i, i) = 2;
    if (i) *test_matrix_block(&s, i, i - 1) = *test_matrix_block(&s, i - 1, i) = -1;
  }
  assert_int_equal(test_solver_analyze(&s), HK_OK);
  assert_int_equal(test_solver_factorize(&s), HK_OK);
  double b[3 * COUNT] = {0}, x[3 * COUNT], one[COUNT], y[COUNT];
  for (size_t c = 0; c < 3; c++) b[3 * at[c] + c] = 1;
  assert_int_equal(s.solver->plugin->solver->solve_columns(s.solver->self, b, x, 3), HK_OK);
  for (size_t c = 0; c < 3; c++) {
    for (size_t i = 0; i < COUNT; i++) one[i] = b[3 * i + c];
    assert_int_equal(test_solver_solve(&s, one, y, NULL), HK_OK);
    for (size_t i = 0; i < COUNT; i++) {
      size_t low = i < at[c] ? i : at[c], high = i < at[c] ? at[c] : i;
      double expected = (double)(low + 1) * (double)(COUNT - high) / (COUNT + 1);
      assert_true(fabs(y[i] - expected) < 1e-11 && fabs(x[3 * i + c] - expected) < 1e-11);
    }
  }
  test_solver_close(&s);
}

static void columns_follow_new_numbers(void **state) {
  (void)state;
  enum { COLUMNS = 5 };
  test_solver s;
  test_solver_open(&s, "supernodal", 1);
  ring(&s, 300, 3, 400);
  size_t n = unknowns(&s);
  double *b = calloc(2 * (COLUMNS + 1) * n, sizeof *b), *x = b + COLUMNS * n, *one = x + COLUMNS * n, *y = one + n;
  for (size_t k = 0; k < COLUMNS * n; k++) b[k] = test_noise();
  assert_int_equal(test_solver_analyze(&s), HK_OK);
  for (int again = 0; again < 2; again++) {
    test_matrix_fill(&s, 0.5);
    assert_int_equal(test_solver_factorize(&s), HK_OK);
    assert_int_equal(s.solver->plugin->solver->solve_columns(s.solver->self, b, x, COLUMNS), HK_OK);
    for (size_t c = 0; c < COLUMNS; c++) {
      for (size_t k = 0; k < n; k++) one[k] = b[COLUMNS * k + c], y[k] = x[COLUMNS * k + c];
      assert_true(test_matrix_residual(&s.A, one, y) < 1e-14);
    }
  }
  free(b);
  test_solver_close(&s);
}

static void a_right_hand_side_that_is_not_finite_is_said(void **state) {
  (void)state;
  test_solver s;
  double b[90] = {0}, x[90];
  test_solver_open(&s, "supernodal", 1);
  ring(&s, 30, 3, 10);
  assert_int_equal(test_solver_analyze(&s), HK_OK);
  assert_int_equal(test_solver_factorize(&s), HK_OK);
  b[40] = NAN;
  assert_int_equal(test_solver_solve(&s, b, x, NULL), HK_NOT_FINITE);
  assert_int_equal(s.solver->plugin->solver->solve_columns(s.solver->self, b, x, 1), HK_NOT_FINITE);
  b[40] = 1; /* nothing of it stays */
  assert_int_equal(test_solver_solve(&s, b, x, NULL), HK_OK);
  assert_true(test_matrix_residual(&s.A, b, x) < 1e-14);
  test_solver_close(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(systems_are_solved_to_rounding),
      cmocka_unit_test(separate_parts_are_solved),
      cmocka_unit_test(bits_do_not_depend_on_threads),
      cmocka_unit_test(what_is_not_definite_is_refused_with_its_place),
      cmocka_unit_test(what_was_not_analysed_is_refused),
      cmocka_unit_test(a_known_inverse_comes_out),
      cmocka_unit_test(columns_follow_new_numbers),
      cmocka_unit_test(a_right_hand_side_that_is_not_finite_is_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
