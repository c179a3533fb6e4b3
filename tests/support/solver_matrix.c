#include "tests/support/solver_matrix.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

void test_solver_open(test_solver *s, const char *name, int threads) {
  memset(s, 0, sizeof *s);
  test_engine_open(&s->e);
  s->shared = (hk_shared){.error = &s->e.error, .allocations_left = -1, .lanes = hk_processor_lanes()};
  if (threads > 1) s->shared.threads = hk_threads_create(threads);
  s->solver = hk_instance_create(test_plugin(&s->e, HK_SOLVER, name), &s->shared, &s->e.error);
  assert_non_null(s->solver);
  assert_int_equal(hk_instance_start(s->solver, &(hk_view){.host = &s->solver->host}, 1, &s->e.error), HK_OK);
}

void test_solver_close(test_solver *s) {
  free(s->A.value);
  hk_block_matrix_free(&s->pattern);
  hk_instance_destroy(s->solver);
  hk_threads_destroy(s->shared.threads);
  test_engine_close(&s->e);
}

void test_matrix_begin(test_solver *s, size_t rows) {
  hk_block_matrix_begin(&s->pattern, rows, rows);
  for (size_t i = 0; i < rows; i++) s->pattern.naming.block(&s->pattern.naming, (uint32_t)i, (uint32_t)i);
}

void test_matrix_pair(test_solver *s, size_t i, size_t j) {
  s->pattern.naming.block(&s->pattern.naming, (uint32_t)i, (uint32_t)j);
  s->pattern.naming.block(&s->pattern.naming, (uint32_t)j, (uint32_t)i);
}

void test_matrix_end(test_solver *s, size_t block) {
  hk_block_matrix *p = &s->pattern;
  size_t rows = p->rows;
  assert_int_equal(hk_block_matrix_build(p), HK_OK);
  free(s->A.value);
  s->A = (hk_matrix){rows, block, p->row_start, p->column, NULL, true, 0};
  s->A.value = calloc(p->row_start[rows] * block * block, sizeof(double));
}

double test_noise(void) {
  static uint64_t bits = 1;
  bits = bits * 6364136223846793005u + 1442695040888963407u;
  return (double)(bits >> 11) * 0x1p-53 - 0.5;
}

static size_t find(const hk_matrix *A, size_t row, size_t column) {
  for (size_t e = A->row_start[row]; e < A->row_start[row + 1]; e++)
    if (A->column[e] == column) return e;
  fail();
  return 0;
}

double *test_matrix_block(const test_solver *s, size_t row, size_t column) {
  return s->A.value + s->A.block * s->A.block * find(&s->A, row, column);
}

static void set_diagonal(const hk_matrix *A, size_t r, size_t k, double margin) {
  size_t b = A->block, at = b * b * find(A, r, r) + (b + 1) * k;
  double sum = 0;
  A->value[at] = 0;
  for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
    for (size_t j = 0; j < b; j++) sum += fabs(A->value[b * b * e + b * k + j]);
  A->value[at] = sum + margin;
}

void test_matrix_fill(test_solver *s, double margin) {
  const hk_matrix *A = &s->A;
  size_t b = A->block;
  for (size_t r = 0; r < A->rows; r++)
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
      for (size_t q = 0; q < b * b; q++) {
        size_t mirror = find(A, A->column[e], r);
        A->value[b * b * e + q] = A->value[b * b * mirror + q % b * b + q / b] = test_noise();
      }
  for (size_t r = 0; r < A->rows; r++)
    for (size_t k = 0; k < b; k++) set_diagonal(A, r, k, margin);
}

double test_matrix_residual(const hk_matrix *A, const double *b, const double *x) {
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

hk_status test_solver_analyze(test_solver *s) { return s->solver->plugin->solver->analyze(s->solver->self, &s->A); }

hk_status test_solver_factorize(test_solver *s) { return s->solver->plugin->solver->factorize(s->solver->self, &s->A); }

hk_status test_solver_solve(test_solver *s, const double *b, double *x, hk_solve_info *info) {
  return s->solver->plugin->solver->solve(s->solver->self, b, x, info);
}
