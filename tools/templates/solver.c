/* NAME: conjugate gradients with the diagonal as preconditioner, for symmetric positive definite matrices. Describe
 * here the method and its source. */
#include "core/plugin.h"

#include <string.h>

typedef struct NAME {
  const hk_host *host;
  size_t n, rows, block; /* n: numbers per vector */
  double *r, *p, *q, *inverse;
  size_t *row_start; /* the matrix, copied: A is valid during analyze and factorize alone */
  uint32_t *column;
  double *value;
} NAME;

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  (void)view;
  ((NAME *)self)->host = host;
  return HK_OK;
}

static void *anew(NAME *p, void *old, size_t bytes) {
  p->host->release(p->host, old);
  return p->host->allocate(p->host, bytes);
}

/* Once per pattern: the only place that allocates. */
static hk_status analyze(void *self, const hk_matrix *A) {
  NAME *p = self;
  size_t blocks = A->row_start[A->rows];
  p->rows = A->rows, p->block = A->block, p->n = A->rows * A->block;
  p->r = anew(p, p->r, (4 * p->n + 1) * sizeof *p->r);
  p->row_start = anew(p, p->row_start, (A->rows + 1) * sizeof *p->row_start);
  p->column = anew(p, p->column, (blocks + 1) * sizeof *p->column);
  p->value = anew(p, p->value, (A->block * A->block * blocks + 1) * sizeof *p->value);
  if (!p->r || !p->row_start || !p->column || !p->value)
    return p->host->fail(p->host, HK_NO_MEMORY, "no memory for %zu unknowns", p->n);
  p->p = p->r + p->n;
  p->q = p->p + p->n;
  p->inverse = p->q + p->n;
  memcpy(p->row_start, A->row_start, (A->rows + 1) * sizeof *p->row_start);
  memcpy(p->column, A->column, blocks * sizeof *p->column);
  return HK_OK;
}

static hk_status factorize(void *self, const hk_matrix *A) {
  NAME *p = self;
  size_t b = A->block;
  memcpy(p->value, A->value, b * b * A->row_start[A->rows] * sizeof *p->value);
  for (size_t i = 0; i < A->rows; i++)
    for (size_t e = A->row_start[i]; e < A->row_start[i + 1]; e++)
      for (size_t c = 0; A->column[e] == i && c < b; c++) {
        double d = A->value[b * b * e + (b + 1) * c];
        if (!(d > 0)) return p->host->fail(p->host, HK_NOT_CONVERGED, "the matrix is not positive definite");
        p->inverse[b * i + c] = 1 / d;
      }
  return HK_OK;
}

/* y = A x, and returns x.y */
static double multiply(const NAME *A, const double *x, double *y) {
  size_t b = A->block;
  double sum = 0;
  for (size_t i = 0; i < A->rows; i++)
    for (size_t r = b * i; r < b * (i + 1); r++) {
      y[r] = 0;
      for (size_t e = A->row_start[i]; e < A->row_start[i + 1]; e++)
        for (size_t c = 0; c < b; c++) y[r] += A->value[b * b * e + b * (r - b * i) + c] * x[b * A->column[e] + c];
      sum += x[r] * y[r];
    }
  return sum;
}

static double weighted(const double *a, const double *w, size_t n) {
  double sum = 0;
  for (size_t e = 0; e < n; e++) sum += a[e] * a[e] * (w ? w[e] : 1);
  return sum;
}

static hk_status solve(void *self, const double *b, double *x, hk_solve_info *info) {
  NAME *s = self;
  double tolerance = info->tolerance > 0 ? info->tolerance : 1e-10, size = weighted(b, NULL, s->n);
  memcpy(s->r, b, s->n * sizeof *b);
  memset(x, 0, s->n * sizeof *x);
  for (size_t e = 0; e < s->n; e++) s->p[e] = s->inverse[e] * s->r[e];
  double rho = weighted(s->r, s->inverse, s->n), left = size;
  for (info->iterations = 0; left > tolerance * tolerance * size; info->iterations++) {
    double curvature = multiply(s, s->p, s->q), before = rho, step = rho / curvature;
    if (!(curvature > 0) || (size_t)info->iterations > 10 * s->n)
      return s->host->fail(s->host, HK_NOT_CONVERGED, "no solution after %d iterations", info->iterations);
    for (size_t e = 0; e < s->n; e++) {
      x[e] += step * s->p[e];
      s->r[e] -= step * s->q[e];
    }
    rho = weighted(s->r, s->inverse, s->n);
    left = weighted(s->r, NULL, s->n);
    for (size_t e = 0; e < s->n; e++) s->p[e] = s->inverse[e] * s->r[e] + rho / before * s->p[e];
  }
  info->residual = size > 0 ? sqrt(left / size) : 0;
  return HK_OK;
}

static const hk_solver solver = {
    .size = sizeof(hk_solver), .flags = HK_ITERATIVE, .analyze = analyze, .factorize = factorize, .solve = solve};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SOLVER,
    .name = "NAME",
    .summary = "conjugate gradients with the diagonal as preconditioner",
    .reference = "Hestenes and Stiefel 1952",
    .instance_size = sizeof(NAME),
    .create = create,
    .solver = &solver,
};
