/* Random symmetric matrices of given graphs, and a solver plugin to solve them with, for tests and benchmarks of
 * solvers. */
#ifndef TEST_SOLVER_MATRIX_H
#define TEST_SOLVER_MATRIX_H

#include "core/numerics/matrix/matrix.h"
#include "tests/support/engine.h"

typedef struct test_solver {
  test_engine e;
  hk_shared shared; /* the solver's, in place of a run's */
  hk_instance *solver;
  hk_block_matrix pattern;
  hk_matrix A;
} test_solver;

/* Opens the solver `name` on `threads` threads. */
void test_solver_open(test_solver *, const char *name, int threads);
void test_solver_close(test_solver *);

/* Begins a matrix without blocks off the diagonal; test_matrix_end makes A of it, filled with zeros. */
void test_matrix_begin(test_solver *, size_t rows);
void test_matrix_pair(test_solver *, size_t i, size_t j);
void test_matrix_end(test_solver *, size_t block);
/* Random numbers, symmetric; the diagonal exceeds the sum of its row by `margin`, so for margin > 0 A is definite. */
void test_matrix_fill(test_solver *, double margin);
double *test_matrix_block(const test_solver *, size_t row, size_t column);

double test_noise(void); /* uniform in [-0.5, 0.5), the same sequence in every process */
/* |b - A x| / |b|, with both triangles: independent of what the solver says. */
double test_matrix_residual(const hk_matrix *A, const double *b, const double *x);

hk_status test_solver_analyze(test_solver *);
hk_status test_solver_factorize(test_solver *);
hk_status test_solver_solve(test_solver *, const double *b, double *x, hk_solve_info *info);

#endif
