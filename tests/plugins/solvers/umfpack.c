/* UMFPACK's factorization on random block matrices, symmetric or not: the residual is rounding, what is singular is
 * refused with the unknown that nothing determines, factors are renewed on one pattern. */
#include "core/numerics/matrix/matrix.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef struct fixture {
  test_engine e;
  hk_shared shared; /* the solver's, in place of a run's */
  hk_instance *solver;
  hk_block_matrix pattern;
  hk_matrix A;
} fixture;

static double noise(void) {
  static uint64_t bits = 1;
  bits = bits * 6364136223846793005u + 1442695040888963407u;
  return (double)(bits >> 11) * 0x1p-53 - 0.5;
}

static void open_solver(fixture *f) {
  memset(f, 0, sizeof *f);
  test_engine_open(&f->e);
  f->shared = (hk_shared){.error = &f->e.error, .allocations_left = -1, .lanes = hk_processor_lanes()};
  f->solver = hk_instance_create(test_plugin(&f->e, HK_SOLVER, "umfpack"), &f->shared, &f->e.error);
  assert_non_null(f->solver);
  assert_int_equal(hk_instance_start(f->solver, &(hk_view){.host = &f->solver->host}, 1, &f->e.error), HK_OK);
}

static void close_solver(fixture *f) {
  free(f->A.value);
  hk_block_matrix_free(&f->pattern);
  hk_instance_destroy(f->solver);
  test_engine_close(&f->e);
}

/* A ring of `rows` with `chords` random further pairs. */
static void make_pattern(fixture *f, size_t rows, size_t block, size_t chords) {
  hk_block_matrix *p = &f->pattern;
  hk_block_matrix_begin(p, rows, rows);
  for (size_t k = 0; k < rows + chords; k++) {
    uint32_t i = (uint32_t)(k % rows), j = (uint32_t)((k + 1) % rows);
    if (k >= rows) j = (uint32_t)((noise() + 0.5) * (double)rows);
    p->naming.block(&p->naming, i, i);
    p->naming.block(&p->naming, i, j);
    p->naming.block(&p->naming, j, i);
  }
  assert_int_equal(hk_block_matrix_build(p), HK_OK);
  free(f->A.value);
  f->A = (hk_matrix){rows, block, p->row_start, p->column, NULL, false, 0};
  f->A.value = calloc(p->row_start[rows] * block * block, sizeof(double));
}

static size_t find(const hk_matrix *A, size_t row, size_t column) {
  for (size_t e = A->row_start[row]; e < A->row_start[row + 1]; e++)
    if (A->column[e] == column) return e;
  fail();
  return 0;
}

/* Random numbers in rows of diagonal dominance with either sign: unsymmetric and indefinite, but well-conditioned. */
static void fill(fixture *f) {
  hk_matrix *A = &f->A;
  size_t b = A->block;
  for (size_t k = 0; k < A->row_start[A->rows] * b * b; k++) A->value[k] = noise();
  for (size_t r = 0; r < A->rows; r++)
    for (size_t k = 0; k < b; k++) {
      double sum = 0;
      for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
        for (size_t j = 0; j < b; j++) sum += fabs(A->value[b * b * e + b * k + j]);
      A->value[b * b * find(A, r, r) + b * k + k] = (noise() < 0 ? -1 : 1) * (sum + 0.5);
    }
}

/* |b - A x| / |b|: independent of what the solver says. */
static double residual(const hk_matrix *A, const double *b, const double *x) {
  double left = 0, whole = 0;
  size_t w = A->block;
  for (size_t r = 0; r < A->rows; r++)
    for (size_t k = 0; k < w; k++) {
      double sum = b[w * r + k];
      for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
        for (size_t j = 0; j < w; j++) sum -= A->value[w * w * e + w * k + j] * x[w * A->column[e] + j];
      left += sum * sum;
      whole += b[w * r + k] * b[w * r + k];
    }
  return sqrt(left / whole);
}

static hk_status analyze(fixture *f) { return f->solver->plugin->solver->analyze(f->solver->self, &f->A); }
static hk_status factorize(fixture *f) { return f->solver->plugin->solver->factorize(f->solver->self, &f->A); }
static hk_status solve(fixture *f, const double *b, double *x, hk_solve_info *info) {
  return f->solver->plugin->solver->solve(f->solver->self, b, x, info);
}

/* Condition numbers are below 1000 or so; refined LU leaves a residual of some eps times |A||x|/|b|. */
static void check_solution(fixture *f) {
  size_t n = f->A.rows * f->A.block;
  double *b = calloc(n, sizeof *b), *x = calloc(n, sizeof *x);
  hk_solve_info info = {-1, -1, 0};
  for (size_t k = 0; k < n; k++) b[k] = noise();
  assert_int_equal(solve(f, b, x, &info), HK_OK);
  assert_true(residual(&f->A, b, x) < 1e-14);
  assert_true(info.residual < 1e-14 && info.residual >= 0);
  assert_int_equal(info.iterations, 0);
  free(b);
  free(x);
}

static void unsymmetric_systems_are_solved_to_rounding(void **state) {
  (void)state;
  static const size_t sizes[][3] = {{1, 1, 0}, {1, 3, 0}, {2, 3, 0}, {50, 1, 60}, {40, 3, 80}, {700, 3, 700}};
  fixture f;
  open_solver(&f);
  for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) { /* new patterns on one instance */
    make_pattern(&f, sizes[k][0], sizes[k][1], sizes[k][2]);
    assert_int_equal(analyze(&f), HK_OK);
    for (int again = 0; again < 3; again++) { /* new numbers on one pattern */
      fill(&f);
      assert_int_equal(factorize(&f), HK_OK);
      check_solution(&f);
    }
  }
  close_solver(&f);
}

/* [[0, 1], [2, 0]] needs other pivots than the diagonal, and tells A from its transpose. */
static void zero_diagonal_is_no_obstacle(void **state) {
  (void)state;
  fixture f;
  open_solver(&f);
  make_pattern(&f, 2, 1, 0);
  const double dense[2][2] = {{0, 1}, {2, 0}}, b[2] = {5, 8};
  double x[2];
  for (size_t r = 0; r < 2; r++)
    for (size_t e = f.A.row_start[r]; e < f.A.row_start[r + 1]; e++) f.A.value[e] = dense[r][f.A.column[e]];
  assert_int_equal(analyze(&f), HK_OK);
  assert_int_equal(factorize(&f), HK_OK);
  assert_int_equal(solve(&f, b, x, NULL), HK_OK);
  assert_true(x[0] == 4 && x[1] == 5);
  close_solver(&f);
}

static void singular_matrix_is_refused_and_the_solver_goes_on(void **state) {
  (void)state;
  fixture f;
  open_solver(&f);
  make_pattern(&f, 20, 3, 10);
  assert_int_equal(analyze(&f), HK_OK);
  fill(&f);
  for (size_t r = 0; r < 20; r++) /* nothing depends on the eighth particle's y */
    for (size_t e = f.A.row_start[r]; e < f.A.row_start[r + 1]; e++)
      for (size_t k = 0; k < 3 && f.A.column[e] == 7; k++) f.A.value[9 * e + 3 * k + 1] = 0;
  assert_int_equal(factorize(&f), HK_NOT_CONVERGED);
  assert_non_null(strstr(f.e.error.text, "singular"));
  assert_non_null(strstr(f.e.error.text, "nothing determines the 8th particle's y"));
  double b[60] = {0}, x[60];
  assert_int_equal(solve(&f, b, x, NULL), HK_FAILED);
  fill(&f);
  assert_int_equal(factorize(&f), HK_OK);
  check_solution(&f);
  close_solver(&f);
}

/* What a body without pins and masses has: what one row takes, others give, and rows sum to zero. Pivots end at
 * rounding instead of zero. */
static void matrix_singular_up_to_rounding_is_refused(void **state) {
  (void)state;
  fixture f;
  open_solver(&f);
  make_pattern(&f, 50, 1, 60);
  fill(&f);
  for (size_t r = 0; r < 50; r++) {
    double sum = 0;
    for (size_t e = f.A.row_start[r]; e < f.A.row_start[r + 1]; e++)
      sum += f.A.column[e] == r ? 0 : (f.A.value[e] = -fabs(f.A.value[e]));
    f.A.value[find(&f.A, r, r)] = -sum;
  }
  assert_int_equal(analyze(&f), HK_OK);
  assert_int_equal(factorize(&f), HK_NOT_CONVERGED);
  assert_non_null(strstr(f.e.error.text, "singular"));
  close_solver(&f);
}

/* Rows and columns of 1e-6 next to 1e8: no singularity, and the residual stays rounding. */
static void scales_are_no_singularity(void **state) {
  (void)state;
  fixture f;
  open_solver(&f);
  make_pattern(&f, 60, 3, 60);
  fill(&f);
  for (size_t r = 0; r < 60; r++)
    for (size_t e = f.A.row_start[r]; e < f.A.row_start[r + 1]; e++)
      for (size_t k = 0; k < 9; k++) f.A.value[9 * e + k] *= r % 2 ? 1e8 : 1e-6;
  assert_int_equal(analyze(&f), HK_OK);
  assert_int_equal(factorize(&f), HK_OK);
  double b[180], x[180];
  for (size_t k = 0; k < 180; k++) b[k] = noise() * (k / 3 % 2 ? 1e8 : 1e-6);
  assert_int_equal(solve(&f, b, x, NULL), HK_OK);
  assert_true(residual(&f.A, b, x) < 1e-14);
  close_solver(&f);
}

static void what_is_not_finite_is_refused(void **state) {
  (void)state;
  fixture f;
  open_solver(&f);
  make_pattern(&f, 5, 3, 0);
  assert_int_equal(factorize(&f), HK_FAILED); /* never analysed */
  fill(&f);
  assert_int_equal(analyze(&f), HK_OK);
  f.A.value[9 * find(&f.A, 1, 2) + 3] = NAN;
  f.e.error = (hk_error){0};
  assert_int_equal(factorize(&f), HK_NOT_FINITE);
  assert_non_null(strstr(f.e.error.text, "row 5, column 7"));
  fill(&f);
  assert_int_equal(factorize(&f), HK_OK);
  double b[15] = {NAN}, x[15];
  assert_int_equal(solve(&f, b, x, NULL), HK_NOT_FINITE);
  close_solver(&f);
}

static void factors_repeat_bit_by_bit(void **state) {
  (void)state;
  fixture f;
  enum { COUNT = 2100 };
  open_solver(&f);
  make_pattern(&f, COUNT / 3, 3, COUNT / 3);
  fill(&f);
  double *x = calloc(3 * COUNT, sizeof *x), *b = x + 2 * COUNT;
  for (size_t k = 0; k < COUNT; k++) b[k] = noise();
  for (size_t k = 0; k < 2; k++) {
    assert_int_equal(analyze(&f), HK_OK);
    assert_int_equal(factorize(&f), HK_OK);
    assert_int_equal(solve(&f, b, x + k * COUNT, NULL), HK_OK);
  }
  assert_memory_equal(x, x + COUNT, COUNT * sizeof *x);
  free(x);
  close_solver(&f);
}

static void no_memory_is_an_error_in_every_part(void **state) {
  (void)state;
  fixture f;
  open_solver(&f);
  make_pattern(&f, 10, 3, 5);
  fill(&f);
  for (long k = 0;; k++) {
    f.shared.allocations_left = k;
    hk_status status = analyze(&f);
    if (status == HK_OK) {
      assert_true(k >= 9);
      break;
    }
    assert_int_equal(status, HK_NO_MEMORY);
    assert_int_equal(factorize(&f), HK_FAILED);
  }
  assert_int_equal(factorize(&f), HK_OK);
  check_solution(&f);
  close_solver(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(unsymmetric_systems_are_solved_to_rounding),
      cmocka_unit_test(zero_diagonal_is_no_obstacle),
      cmocka_unit_test(singular_matrix_is_refused_and_the_solver_goes_on),
      cmocka_unit_test(matrix_singular_up_to_rounding_is_refused),
      cmocka_unit_test(scales_are_no_singularity),
      cmocka_unit_test(what_is_not_finite_is_refused),
      cmocka_unit_test(factors_repeat_bit_by_bit),
      cmocka_unit_test(no_memory_is_an_error_in_every_part),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
