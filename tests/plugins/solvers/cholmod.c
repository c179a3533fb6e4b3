/* CHOLMOD's factorization on random symmetric block matrices: the residual is rounding, what is not positive definite
 * is refused, factors are renewed on one pattern. */
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

static void open_solver(fixture *f, const char *ordering) {
  memset(f, 0, sizeof *f);
  test_engine_open(&f->e);
  f->shared = (hk_shared){.error = &f->e.error, .allocations_left = -1, .lanes = hk_processor_lanes()};
  hk_plugin_spec *spec = test_plugin(&f->e, HK_SOLVER, "cholmod");
  test_text(&f->e, spec, "ordering", ordering);
  f->solver = hk_instance_create(spec, &f->shared, &f->e.error);
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
  f->A = (hk_matrix){rows, block, p->row_start, p->column, NULL, true, 0};
  f->A.value = calloc(p->row_start[rows] * block * block, sizeof(double));
}

static size_t find(const hk_matrix *A, size_t row, size_t column) {
  for (size_t e = A->row_start[row]; e < A->row_start[row + 1]; e++)
    if (A->column[e] == column) return e;
  fail();
  return 0;
}

/* Random numbers, symmetric; the diagonal exceeds the sum of its row by `margin`, so for margin > 0 it is definite. */
static void fill(fixture *f, double margin) {
  hk_matrix *A = &f->A;
  size_t b = A->block;
  for (size_t r = 0; r < A->rows; r++)
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
      for (size_t q = 0; q < b * b; q++) {
        double value = noise();
        size_t mirror = find(A, A->column[e], r);
        A->value[b * b * e + q] = value;
        A->value[b * b * mirror + q % b * b + q / b] = value;
      }
  for (size_t r = 0; r < A->rows; r++)
    for (size_t k = 0; k < b; k++) {
      double sum = 0;
      for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
        for (size_t j = 0; j < b; j++)
          if (A->column[e] != r || j != k) sum += fabs(A->value[b * b * e + b * k + j]);
      A->value[b * b * find(A, r, r) + b * k + k] = sum + margin;
    }
}

/* |b - A x| / |b|, with both triangles: independent of what the solver says. */
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

static hk_status factorize(fixture *f) { return f->solver->plugin->solver->factorize(f->solver->self, &f->A); }

/* Condition numbers are below 100 or so; a Cholesky solve leaves a residual of some eps times |A||x|/|b|. */
static void check_solution(fixture *f) {
  size_t n = f->A.rows * f->A.block;
  double *b = calloc(n, sizeof *b), *x = calloc(n, sizeof *x);
  hk_solve_info info = {-1, -1, 0};
  for (size_t k = 0; k < n; k++) b[k] = noise();
  assert_int_equal(f->solver->plugin->solver->solve(f->solver->self, b, x, &info), HK_OK);
  assert_true(residual(&f->A, b, x) < 1e-14);
  assert_true(info.residual < 1e-14 && info.residual >= 0);
  assert_int_equal(info.iterations, 0);
  free(b);
  free(x);
}

static void solve_all_sizes(const char *ordering) {
  static const size_t sizes[][3] = {{1, 1, 0}, {2, 3, 0}, {50, 1, 60}, {40, 3, 80}, {1500, 3, 1500}};
  fixture f;
  open_solver(&f, ordering);
  for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) { /* new patterns on one instance */
    make_pattern(&f, sizes[k][0], sizes[k][1], sizes[k][2]);
    assert_int_equal(f.solver->plugin->solver->analyze(f.solver->self, &f.A), HK_OK);
    for (int again = 0; again < 3; again++) { /* new numbers on one pattern */
      fill(&f, 0.5);
      assert_int_equal(factorize(&f), HK_OK);
      check_solution(&f);
    }
  }
  close_solver(&f);
}

static void systems_are_solved_to_rounding(void **state) {
  (void)state;
  solve_all_sizes("best");
  solve_all_sizes("amd");
  solve_all_sizes("metis");
}

/* Small matrices go the simplicial way, the larger one with much fill the supernodal way; both must refuse. */
static void indefinite_matrix_is_refused_and_the_solver_goes_on(void **state) {
  (void)state;
  static const size_t sizes[][3] = {{20, 1, 10}, {20, 3, 10}, {1500, 3, 1500}};
  fixture f;
  open_solver(&f, "best");
  for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
    make_pattern(&f, sizes[k][0], sizes[k][1], sizes[k][2]);
    assert_int_equal(f.solver->plugin->solver->analyze(f.solver->self, &f.A), HK_OK);
    fill(&f, 0.5);
    size_t at = find(&f.A, 7, 7) * f.A.block * f.A.block;
    f.A.value[at] = -f.A.value[at];
    f.e.error = (hk_error){0};
    assert_int_equal(factorize(&f), HK_NOT_CONVERGED);
    assert_non_null(strstr(f.e.error.text, "not positive definite"));
    double b[9] = {0}, x[9];
    assert_int_equal(f.solver->plugin->solver->solve(f.solver->self, b, x, NULL), HK_FAILED);
    fill(&f, 0.5);
    assert_int_equal(factorize(&f), HK_OK);
    check_solution(&f);
  }
  close_solver(&f);
}

static void diagonal_matrix_names_the_particle_at_fault(void **state) {
  (void)state;
  fixture f;
  open_solver(&f, "best");
  hk_block_matrix_begin(&f.pattern, 5, 5);
  for (uint32_t i = 0; i < 5; i++) f.pattern.naming.block(&f.pattern.naming, i, i);
  assert_int_equal(hk_block_matrix_build(&f.pattern), HK_OK);
  f.A = (hk_matrix){5, 3, f.pattern.row_start, f.pattern.column, calloc(45, sizeof(double)), true, 0};
  for (size_t k = 0; k < 15; k++) f.A.value[9 * (k / 3) + 4 * (k % 3)] = k == 10 ? -1 : 1;
  assert_int_equal(f.solver->plugin->solver->analyze(f.solver->self, &f.A), HK_OK);
  assert_int_equal(factorize(&f), HK_NOT_CONVERGED);
  assert_non_null(strstr(f.e.error.text, "4th particle's y"));
  close_solver(&f);
}

static void factors_repeat_bit_by_bit(void **state) {
  (void)state;
  fixture f;
  enum { COUNT = 4500 };
  open_solver(&f, "best");
  make_pattern(&f, COUNT / 3, 3, COUNT / 3);
  fill(&f, 0.5);
  double *x = calloc(3 * COUNT, sizeof *x), *b = x + 2 * COUNT;
  for (size_t k = 0; k < COUNT; k++) b[k] = noise();
  for (size_t k = 0; k < 2; k++) {
    assert_int_equal(f.solver->plugin->solver->analyze(f.solver->self, &f.A), HK_OK);
    assert_int_equal(factorize(&f), HK_OK);
    assert_int_equal(f.solver->plugin->solver->solve(f.solver->self, b, x + k * COUNT, NULL), HK_OK);
  }
  assert_memory_equal(x, x + COUNT, COUNT * sizeof *x);
  free(x);
  close_solver(&f);
}

static void factorizing_another_pattern_is_refused(void **state) {
  (void)state;
  fixture f;
  open_solver(&f, "best");
  make_pattern(&f, 4, 3, 0);
  fill(&f, 0.5);
  assert_int_equal(factorize(&f), HK_FAILED); /* never analysed */
  close_solver(&f);
}

static hk_status solve_columns(fixture *f, const double *b, double *x, size_t columns) {
  return f->solver->plugin->solver->solve_columns(f->solver->self, b, x, columns);
}

/* `solve` is cholmod_solve2, which shares nothing with the columns' substitution. Both leave errors of some eps times
 * the condition number, at most 1e3 here. */
static void check_columns(fixture *f, size_t columns) {
  size_t n = f->A.rows * f->A.block;
  double *b = calloc(2 * (columns + 1) * n, sizeof *b), *x = b + columns * n, *one = x + columns * n,
         *expected = one + n;
  for (size_t k = 0; k < columns * n; k++) b[k] = noise();
  assert_int_equal(solve_columns(f, b, x, columns), HK_OK);
  for (size_t c = 0; c < columns; c++) {
    double largest = 0, off = 0;
    for (size_t k = 0; k < n; k++) one[k] = b[columns * k + c];
    assert_int_equal(f->solver->plugin->solver->solve(f->solver->self, one, expected, NULL), HK_OK);
    for (size_t k = 0; k < n; k++) {
      largest = fmax(largest, fabs(expected[k]));
      off = fmax(off, fabs(expected[k] - x[columns * k + c]));
    }
    if (!(off <= 1e-13 * largest))
      fail_msg("%zu rows, column %zu of %zu: differs by %g of %g", n, c, columns, off, largest);
  }
  assert_int_equal(solve_columns(f, b, b, columns), HK_OK); /* in place */
  assert_memory_equal(b, x, columns * n * sizeof *b);
  free(b);
}

/* Rings go the simplicial way, the chords' fill the supernodal one with panels of every width. */
static void columns_are_solved_as_one_by_one(void **state) {
  (void)state;
  static const size_t sizes[][3] = {{1, 1, 0}, {2, 3, 0}, {50, 1, 0}, {333, 1, 60}, {2000, 1, 2500}, {400, 3, 500}};
  fixture f;
  open_solver(&f, "best");
  for (size_t k = 0; k < sizeof sizes / sizeof *sizes; k++) {
    make_pattern(&f, sizes[k][0], sizes[k][1], sizes[k][2]);
    assert_int_equal(f.solver->plugin->solver->analyze(f.solver->self, &f.A), HK_OK);
    for (int again = 0; again < 2; again++) { /* the copy follows the new numbers */
      fill(&f, 0.5);
      assert_int_equal(factorize(&f), HK_OK);
      for (size_t columns = 1; columns <= 9; columns += columns < 5 ? 1 : 4) check_columns(&f, columns);
    }
  }
  close_solver(&f);
}

/* What is known of the answer without any solver: of a path with weights 1 and ends held, A = tridiagonal (-1, 2, -1),
 * the inverse is min(i, j)(n + 1 - max(i, j))/(n + 1). Condition 4 n^2/pi^2 = 1e4: 1e-11. */
static void columns_of_a_known_inverse_come_out(void **state) {
  (void)state;
  enum { COUNT = 150 };
  fixture f;
  open_solver(&f, "best");
  hk_block_matrix_begin(&f.pattern, COUNT, COUNT);
  for (uint32_t i = 0; i < COUNT; i++)
    for (uint32_t j = i ? i - 1 : 0; j <= i + 1 && j < COUNT; j++) f.pattern.naming.block(&f.pattern.naming, i, j);
  assert_int_equal(hk_block_matrix_build(&f.pattern), HK_OK);
  f.A = (hk_matrix){COUNT, 1, f.pattern.row_start, f.pattern.column, calloc(3 * COUNT, sizeof(double)), true, 0};
  for (size_t i = 0; i < COUNT; i++)
    for (size_t e = f.A.row_start[i]; e < f.A.row_start[i + 1]; e++) f.A.value[e] = f.A.column[e] == i ? 2 : -1;
  assert_int_equal(f.solver->plugin->solver->analyze(f.solver->self, &f.A), HK_OK);
  assert_int_equal(factorize(&f), HK_OK);
  double b[3 * COUNT] = {0}, x[3 * COUNT];
  static const size_t at[3] = {0, 70, 149};
  for (size_t c = 0; c < 3; c++) b[3 * at[c] + c] = 1;
  assert_int_equal(solve_columns(&f, b, x, 3), HK_OK);
  for (size_t i = 0; i < COUNT; i++)
    for (size_t c = 0; c < 3; c++) {
      size_t low = i < at[c] ? i : at[c], high = i < at[c] ? at[c] : i;
      double expected = (double)(low + 1) * (double)(COUNT - high) / (COUNT + 1);
      assert_true(fabs(x[3 * i + c] - expected) < 1e-11);
    }
  close_solver(&f);
}

static void columns_without_a_factor_are_refused(void **state) {
  (void)state;
  fixture f;
  open_solver(&f, "best");
  make_pattern(&f, 30, 1, 10);
  double b[90] = {0}, x[90];
  assert_int_equal(f.solver->plugin->solver->analyze(f.solver->self, &f.A), HK_OK);
  assert_int_equal(solve_columns(&f, b, x, 3), HK_FAILED);
  fill(&f, 0.5);
  assert_int_equal(factorize(&f), HK_OK);
  assert_int_equal(solve_columns(&f, b, x, 3), HK_OK);
  f.A.value[find(&f.A, 7, 7)] = -1;
  f.e.error = (hk_error){0};
  assert_int_equal(factorize(&f), HK_NOT_CONVERGED);
  assert_int_equal(solve_columns(&f, b, x, 3), HK_FAILED); /* not with the factor before */
  close_solver(&f);
}

static void a_right_hand_side_that_is_not_finite_is_said(void **state) {
  (void)state;
  fixture f;
  open_solver(&f, "best");
  make_pattern(&f, 30, 1, 10);
  double b[90] = {0}, x[90];
  b[40] = NAN;
  fill(&f, 0.5);
  assert_int_equal(f.solver->plugin->solver->analyze(f.solver->self, &f.A), HK_OK);
  assert_int_equal(factorize(&f), HK_OK);
  assert_int_equal(solve_columns(&f, b, x, 3), HK_NOT_FINITE);
  close_solver(&f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(systems_are_solved_to_rounding),
      cmocka_unit_test(indefinite_matrix_is_refused_and_the_solver_goes_on),
      cmocka_unit_test(diagonal_matrix_names_the_particle_at_fault),
      cmocka_unit_test(factors_repeat_bit_by_bit),
      cmocka_unit_test(factorizing_another_pattern_is_refused),
      cmocka_unit_test(columns_are_solved_as_one_by_one),
      cmocka_unit_test(columns_of_a_known_inverse_come_out),
      cmocka_unit_test(columns_without_a_factor_are_refused),
      cmocka_unit_test(a_right_hand_side_that_is_not_finite_is_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
