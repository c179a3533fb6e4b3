/* See conjugate_gradients.h. The residual is the recursive one; when it has reached the tolerance, b - A x is computed,
 * and the iteration restarts from x if that is larger. Vectors are divided into chunks and partial sums are added in
 * their order, so results are bitwise equal for any number of threads. */
#include "plugins/common/gradients/conjugate_gradients.h"

#include <math.h>
#include <string.h>

enum { CHUNK = 4096, SPARE = 8, LEAST_LIMIT = 1000 };

hk_status hk_gradients_no_memory(const hk_host *host, const hk_matrix *A) {
  return host->fail(host, HK_NO_MEMORY, "no memory to store a matrix of %zu rows", A->rows * A->block);
}

hk_status hk_gradients_analyze(hk_gradients *s, const hk_host *host, const hk_matrix *A) {
  size_t unknowns = A->rows * A->block;
  hk_gradients_free(s, host);
  if (A->row_start[A->rows] >= UINT32_MAX)
    return host->fail(host, HK_FAILED, "%zu blocks are more than 32-bit numbers can count", A->row_start[A->rows]);
  s->host = host;
  s->unknowns = unknowns;
  s->chunks = (unknowns + CHUNK - 1) / CHUNK;
  s->vectors = host->allocate(host, 5 * (unknowns + SPARE) * sizeof *s->vectors);
  s->part = host->allocate(host, (2 * s->chunks + 1) * sizeof *s->part);
  if (hk_upper_analyze(&s->A, host, A) != HK_OK || !s->vectors || !s->part) {
    hk_gradients_free(s, host);
    return hk_gradients_no_memory(host, A);
  }
  s->x = s->vectors;
  s->r = s->x + unknowns + SPARE;
  s->z = s->r + unknowns + SPARE;
  s->p = s->z + unknowns + SPARE;
  s->q = s->p + unknowns + SPARE;
  s->rows = A->rows;
  s->block = A->block;
  return HK_OK;
}

hk_status hk_gradients_fill(hk_gradients *s, const hk_host *host, const hk_matrix *A) {
  s->ready = false;
  if (!s->vectors || A->rows != s->rows || A->block != s->block)
    return host->fail(host, HK_FAILED, "the pattern of the matrix was not analysed");
  hk_upper_fill(&s->A, host, A);
  return HK_OK;
}

void hk_gradients_free(hk_gradients *s, const hk_host *host) {
  hk_upper_free(&s->A, host);
  host->release(host, s->vectors);
  host->release(host, s->part);
  *s = (hk_gradients){0};
}

/* ---- Vectors --------------------------------------------------------------------------------------------------- */

typedef struct vector_task {
  hk_gradients *s;
  const double *b;
  double factor;
} vector_task;

/* x += a p, r -= a q; computes the chunk's part of r.r. */
static void advance(void *context, size_t begin, size_t end, size_t chunk) {
  const vector_task *t = context;
  double *restrict x = t->s->x, *restrict r = t->s->r, sum[4] = {0};
  const double *restrict p = t->s->p, *restrict q = t->s->q;
  size_t k = begin;
  for (; k + 4 <= end; k += 4)
    for (size_t c = 0; c < 4; c++) {
      x[k + c] += t->factor * p[k + c];
      r[k + c] -= t->factor * q[k + c];
      sum[c] += r[k + c] * r[k + c];
    }
  for (; k < end; k++) {
    x[k] += t->factor * p[k];
    r[k] -= t->factor * q[k];
    sum[0] += r[k] * r[k];
  }
  t->s->part[2 * chunk] = (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

/* r = b - q; computes the chunk's parts of r.r and b.b. */
static void compare(void *context, size_t begin, size_t end, size_t chunk) {
  const vector_task *t = context;
  double left = 0, whole = 0;
  for (size_t k = begin; k < end; k++) {
    double r = t->b[k] - t->s->q[k];
    t->s->r[k] = r;
    left += r * r;
    whole += t->b[k] * t->b[k];
  }
  t->s->part[2 * chunk] = left;
  t->s->part[2 * chunk + 1] = whole;
}

/* p = z + factor p */
static void update_direction(void *context, size_t begin, size_t end, size_t chunk) {
  const vector_task *t = context;
  const double *restrict z = t->s->z;
  double *restrict p = t->s->p;
  (void)chunk;
  for (size_t k = begin; k < end; k++) p[k] = z[k] + t->factor * p[k];
}

static double add_parts(const hk_gradients *s, size_t which, size_t chunks) {
  double sum = 0;
  for (size_t k = 0; k < chunks; k++) sum += s->part[2 * k + which];
  return sum;
}

static double step_along(hk_gradients *s, double factor) {
  vector_task task = {.s = s, .factor = factor};
  s->host->parallel_for(s->host, s->unknowns, CHUNK, advance, &task);
  return add_parts(s, 0, s->chunks);
}

static void next_direction(hk_gradients *s, double factor) {
  vector_task task = {.s = s, .factor = factor};
  s->host->parallel_for(s->host, s->unknowns, CHUNK, update_direction, &task);
}

/* r = b - A x, with q = A x; returns |r|^2 and sets |b|^2. */
static double true_residual(hk_gradients *s, const double *b, double *whole) {
  vector_task task = {.s = s, .b = b};
  hk_upper_product(&s->A, s->host, s->x, s->q);
  s->host->parallel_for(s->host, s->unknowns, CHUNK, compare, &task);
  *whole = add_parts(s, 1, s->chunks);
  return add_parts(s, 0, s->chunks);
}

/* ---- Solution -------------------------------------------------------------------------------------------------- */

static hk_status stopped(hk_gradients *s, double left, double tolerance, int iterations, const char *why) {
  return s->host->fail(s->host, HK_NOT_CONVERGED,
                       "the residual is %.3g of the right-hand side after %d iterations, asked for was %.3g: %s", left,
                       iterations, tolerance, why);
}

static hk_status bad_curvature(hk_gradients *s, double curvature, int iterations) {
  if (isnan(curvature))
    return s->host->fail(s->host, HK_NOT_FINITE, "the linear system's numbers are not finite, seen after %d iterations",
                         iterations);
  return s->host->fail(s->host, HK_NOT_CONVERGED,
                       "the matrix is not positive definite, seen after %d iterations: p.(A p) = %.3g; the step is too "
                       "long for a force that pushes apart, or the matrix is singular",
                       iterations, curvature);
}

/* Iterates from s->x, whose residual is s->r, until |r|^2 <= goal. */
static hk_status iterate(hk_gradients *s, double goal, int limit, int *iterations, double *left) {
  double rz = s->system->precondition(s->system->context, s->r, s->z);
  next_direction(s, 0);
  while (*iterations < limit) {
    double curvature = hk_upper_product(&s->A, s->host, s->p, s->q);
    if (!(curvature > 0) || !isfinite(rz)) return bad_curvature(s, curvature, *iterations);
    ++*iterations;
    *left = step_along(s, rz / curvature);
    if (!(*left > goal)) break;
    double next = s->system->precondition(s->system->context, s->r, s->z);
    next_direction(s, next / rz);
    rz = next;
  }
  return HK_OK;
}

static int limit_of(const hk_gradients *s, int64_t asked) {
  if (asked > 0) return (int)asked;
  size_t limit = s->unknowns + 10 > LEAST_LIMIT ? s->unknowns + 10 : LEAST_LIMIT;
  return limit < INT32_MAX ? (int)limit : INT32_MAX;
}

hk_status hk_gradients_solve(hk_gradients *s, const hk_host *host, const hk_gradients_system *system, const double *b,
                             double *x, hk_solve_info *info) {
  if (!s->ready) return host->fail(host, HK_FAILED, "there is no matrix to solve with");
  double tolerance = info && info->tolerance > 0 ? info->tolerance : system->tolerance, whole, last = INFINITY;
  int limit = limit_of(s, system->iterations), iterations = 0;
  s->system = system;
  memset(s->vectors, 0, 5 * (s->unknowns + SPARE) * sizeof *s->vectors);
  double left = true_residual(s, b, &whole);
  while (left > tolerance * tolerance * whole) {
    double relative = sqrt(left / whole);
    if (iterations >= limit) return stopped(s, relative, tolerance, iterations, "the limit of iterations is reached");
    if (left > last / 4)
      return stopped(s, relative, tolerance, iterations,
                     "rounding allows no less; ask for a larger tolerance or choose a direct solver");
    last = left;
    hk_status status = iterate(s, tolerance * tolerance * whole, limit, &iterations, &left);
    if (status != HK_OK) return status;
    left = true_residual(s, b, &whole);
  }
  if (!isfinite(left)) return bad_curvature(s, NAN, iterations);
  memcpy(x, s->x, s->unknowns * sizeof *x);
  if (info) *info = (hk_solve_info){iterations, whole > 0 ? sqrt(left / whole) : 0, info->tolerance};
  return HK_OK;
}
