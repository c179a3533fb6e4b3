/* NAME: conjugate gradients with the diagonal as preconditioner, for symmetric positive definite matrices. Describe here
 * the method and its source. */
#include "core/plugin.h"

#include <string.h>

typedef struct NAME {
  const hk_host *host;
  const hk_matrix *A;
  size_t n, room; /* numbers per vector; vectors have room for so many */
  double *r, *p, *q, *inverse;
} NAME;

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  (void)view;
  ((NAME *)self)->host = host;
  return HK_OK;
}

/* Once per pattern: the only place that allocates. */
static hk_status analyze(void *self, const hk_matrix *A) {
  NAME *p = self;
  p->n = A->rows * A->block;
  if (p->n <= p->room) return HK_OK;
  p->host->release(p->host, p->r);
  p->r = p->host->allocate(p->host, 4 * p->n * sizeof *p->r);
  p->room = p->r ? p->n : 0;
  if (!p->r) return p->host->fail(p->host, HK_NO_MEMORY, "no memory for %zu unknowns", p->n);
  p->p = p->r + p->n;
  p->q = p->p + p->n;
  p->inverse = p->q + p->n;
  return HK_OK;
}

static hk_status factorize(void *self, const hk_matrix *A) {
  NAME *p = self;
  size_t b = A->block;
  p->A = A;
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
static double multiply(const hk_matrix *A, const double *x, double *y) {
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
    double curvature = multiply(s->A, s->p, s->q), before = rho, step = rho / curvature;
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
