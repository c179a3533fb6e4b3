/* Jacobians of a fake system by central differences, all n x n blocks, and a dense solver with row exchanges. */
#include "tests/support/fake_solver.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double step = 1e-5; /* of central differences: errors of 1e-10 for states of order 1 */

static fake_system *fake_of(hk_system *s) { return (fake_system *)(void *)s; }

static void set_block(double *blocks, size_t n, size_t row, size_t column, double value) {
  blocks[9 * (row / 3 * n + column / 3) + 3 * (row % 3) + column % 3] = value;
}

static double get_block(const double *blocks, size_t n, size_t row, size_t column) {
  return blocks[9 * (row / 3 * n + column / 3) + 3 * (row % 3) + column % 3];
}

static hk_matrix matrix_of(fake_system *f, double *value) {
  return (hk_matrix){
      .rows = f->system.n, .block = 3, .row_start = f->solver->row_start, .column = f->solver->column, .value = value};
}

static hk_status jacobian(hk_system *s, double t, double *X, unsigned want, hk_matrix *K, hk_matrix *D) {
  fake_system *f = fake_of(s);
  fake_solver *q = f->solver;
  size_t m = 3 * s->n, tail = s->size - 2 * m;
  double *Y = q->work, *plus = Y + s->size, *minus = plus + s->size;
  (void)want;
  for (size_t k = 0; k < 2 * m; k++) {
    for (int side = 0; side < 2; side++) {
      double *a = side ? minus : plus;
      memcpy(Y, X, s->size * sizeof *Y);
      memset(a, 0, (m + tail) * sizeof *a);
      Y[k] += side ? -step : step;
      f->problem.f(f->problem.context, t, Y, Y + m, Y + 2 * m, a, a + m);
    }
    for (size_t r = 0; r < m; r++)
      set_block(k < m ? q->K : q->D, s->n, r, k % m, -f->mass[r / 3] * (plus[r] - minus[r]) / (2 * step));
  }
  f->jacobians++;
  *K = matrix_of(f, q->K);
  *D = matrix_of(f, q->D);
  return HK_OK;
}

static hk_status product(hk_system *s, double t, const double *X, const double *dx, const double *dv, double *dF) {
  fake_solver *q = fake_of(s)->solver;
  hk_matrix K, D;
  double *at = malloc(s->size * sizeof *at);
  if (!at) return s->host->fail(s->host, HK_NO_MEMORY, "no memory for a product");
  memcpy(at, X, s->size * sizeof *at);
  jacobian(s, t, at, 0, &K, &D);
  free(at);
  for (size_t r = 0; r < 3 * s->n; r++) {
    dF[r] = 0;
    for (size_t c = 0; c < 3 * s->n; c++)
      dF[r] -= get_block(q->K, s->n, r, c) * dx[c] + get_block(q->D, s->n, r, c) * dv[c];
  }
  return HK_OK;
}

static hk_status combine(hk_system *s, double m, double d, double k, hk_matrix *A) {
  fake_system *f = fake_of(s);
  fake_solver *q = f->solver;
  for (size_t e = 0; e < 9 * s->n * s->n; e++) q->A[e] = d * q->D[e] + k * q->K[e];
  for (size_t r = 0; r < 3 * s->n; r++) set_block(q->A, s->n, r, r, get_block(q->A, s->n, r, r) + m * f->mass[r / 3]);
  *A = matrix_of(f, q->A);
  return HK_OK;
}

static hk_status factorize(hk_system *s, const hk_matrix *A) {
  fake_system *f = fake_of(s);
  fake_solver *q = f->solver;
  size_t m = 3 * s->n;
  f->factorizations++;
  for (size_t r = 0; r < m; r++)
    for (size_t c = 0; c < m; c++) q->LU[r * m + c] = get_block(A->value, s->n, r, c);
  for (size_t j = 0; j < m; j++) {
    size_t best = j;
    for (size_t r = j; r < m; r++)
      if (fabs(q->LU[r * m + j]) > fabs(q->LU[best * m + j])) best = r;
    q->exchange[j] = best;
    for (size_t c = 0; c < m; c++) {
      double keep = q->LU[j * m + c];
      q->LU[j * m + c] = q->LU[best * m + c];
      q->LU[best * m + c] = keep;
    }
    if (q->LU[j * m + j] == 0) return s->host->fail(s->host, HK_NOT_CONVERGED, "singular");
    for (size_t r = j + 1; r < m; r++) {
      double w = q->LU[r * m + j] /= q->LU[j * m + j];
      for (size_t c = j + 1; c < m; c++) q->LU[r * m + c] -= w * q->LU[j * m + c];
    }
  }
  return HK_OK;
}

static hk_status solve(hk_system *s, const double *b, double *x, hk_solve_info *info) {
  fake_solver *q = fake_of(s)->solver;
  size_t m = 3 * s->n;
  memcpy(x, b, m * sizeof *x);
  for (size_t j = 0; j < m; j++) {
    double keep = x[j];
    x[j] = x[q->exchange[j]];
    x[q->exchange[j]] = keep;
  }
  for (size_t r = 0; r < m; r++)
    for (size_t c = 0; c < r; c++) x[r] -= q->LU[r * m + c] * x[c];
  for (size_t r = m; r-- > 0;) {
    for (size_t c = r + 1; c < m; c++) x[r] -= q->LU[r * m + c] * x[c];
    x[r] /= q->LU[r * m + r];
  }
  if (info) info->iterations = 0, info->residual = 0;
  return HK_OK;
}

static hk_status solver_flags(hk_system *s, unsigned *flags) {
  (void)s;
  *flags = HK_SOLVES_UNSYMMETRIC | HK_SOLVES_INDEFINITE;
  return HK_OK;
}

void fake_solver_attach(fake_system *f) {
  size_t n = f->system.n, m = 3 * n, blocks = 9 * n * n + 1;
  fake_solver *q = f->solver = calloc(1, sizeof *q);
  double *all = calloc(4 * blocks + 3 * f->system.size, sizeof *all);
  q->row_start = calloc(n + 1, sizeof *q->row_start);
  q->column = calloc(n * n + 1, sizeof *q->column);
  q->exchange = calloc(m + 1, sizeof *q->exchange);
  if (!q || !all || !q->row_start || !q->column || !q->exchange) abort();
  q->K = all, q->D = all + blocks, q->A = all + 2 * blocks, q->LU = all + 3 * blocks, q->work = all + 4 * blocks;
  for (size_t r = 0; r < n; r++) {
    q->row_start[r + 1] = (r + 1) * n;
    for (size_t c = 0; c < n; c++) q->column[r * n + c] = (uint32_t)c;
  }
  f->linear.jacobian = jacobian;
  f->linear.product = product;
  f->linear.combine = combine;
  f->linear.factorize = factorize;
  f->linear.solve = solve;
  f->linear.solver_flags = solver_flags;
}

void fake_solver_detach(fake_system *f) {
  free(f->solver->K);
  free(f->solver->row_start);
  free(f->solver->column);
  free(f->solver->exchange);
  free(f->solver);
}
