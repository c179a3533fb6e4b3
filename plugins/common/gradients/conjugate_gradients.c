/* See conjugate_gradients.h. The residual is the recursive one; when it has reached the tolerance, b - A x is computed,
 * and the iteration restarts from x if that is larger. */
#include "plugins/common/gradients/conjugate_gradients.h"

#include <math.h>
#include <string.h>

enum { SPARE = 8, LEAST_LIMIT = 1000 };

hk_status hk_gradients_no_memory(const hk_host *host, const hk_matrix *A) {
  return host->fail(host, HK_NO_MEMORY, "no memory to store a matrix of %zu rows", A->rows * A->block);
}

hk_status hk_gradients_analyze(hk_gradients *s, const hk_host *host, const hk_matrix *A) {
  size_t unknowns = A->rows * A->block;
  hk_gradients_free(s, host);
  if (A->row_start[A->rows] >= UINT32_MAX)
    return host->fail(host, HK_FAILED, "%zu blocks are more than 32-bit numbers can count", A->row_start[A->rows]);
  hk_gradients_loop *loop = &s->loop;
  s->host = loop->host = host;
  loop->unknowns = unknowns;
  s->vectors = host->allocate(host, 5 * (unknowns + SPARE) * sizeof *s->vectors);
  loop->part = host->allocate(host, (hk_gradients_chunks(unknowns) + 1) * sizeof *loop->part);
  s->whole = host->allocate(host, (hk_gradients_chunks(unknowns) + 1) * sizeof *s->whole);
  if (hk_upper_analyze(&s->A, host, A) != HK_OK || !s->vectors || !loop->part || !s->whole) {
    hk_gradients_free(s, host);
    return hk_gradients_no_memory(host, A);
  }
  loop->x = s->vectors;
  loop->r = loop->x + unknowns + SPARE;
  loop->z = loop->r + unknowns + SPARE;
  loop->p = loop->z + unknowns + SPARE;
  loop->q = loop->p + unknowns + SPARE;
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
  host->release(host, s->loop.part);
  host->release(host, s->whole);
  *s = (hk_gradients){0};
}

/* ---- The residual ---------------------------------------------------------------------------------------------- */

typedef struct residual_task {
  hk_gradients *s;
  const double *b;
} residual_task;

/* r = b - q; computes the chunk's parts of r.r and b.b. */
static void compare(void *context, size_t begin, size_t end, size_t chunk) {
  const residual_task *t = context;
  double left = 0, whole = 0;
  for (size_t k = begin; k < end; k++) {
    double r = t->b[k] - t->s->loop.q[k];
    t->s->loop.r[k] = r;
    left += r * r;
    whole += t->b[k] * t->b[k];
  }
  t->s->loop.part[chunk].squares = left;
  t->s->whole[chunk] = whole;
}

/* r = b - A x, with q = A x; returns |r|^2 and sets |b|^2. */
static double true_residual(hk_gradients *s, const double *b, double *whole) {
  residual_task task = {s, b};
  double left = 0;
  hk_upper_product(&s->A, s->host, s->loop.x, s->loop.q);
  s->host->parallel_for(s->host, s->loop.unknowns, HK_GRADIENTS_CHUNK, compare, &task);
  *whole = 0;
  for (size_t k = 0; k < hk_gradients_chunks(s->loop.unknowns); k++) {
    left += s->loop.part[k].squares;
    *whole += s->whole[k];
  }
  return left;
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

static double product(void *context, const double *p, double *q) {
  hk_gradients *s = context;
  return hk_upper_product(&s->A, s->host, p, q);
}

static double precondition(void *context, const double *r, double *z) {
  const hk_gradients_system *system = ((hk_gradients *)context)->system;
  return system->precondition(system->context, r, z);
}

static int limit_of(const hk_gradients *s, int64_t asked) {
  if (asked > 0) return (int)asked;
  size_t limit = s->loop.unknowns + 10 > LEAST_LIMIT ? s->loop.unknowns + 10 : LEAST_LIMIT;
  return limit < INT32_MAX ? (int)limit : INT32_MAX;
}

hk_status hk_gradients_solve(hk_gradients *s, const hk_host *host, const hk_gradients_system *system, const double *b,
                             double *x, hk_solve_info *info) {
  if (!s->ready) return host->fail(host, HK_FAILED, "there is no matrix to solve with");
  double tolerance = info && info->tolerance > 0 ? info->tolerance : system->tolerance, whole, last = INFINITY;
  int limit = limit_of(s, system->iterations);
  hk_gradients_loop *loop = &s->loop;
  s->system = system;
  loop->context = s;
  loop->product = product;
  loop->precondition = precondition;
  loop->iterations = 0;
  memset(s->vectors, 0, 5 * (loop->unknowns + SPARE) * sizeof *s->vectors);
  double left = true_residual(s, b, &whole);
  while (left > tolerance * tolerance * whole) {
    double relative = sqrt(left / whole);
    if (loop->iterations >= limit)
      return stopped(s, relative, tolerance, loop->iterations, "the limit of iterations is reached");
    if (left > last / 4)
      return stopped(s, relative, tolerance, loop->iterations,
                     "rounding allows no less; ask for a larger tolerance or choose a direct solver");
    last = left;
    hk_residual goal = {tolerance * tolerance * whole, INFINITY};
    if (!hk_gradients_iterate(loop, &goal, limit)) return bad_curvature(s, loop->curvature, loop->iterations);
    left = true_residual(s, b, &whole);
  }
  if (!isfinite(left)) return bad_curvature(s, NAN, loop->iterations);
  memcpy(x, loop->x, loop->unknowns * sizeof *x);
  if (info) *info = (hk_solve_info){loop->iterations, whole > 0 ? sqrt(left / whole) : 0, info->tolerance};
  return HK_OK;
}
