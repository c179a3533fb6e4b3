/* Baraff and Witkin 1998, section 5.3: the iterates leave z only by directions that went through the filter, so what is
 * prescribed is met by every one of them. With P the diagonal of A, S the filter,
 *     r = S (b - A dv), c = S P^-1 r;   q = S A c, dv += (r.s/c.q) c, r -= (r.s/c.q) q, s = P^-1 r, c = S (s + beta c).
 */
#include "plugins/common/linear/filtered_gradients.h"
#include "plugins/common/linear/block_product.h"

#include <string.h>

typedef struct gradients {
  const hk_filtered_equations *of;
  size_t size;
  bool damped;
  double *r, *c, *q, *s, *inverse, *spare;
} gradients;

static double dot(const double *a, const double *b, size_t n) {
  double sum[4] = {0};
  for (size_t k = 0; k + 4 <= n; k += 4)
    for (size_t l = 0; l < 4; l++) sum[l] += a[k + l] * b[k + l];
  for (size_t k = n / 4 * 4; k < n; k++) sum[0] += a[k] * b[k];
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* q = A x */
static void multiply(const gradients *g, const double *x, double *q) {
  const hk_filtered_equations *e = g->of;
  hk_block_product(e->host, e->K, x, q);
  if (g->damped) hk_block_product(e->host, e->D, x, g->spare);
  for (size_t k = 0; k < g->size; k++)
    q[k] = e->mass[k / 3] * x[k] + e->h * (e->h * q[k] + (g->damped ? g->spare[k] : 0));
}

static hk_status not_definite(const gradients *g, double curvature) {
  if (isnan(curvature))
    return g->of->host->fail(g->of->host, HK_NOT_FINITE, "the equations of the step are not finite");
  return g->of->host->fail(g->of->host, HK_NOT_CONVERGED,
                           "the matrix of the step is not positive definite (c.A c = %.3g): the step is too long for a "
                           "force that pushes apart",
                           curvature);
}

/* The inverse of A's diagonal; and whether anything is damped. */
static hk_status precondition(gradients *g) {
  const hk_filtered_equations *e = g->of;
  g->damped = false;
  for (size_t k = 0; k < 9 * e->D->row_start[e->D->rows] && !g->damped; k++) g->damped = e->D->value[k] != 0;
  for (size_t row = 0; row < e->K->rows; row++) {
    size_t at = e->K->row_start[row];
    while (e->K->column[at] != row) at++;
    for (size_t c = 0; c < 3; c++) {
      double p = e->mass[row] + e->h * (e->D->value[9 * at + 4 * c] + e->h * e->K->value[9 * at + 4 * c]);
      if (!(p > 0)) return not_definite(g, p);
      g->inverse[3 * row + c] = 1 / p;
    }
  }
  return HK_OK;
}

/* r = b - A dv */
static void residual_of(const gradients *g, const double *dv, double *r) {
  multiply(g, dv, g->q);
  for (size_t k = 0; k < g->size; k++) r[k] = g->of->b[k] - g->q[k];
}

static double scaled(gradients *g, const double *r) {
  for (size_t k = 0; k < g->size; k++) g->s[k] = g->inverse[k] * r[k];
  return dot(r, g->s, g->size);
}

static hk_status iterate(gradients *g, double *dv, double goal, int limit, int *iterations) {
  const hk_filtered_equations *e = g->of;
  double left = scaled(g, g->r);
  memcpy(g->c, g->s, g->size * sizeof *g->c);
  e->filter(e->context, g->c);
  while (left > goal && *iterations < limit) {
    multiply(g, g->c, g->q);
    e->filter(e->context, g->q);
    double curvature = dot(g->c, g->q, g->size), along = left / curvature;
    if (!(curvature > 0)) return not_definite(g, curvature);
    for (size_t k = 0; k < g->size; k++) dv[k] += along * g->c[k], g->r[k] -= along * g->q[k];
    double next = scaled(g, g->r);
    for (size_t k = 0; k < g->size; k++) g->c[k] = g->s[k] + next / left * g->c[k];
    e->filter(e->context, g->c);
    left = next;
    ++*iterations;
  }
  return isfinite(left) ? HK_OK : not_definite(g, NAN);
}

/* The residual of the iteration drifts from that of dv: it begins again from there, at most a few times. */
static hk_status solve(gradients *g, double *dv, double tolerance, int *iterations) {
  const hk_filtered_equations *e = g->of;
  const int limit = g->size < 1000 ? 1000 : (int)g->size + 10;
  memcpy(g->r, e->b, g->size * sizeof *g->r);
  e->filter(e->context, g->r);
  double whole = scaled(g, g->r), left = INFINITY;
  for (int again = 0; again < 5; again++) {
    residual_of(g, dv, g->r);
    e->filter(e->context, g->r);
    left = scaled(g, g->r);
    if (again == 0) whole = fmax(whole, left);
    if (left <= tolerance * tolerance * whole) return HK_OK;
    hk_status status = iterate(g, dv, tolerance * tolerance * whole / 4, limit, iterations);
    if (status != HK_OK) return status;
  }
  return e->host->fail(e->host, HK_NOT_CONVERGED,
                       "the residual is %.3g of the right-hand side after %d iterations, asked for was %.3g",
                       sqrt(left / whole), *iterations, tolerance);
}

hk_status hk_filtered_gradients(const hk_filtered_equations *e, double *dv, double tolerance, double *work,
                                const double **residual, int *iterations) {
  size_t n = 3 * e->K->rows;
  gradients g = {e, n, false, work, work + n, work + 2 * n, work + 3 * n, work + 4 * n, work + 5 * n};
  *iterations = 0;
  hk_status status = precondition(&g);
  if (status == HK_OK) status = solve(&g, dv, tolerance, iterations);
  if (status == HK_OK) residual_of(&g, dv, g.r);
  *residual = g.r;
  return status;
}
