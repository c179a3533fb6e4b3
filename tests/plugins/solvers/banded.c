/* The solver banded on random chains, bands, rings, trees and many components: solutions to rounding and beside those
 * of CHOLMOD, the same bits in every lane and on any number of threads, and what it refuses. */
#include "tests/support/solver_matrix.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef void (*graph)(test_solver *, size_t first, size_t rows);

static void band(test_solver *s, size_t first, size_t rows, size_t width) {
  for (size_t i = 0; i < rows; i++)
    for (size_t w = 1; w <= width && w <= i; w++) test_matrix_pair(s, first + i, first + i - w);
}

static void chain(test_solver *s, size_t first, size_t rows) { band(s, first, rows, 1); }
static void wide_band(test_solver *s, size_t first, size_t rows) { band(s, first, rows, 5); }

static void ring(test_solver *s, size_t first, size_t rows) {
  chain(s, first, rows);
  if (rows > 2) test_matrix_pair(s, first, first + rows - 1);
}

static void tree(test_solver *s, size_t first, size_t rows) {
  for (size_t i = 1; i < rows; i++) test_matrix_pair(s, first + i, first + (size_t)((test_noise() + 0.5) * (double)i));
}

/* A chain whose rows are numbered at random: the order has to be found again. */
static void shuffled_chain(test_solver *s, size_t first, size_t rows) {
  size_t *name = malloc(rows * sizeof *name);
  for (size_t i = 0; i < rows; i++) name[i] = i;
  for (size_t i = rows; i-- > 1;) {
    size_t other = (size_t)((test_noise() + 0.5) * (double)(i + 1)), kept = name[i];
    name[i] = name[other];
    name[other] = kept;
  }
  for (size_t i = 1; i < rows; i++) test_matrix_pair(s, first + name[i], first + name[i - 1]);
  free(name);
}

static void no_pairs(test_solver *s, size_t first, size_t rows) { (void)s, (void)first, (void)rows; }

/* Strands of equal and of other lengths, and lone rows. */
static void forest(test_solver *s, size_t first, size_t rows) {
  static const size_t length[] = {7, 7, 1, 12, 7, 12, 7, 7, 1, 30};
  for (size_t k = 0, at = 0; at + 30 < rows; at += length[k++ % 10]) ring(s, first + at, length[k % 10]);
}

static const graph graphs[] = {chain, wide_band, ring, tree, shuffled_chain, no_pairs, forest};
enum { GRAPHS = sizeof graphs / sizeof *graphs };

static void make(test_solver *s, graph of, size_t rows, size_t block) {
  test_matrix_begin(s, rows);
  of(s, 0, rows);
  test_matrix_end(s, block);
  assert_int_equal(test_solver_analyze(s), HK_OK);
}

/* The diagonal is dominant by 0.5, so condition numbers are below some hundreds; a direct solution leaves a residual of
 * some eps times |A||x|/|b|. */
static void check_solution(test_solver *s) {
  size_t n = s->A.rows * s->A.block;
  double *b = calloc(2 * n, sizeof *b), *x = b + n;
  for (size_t k = 0; k < n; k++) b[k] = test_noise();
  assert_int_equal(test_solver_solve(s, b, x, NULL), HK_OK);
  assert_true(test_matrix_residual(&s->A, b, x) < 1e-14);
  free(b);
}

static void systems_of_every_graph_are_solved_to_rounding(void **state) {
  (void)state;
  static const size_t rows[] = {1, 2, 3, 40, 1500};
  test_solver s;
  test_solver_open(&s, "banded", 1);
  for (size_t k = 0; k < GRAPHS * 5 * 2; k++) { /* new patterns on one instance */
    make(&s, graphs[k % GRAPHS], rows[k / GRAPHS % 5], k / GRAPHS < 5 ? 1 : 3);
    for (int again = 0; again < 2; again++) { /* new numbers on one pattern */
      test_matrix_fill(&s, 0.5);
      assert_int_equal(test_solver_factorize(&s), HK_OK);
      check_solution(&s);
    }
  }
  test_solver_close(&s);
}

/* Both make errors of some eps times the condition number, some hundreds. */
static void solutions_are_those_of_cholmod(void **state) {
  (void)state;
  test_solver s[2];
  enum { ROWS = 600, NUMBERS = 3 * ROWS };
  static double b[NUMBERS], x[2][NUMBERS];
  test_solver_open(&s[0], "banded", 1);
  test_solver_open(&s[1], "cholmod", 1);
  for (size_t g = 0; g < GRAPHS; g++) {
    make(&s[0], graphs[g], ROWS, 3);
    test_matrix_fill(&s[0], 0.5);
    for (size_t k = 0; k < NUMBERS; k++) b[k] = test_noise();
    hk_matrix own = s[1].A;
    s[1].A = s[0].A;
    assert_int_equal(test_solver_analyze(&s[1]), HK_OK);
    for (int k = 0; k < 2; k++) {
      assert_int_equal(test_solver_factorize(&s[k]), HK_OK);
      assert_int_equal(test_solver_solve(&s[k], b, x[k], NULL), HK_OK);
    }
    s[1].A = own;
    for (size_t k = 0; k < NUMBERS; k++) assert_true(fabs(x[0][k] - x[1][k]) < 1e-13);
  }
  test_solver_close(&s[0]);
  test_solver_close(&s[1]);
}

/* Six strands with the same numbers: two bundles of four lanes, of which the second is half full; and one strand alone,
 * which has no lanes beside it. */
static void every_lane_has_the_bits_of_a_component_alone(void **state) {
  (void)state;
  enum { LENGTH = 25, STRANDS = 6, NUMBERS = 3 * LENGTH };
  static double b[NUMBERS * STRANDS], x[NUMBERS * STRANDS], alone[NUMBERS];
  test_solver one, many;
  test_solver_open(&one, "banded", 1);
  test_solver_open(&many, "banded", 2);
  make(&one, ring, LENGTH, 3);
  test_matrix_fill(&one, 0.5);
  test_matrix_begin(&many, LENGTH * STRANDS);
  for (size_t k = 0; k < STRANDS; k++) ring(&many, k * LENGTH, LENGTH);
  test_matrix_end(&many, 3);
  size_t blocks = one.A.row_start[LENGTH];
  for (size_t k = 0; k < STRANDS; k++)
    memcpy(many.A.value + 9 * k * blocks, one.A.value, 9 * blocks * sizeof *one.A.value);
  for (size_t k = 0; k < NUMBERS * STRANDS; k++) b[k] = k < NUMBERS ? test_noise() : b[k - NUMBERS];
  assert_int_equal(test_solver_analyze(&many), HK_OK);
  assert_int_equal(test_solver_factorize(&one), HK_OK);
  assert_int_equal(test_solver_factorize(&many), HK_OK);
  assert_int_equal(test_solver_solve(&one, b, alone, NULL), HK_OK);
  assert_int_equal(test_solver_solve(&many, b, x, NULL), HK_OK);
  for (size_t k = 0; k < STRANDS; k++) assert_memory_equal(x + k * NUMBERS, alone, sizeof alone);
  test_solver_close(&one);
  test_solver_close(&many);
}

static void threads_do_not_change_a_bit(void **state) {
  (void)state;
  enum { ROWS = 20000 };
  double *b = calloc(3 * 3 * ROWS, sizeof *b);
  test_solver s[2];
  for (size_t k = 0; k < 3 * ROWS; k++) b[k] = test_noise();
  for (int k = 0; k < 2; k++) {
    test_solver_open(&s[k], "banded", k == 0 ? 1 : 4);
    make(&s[k], forest, ROWS, 3);
    test_matrix_fill(&s[k], 0.5);
  }
  memcpy(s[1].A.value, s[0].A.value, 9 * s[0].A.row_start[ROWS] * sizeof(double));
  for (int k = 0; k < 2; k++) {
    assert_int_equal(test_solver_factorize(&s[k]), HK_OK);
    assert_int_equal(test_solver_solve(&s[k], b, b + (size_t)(k + 1) * 3 * ROWS, NULL), HK_OK);
    test_solver_close(&s[k]);
  }
  assert_memory_equal(b + 3 * ROWS, b + 6 * ROWS, 3 * ROWS * sizeof *b);
  free(b);
}

/* In a strand of its own and in one of several lanes; afterwards the solver goes on. */
static void indefinite_matrix_is_refused_with_its_place(void **state) {
  (void)state;
  static const graph of[] = {ring, forest};
  test_solver s;
  test_solver_open(&s, "banded", 1);
  for (int k = 0; k < 2; k++) {
    make(&s, of[k], 100, 3);
    test_matrix_fill(&s, 0.5);
    *test_matrix_block(&s, 4, 4) *= -1;
    s.e.error = (hk_error){0};
    assert_int_equal(test_solver_factorize(&s), HK_NOT_CONVERGED);
    assert_non_null(strstr(s.e.error.text, "not positive definite, seen at the 5th particle's x"));
    double b[300] = {0}, x[300];
    assert_int_equal(test_solver_solve(&s, b, x, NULL), HK_FAILED);
    test_matrix_fill(&s, 0.5);
    assert_int_equal(test_solver_factorize(&s), HK_OK);
    check_solution(&s);
  }
  test_solver_close(&s);
}

static void singular_and_infinite_matrices_are_refused(void **state) {
  (void)state;
  static const double bad[] = {0, INFINITY, NAN};
  test_solver s;
  test_solver_open(&s, "banded", 1);
  for (int k = 0; k < 3; k++) {
    make(&s, no_pairs, 9, 1);
    test_matrix_fill(&s, 0.5);
    *test_matrix_block(&s, 7, 7) = bad[k];
    assert_int_equal(test_solver_factorize(&s), k == 0 ? HK_NOT_CONVERGED : HK_NOT_FINITE);
  }
  test_solver_close(&s);
}

/* A full matrix of 70 rows: 70^2/6 = 800 products per row, of 130: 2800. */
static void wide_matrices_are_refused_in_one_sentence(void **state) {
  (void)state;
  test_solver s;
  test_solver_open(&s, "banded", 1);
  for (size_t rows = 70; rows <= 130; rows += 60) {
    test_matrix_begin(&s, rows);
    band(&s, 0, rows, rows);
    test_matrix_end(&s, 1);
    test_matrix_fill(&s, 0.5);
    assert_int_equal(test_solver_analyze(&s), rows == 70 ? HK_OK : HK_FAILED);
  }
  assert_non_null(strstr(s.e.error.text, "choose another solver"));
  assert_int_equal(test_solver_factorize(&s), HK_FAILED);
  test_solver_close(&s);
}

static void every_failing_allocation_is_reported(void **state) {
  (void)state;
  test_solver s;
  test_solver_open(&s, "banded", 1);
  make(&s, forest, 80, 3);
  test_matrix_fill(&s, 0.5);
  hk_status status = HK_NO_MEMORY;
  for (int left = 0; status == HK_NO_MEMORY; left++) {
    s.shared.allocations_left = left;
    status = test_solver_analyze(&s);
    if (status == HK_NO_MEMORY) assert_int_equal(test_solver_factorize(&s), HK_FAILED);
  }
  assert_int_equal(status, HK_OK);
  assert_int_equal(test_solver_factorize(&s), HK_OK);
  check_solution(&s);
  test_solver_close(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(systems_of_every_graph_are_solved_to_rounding),
      cmocka_unit_test(solutions_are_those_of_cholmod),
      cmocka_unit_test(every_lane_has_the_bits_of_a_component_alone),
      cmocka_unit_test(threads_do_not_change_a_bit),
      cmocka_unit_test(indefinite_matrix_is_refused_with_its_place),
      cmocka_unit_test(singular_and_infinite_matrices_are_refused),
      cmocka_unit_test(wide_matrices_are_refused_in_one_sentence),
      cmocka_unit_test(every_failing_allocation_is_reported),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
