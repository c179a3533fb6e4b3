/* The solver multigrid: solutions are those of the equation, iterations do not grow with the size, the preconditioner
 * is symmetric and positive definite, bits do not depend on threads, fixed particles stay, what is no matrix of its
 * kind is refused with a sentence. */
#include "tests/bench/cloth_matrix.h"
#include "tests/support/solver_matrix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static size_t unknowns(const test_solver *s) { return s->A.rows * s->A.block; }

static hk_status factorize(test_solver *s) {
  hk_status status = test_solver_analyze(s);
  return status == HK_OK ? test_solver_factorize(s) : status;
}

/* Solves for a random right-hand side, zero in the rows from `end` on; returns the iterations. */
static int check_solution(test_solver *s, double tolerance, size_t end) {
  double *b = calloc(2 * unknowns(s), sizeof *b), *x = b + unknowns(s);
  hk_solve_info info = {-1, -1, tolerance};
  for (size_t k = 0; k < s->A.block * end; k++) b[k] = test_noise();
  assert_int_equal(factorize(s), HK_OK);
  assert_int_equal(test_solver_solve(s, b, x, &info), HK_OK);
  double left = test_matrix_residual(&s->A, b, x); /* the solver says the same up to rounding, eps 1e6 */
  assert_true(left <= tolerance * 1.01 && fabs(left - info.residual) <= 0.05 * tolerance);
  for (size_t k = s->A.block * end; k < unknowns(s); k++) assert_true(x[k] == 0);
  free(b);
  return info.iterations;
}

static int cloth_iterations(uint32_t side, double k, int threads, double *x) {
  cloth_matrix c;
  test_solver s;
  open_cloth_matrix(&c, side, k, 1 / 60.0);
  test_solver_open(&s, "multigrid", threads);
  s.A = c.A;
  size_t held = (size_t)side * (side - 1);
  double *b = calloc(3 * c.A.rows, sizeof *b);
  hk_solve_info info = {0, 0, 1e-6};
  int iterations = 0;
  for (size_t e = 0; e < 3 * held; e++) b[e] = noise(e);
  if (x) {
    assert_int_equal(factorize(&s), HK_OK);
    assert_int_equal(test_solver_solve(&s, b, x, &info), HK_OK);
    iterations = info.iterations;
  } else
    iterations = check_solution(&s, 1e-6, held);
  free(b);
  s.A.value = NULL;
  test_solver_close(&s);
  close_cloth_matrix(&c);
  return iterations;
}

/* 12, 12, 14 and 17 at 48, 64, 128 and 256 squared; 16 and 32 are within the level that is factorized. */
static void iterations_do_not_grow_with_the_size(void **state) {
  (void)state;
  assert_true(cloth_iterations(16, 1e5, 1, NULL) <= 2);
  assert_true(cloth_iterations(48, 1e5, 1, NULL) <= 16);
  assert_true(cloth_iterations(110, 1e5, 1, NULL) <= 18);
  assert_true(cloth_iterations(64, 1e3, 1, NULL) <= 18);
  assert_true(cloth_iterations(64, 1e8, 1, NULL) <= 25);
}

static void bits_do_not_depend_on_threads(void **state) {
  (void)state;
  enum { SIDE = 70, COUNT = 3 * SIDE * SIDE };
  static double x[3][COUNT];
  static const int threads[] = {1, 2, 7};
  for (int k = 0; k < 3; k++) cloth_iterations(SIDE, 1e5, threads[k], x[k]);
  assert_memory_equal(x[0], x[1], sizeof x[0]);
  assert_memory_equal(x[0], x[2], sizeof x[0]);
}

/* A path with springs to the next, some of them far stiffer; a grid of blocks of one; rows that nothing joins. */
static void chain(test_solver *s, size_t rows, size_t block) {
  test_matrix_begin(s, rows);
  for (size_t i = 0; i + 1 < rows; i++) test_matrix_pair(s, i, i + 1);
  test_matrix_end(s, block);
  for (size_t i = 0; i < rows; i++)
    for (size_t c = 0; c < block; c++) test_matrix_block(s, i, i)[(block + 1) * c] = 1;
  for (size_t i = 0; i + 1 < rows; i++)
    for (size_t c = 0; c < block; c++) {
      double k = i % 97 == 5 ? 1e6 : c ? 1 : 1e3;
      test_matrix_block(s, i, i)[(block + 1) * c] += k;
      test_matrix_block(s, i + 1, i + 1)[(block + 1) * c] += k;
      test_matrix_block(s, i, i + 1)[(block + 1) * c] = test_matrix_block(s, i + 1, i)[(block + 1) * c] = -k;
    }
}

static void chains_and_single_particles_are_solved(void **state) {
  (void)state;
  static const size_t rows[] = {1, 2, 3, 1500, 7000};
  test_solver s;
  test_solver_open(&s, "multigrid", 1);
  for (size_t block = 1; block <= 3; block += 2)
    for (size_t k = 0; k < sizeof rows / sizeof *rows; k++) { /* new patterns on one instance */
      chain(&s, rows[k], block);
      assert_true(check_solution(&s, 1e-8, rows[k]) <= 200);
    }
  test_matrix_begin(&s, 3000); /* pairs and single rows: no further level reaches them */
  for (size_t i = 0; i + 7 < 3000; i += 7) test_matrix_pair(&s, i, i + 3);
  test_matrix_end(&s, 3);
  test_matrix_fill(&s, 0.1);
  check_solution(&s, 1e-10, 3000);
  test_solver_close(&s);
}

/* A particle joined to all others, beyond the columns that a row of a prolongation has. */
static void a_hub_is_solved(void **state) {
  (void)state;
  enum { ROWS = 4000 };
  test_solver s;
  test_solver_open(&s, "multigrid", 1);
  test_matrix_begin(&s, ROWS);
  for (size_t i = 1; i < ROWS; i++) test_matrix_pair(&s, 0, i);
  for (size_t i = 1; i + 1 < ROWS; i++) test_matrix_pair(&s, i, i + 1);
  test_matrix_end(&s, 3);
  test_matrix_fill(&s, 1e-3);
  check_solution(&s, 1e-8, ROWS);
  test_solver_close(&s);
}

static void what_is_not_definite_or_not_finite_is_refused(void **state) {
  (void)state;
  test_solver s;
  test_solver_open(&s, "multigrid", 1);
  chain(&s, 2000, 3);
  double *b = calloc(2 * unknowns(&s), sizeof *b), *x = b + unknowns(&s), *D = test_matrix_block(&s, 700, 700);
  assert_int_equal(test_solver_factorize(&s), HK_FAILED); /* not analysed */
  assert_int_equal(test_solver_analyze(&s), HK_OK);
  assert_int_equal(test_solver_solve(&s, b, x, NULL), HK_FAILED); /* not factorized */
  double kept = D[4];
  D[4] = -1;
  s.e.error = (hk_error){0};
  assert_int_equal(test_solver_factorize(&s), HK_NOT_CONVERGED);
  assert_non_null(strstr(s.e.error.text, "701th particle's y"));
  D[4] = NAN;
  s.e.error = (hk_error){0};
  assert_int_not_equal(test_solver_factorize(&s), HK_OK);
  assert_int_equal(test_solver_solve(&s, b, x, NULL), HK_FAILED);
  D[4] = kept;
  check_solution(&s, 1e-8, 2000);
  /* Indefinite with a positive diagonal: a spring of negative stiffness between two particles. */
  test_matrix_block(&s, 700, 701)[4] = test_matrix_block(&s, 701, 700)[4] = -2e6;
  for (size_t k = 0; k < unknowns(&s); k++) b[k] = test_noise();
  s.e.error = (hk_error){0};
  hk_status status = test_solver_factorize(&s);
  if (status == HK_OK) status = test_solver_solve(&s, b, x, NULL);
  assert_int_equal(status, HK_NOT_CONVERGED);
  free(b);
  test_solver_close(&s);
}

static void no_memory_is_an_error_in_every_part(void **state) {
  (void)state;
  test_solver s;
  test_solver_open(&s, "multigrid", 1);
  chain(&s, 1500, 3);
  long k = 0;
  for (;; k++) {
    s.shared.allocations_left = k;
    s.e.error = (hk_error){0};
    hk_status status = factorize(&s);
    if (status == HK_OK) break;
    assert_int_equal(status, HK_NO_MEMORY);
    assert_true(*s.e.error.text != 0);
  }
  assert_true(k > 60);
  s.shared.allocations_left = -1;
  check_solution(&s, 1e-8, 1500);
  test_solver_close(&s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(iterations_do_not_grow_with_the_size),
      cmocka_unit_test(bits_do_not_depend_on_threads),
      cmocka_unit_test(chains_and_single_particles_are_solved),
      cmocka_unit_test(a_hub_is_solved),
      cmocka_unit_test(what_is_not_definite_or_not_finite_is_refused),
      cmocka_unit_test(no_memory_is_an_error_in_every_part),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
