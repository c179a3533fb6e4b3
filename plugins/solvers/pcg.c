/* Conjugate gradients with a preconditioner, for symmetric positive definite matrices that are too large to factorize.
 *
 * This is the method of Baraff and Witkin 1998, section 5, whose filter is already in the matrix: A = S (..) S + s (I -
 * S), with S the filter of the pins, so for a filtered right-hand side every iterate satisfies the pins, bitwise for a
 * fixed particle, whose rows have diagonal entries only. The preconditioners preserve this property: both are built
 * from the same blocks.
 *
 * The residual is the recursive one; when it has reached the tolerance, b - A x is computed, and the iteration restarts
 * from x if that is larger. Vectors are divided into chunks and partial sums are added in their order, so results are
 * bitwise equal for any number of threads. Invariant: between calls `upper` and the preconditioner have the pattern of
 * the last analysis, and `ready` says that they have its numbers. Hestenes and Stiefel 1952, J. Res. NBS 49; Baraff and
 * Witkin 1998, Large steps in cloth simulation.
 *
 * For matrices whose factor does not fit into memory; where it does, `supernodal` is faster: a cloth of 160 x 160
 * particles, k = 1e4 N/m, three steps of linear_bdf2: 9.2 s of the processor by supernodal, 18.1 by this; 32 x 32, 1e6
 * N/m, 24 steps of bdf2: 0.64 and 2.65 s (hooke run scripts/scenes/stiff_cloth.lua --threads 1 --solver NAME).
 */
#include "core/plugin.h"
#include "plugins/common/linear/incomplete_cholesky.h"
#include "plugins/common/linear/upper_matrix.h"

#include <string.h>

enum { BLOCK_JACOBI, INCOMPLETE_CHOLESKY };
enum { CHUNK = 4096, SPARE = 8, LEAST_LIMIT = 1000 };

typedef struct gradients {
  int preconditioner;
  double tolerance;
  int64_t iterations;
  const hk_host *host;
  size_t rows, block, unknowns, chunks; /* sizes of the analysed matrix */
  bool analyzed, ready;
  hk_upper upper;
  hk_incomplete incomplete;
  double *inverse; /* rows x block x block: inverses of the diagonal blocks */
  double *vectors; /* x, r, z, p, q, each of `unknowns` doubles and some padding */
  double *x, *r, *z, *p, *q;
  double *part; /* chunks x 2 */
} gradients;

static const hk_param params[] = {
    {"preconditioner", "", "block_jacobi: inverse 3x3 diagonal blocks; incomplete_cholesky: factors without fill",
     .choice = HK_AT(gradients, preconditioner), .initial = {INCOMPLETE_CHOLESKY},
     .choices = "block_jacobi|incomplete_cholesky"},
    {"tolerance", "", "residual that will do, relative to the right-hand side, where the integrator asks for none",
     .number = HK_AT(gradients, tolerance), .initial = {1e-8}, .limits = HK_ABOVE_TO(0, 1)},
    {"iterations", "",
     "limit; 0: 10 more than there are unknowns, which would do without rounding, or 1000 if that is more",
     .integer = HK_AT(gradients, iterations), .limits = HK_WITHIN(0, 1e9)},
    {0},
};

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  gradients *s = self;
  (void)view;
  s->host = host;
  return HK_OK;
}

/* ---- Pattern and numbers --------------------------------------------------------------------------------------- */

static void forget(gradients *s) {
  hk_upper_free(&s->upper, s->host);
  hk_incomplete_free(&s->incomplete, s->host);
  s->host->release(s->host, s->inverse);
  s->host->release(s->host, s->vectors);
  s->host->release(s->host, s->part);
  s->inverse = s->vectors = s->part = NULL;
  s->analyzed = s->ready = false;
}

static hk_status no_memory(gradients *s, const hk_matrix *A) {
  forget(s);
  return s->host->fail(s->host, HK_NO_MEMORY, "no memory to store a matrix of %zu rows", A->rows * A->block);
}

static hk_status analyze(void *self, const hk_matrix *A) {
  gradients *s = self;
  const hk_host *host = s->host;
  size_t n = A->rows * A->block;
  forget(s);
  if (A->row_start[A->rows] >= UINT32_MAX)
    return host->fail(host, HK_FAILED, "%zu blocks are more than 32-bit numbers can count", A->row_start[A->rows]);
  s->rows = A->rows;
  s->block = A->block;
  s->unknowns = n;
  s->chunks = (n + CHUNK - 1) / CHUNK;
  if (hk_upper_analyze(&s->upper, host, A) != HK_OK) return no_memory(s, A);
  if (s->preconditioner == INCOMPLETE_CHOLESKY && hk_incomplete_analyze(&s->incomplete, host, A) != HK_OK)
    return no_memory(s, A);
  s->inverse = host->allocate(host, (n * A->block + 1) * sizeof *s->inverse);
  s->vectors = host->allocate(host, 5 * (n + SPARE) * sizeof *s->vectors);
  s->part = host->allocate(host, (2 * s->chunks + 1) * sizeof *s->part);
  if (!s->inverse || !s->vectors || !s->part) return no_memory(s, A);
  s->x = s->vectors;
  s->r = s->x + n + SPARE;
  s->z = s->r + n + SPARE;
  s->p = s->z + n + SPARE;
  s->q = s->p + n + SPARE;
  s->analyzed = true;
  return HK_OK;
}

static hk_status not_definite(gradients *s, size_t row) {
  if (s->block != 3)
    return s->host->fail(s->host, HK_NOT_CONVERGED, "the matrix is not positive definite, seen at row %zu", row + 1);
  return s->host->fail(s->host, HK_NOT_CONVERGED,
                       "the matrix is not positive definite, seen at the %zuth particle's %c: the step is too long for "
                       "a force that pushes apart",
                       row / 3 + 1, "xyz"[row % 3]);
}

static hk_status invert_diagonal(gradients *s, const hk_matrix *A) {
  size_t b = s->block, bb = b * b;
  for (size_t r = 0; r < s->rows; r++) {
    size_t e = hk_upper_first(A, r);
    if (e == A->row_start[r + 1] || A->column[e] != r) return not_definite(s, b * r);
    const double *D = A->value + bb * e;
    size_t done = hk_invert_definite(b, D, D, 0, s->inverse + bb * r);
    if (done < b) return not_definite(s, b * r + done);
  }
  return HK_OK;
}

static hk_status factorize(void *self, const hk_matrix *A) {
  gradients *s = self;
  if (!s->analyzed || A->rows != s->rows || A->block != s->block)
    return s->host->fail(s->host, HK_FAILED, "the pattern of the matrix was not analysed");
  s->ready = false;
  hk_status status = invert_diagonal(s, A);
  if (status != HK_OK) return status;
  hk_upper_fill(&s->upper, s->host, A);
  if (s->preconditioner == INCOMPLETE_CHOLESKY && !hk_incomplete_factorize(&s->incomplete, s->host, A))
    return s->host->fail(s->host, HK_NOT_CONVERGED,
                         "the matrix has no incomplete Cholesky factors, however much its diagonal is raised: it is "
                         "not positive definite, or not finite");
  s->ready = true;
  return HK_OK;
}

/* ---- Vectors --------------------------------------------------------------------------------------------------- */

typedef struct vector_task {
  gradients *s;
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

/* z = inverse diagonal blocks times r, by rows; computes the chunk's part of r.z. */
static void apply_diagonal(void *context, size_t begin, size_t end, size_t chunk) {
  const vector_task *t = context;
  const gradients *s = t->s;
  const double *restrict I = s->inverse, *restrict r = s->r;
  double *restrict z = s->z, sum = 0;
  for (size_t k = begin; k < end && s->block == 1; k++) {
    z[k] = I[k] * r[k];
    sum += r[k] * z[k];
  }
  for (size_t k = begin; k < end && s->block == 3; k++) {
    const double *B = I + 9 * k, *u = r + 3 * k;
    double a = B[0] * u[0] + B[1] * u[1] + B[2] * u[2], b = B[3] * u[0] + B[4] * u[1] + B[5] * u[2];
    double c = B[6] * u[0] + B[7] * u[1] + B[8] * u[2];
    z[3 * k] = a;
    z[3 * k + 1] = b;
    z[3 * k + 2] = c;
    sum += u[0] * a + u[1] * b + u[2] * c;
  }
  s->part[2 * chunk] = sum;
}

static double add_parts(const gradients *s, size_t which, size_t chunks) {
  double sum = 0;
  for (size_t k = 0; k < chunks; k++) sum += s->part[2 * k + which];
  return sum;
}

/* z = M^-1 r; returns r.z. */
static double precondition(gradients *s) {
  if (s->preconditioner == INCOMPLETE_CHOLESKY) return hk_incomplete_apply(&s->incomplete, s->host, s->r, s->z);
  vector_task task = {.s = s};
  s->host->parallel_for(s->host, s->rows, CHUNK, apply_diagonal, &task);
  return add_parts(s, 0, (s->rows + CHUNK - 1) / CHUNK);
}

static double step_along(gradients *s, double factor) {
  vector_task task = {.s = s, .factor = factor};
  s->host->parallel_for(s->host, s->unknowns, CHUNK, advance, &task);
  return add_parts(s, 0, s->chunks);
}

static void next_direction(gradients *s, double factor) {
  vector_task task = {.s = s, .factor = factor};
  s->host->parallel_for(s->host, s->unknowns, CHUNK, update_direction, &task);
}

/* r = b - A x, with q = A x; returns |r|^2 and sets |b|^2. */
static double true_residual(gradients *s, const double *b, double *whole) {
  vector_task task = {.s = s, .b = b};
  hk_upper_product(&s->upper, s->host, s->x, s->q);
  s->host->parallel_for(s->host, s->unknowns, CHUNK, compare, &task);
  *whole = add_parts(s, 1, s->chunks);
  return add_parts(s, 0, s->chunks);
}

/* ---- Solution -------------------------------------------------------------------------------------------------- */

static hk_status stopped(gradients *s, double left, double tolerance, int iterations, const char *why) {
  return s->host->fail(s->host, HK_NOT_CONVERGED,
                       "the residual is %.3g of the right-hand side after %d iterations, asked for was %.3g: %s", left,
                       iterations, tolerance, why);
}

static hk_status bad_curvature(gradients *s, double curvature, int iterations) {
  if (isnan(curvature))
    return s->host->fail(s->host, HK_NOT_FINITE, "the linear system's numbers are not finite, seen after %d iterations",
                         iterations);
  return s->host->fail(s->host, HK_NOT_CONVERGED,
                       "the matrix is not positive definite, seen after %d iterations: p.(A p) = %.3g; the step is too "
                       "long for a force that pushes apart, or the matrix is singular",
                       iterations, curvature);
}

/* Iterates from s->x, whose residual is s->r, until |r|^2 <= goal. */
static hk_status iterate(gradients *s, double goal, int limit, int *iterations, double *left) {
  double rz = precondition(s);
  next_direction(s, 0);
  while (*iterations < limit) {
    double curvature = hk_upper_product(&s->upper, s->host, s->p, s->q);
    if (!(curvature > 0) || !isfinite(rz)) return bad_curvature(s, curvature, *iterations);
    ++*iterations;
    *left = step_along(s, rz / curvature);
    if (!(*left > goal)) break;
    double next = precondition(s);
    next_direction(s, next / rz);
    rz = next;
  }
  return HK_OK;
}

static int limit_of(const gradients *s) {
  if (s->iterations > 0) return (int)s->iterations;
  size_t limit = s->unknowns + 10 > LEAST_LIMIT ? s->unknowns + 10 : LEAST_LIMIT;
  return limit < INT32_MAX ? (int)limit : INT32_MAX;
}

static hk_status solve(void *self, const double *b, double *x, hk_solve_info *info) {
  gradients *s = self;
  if (!s->ready) return s->host->fail(s->host, HK_FAILED, "there is no matrix to solve with");
  double tolerance = info && info->tolerance > 0 ? info->tolerance : s->tolerance, whole, last = INFINITY;
  int limit = limit_of(s), iterations = 0;
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

static const hk_solver solver = {
    .size = sizeof(hk_solver), .flags = HK_ITERATIVE, .analyze = analyze, .factorize = factorize, .solve = solve};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SOLVER,
    .name = "pcg",
    .summary = "preconditioned conjugate gradients, for large symmetric positive definite matrices",
    .reference = "Hestenes and Stiefel 1952; Baraff and Witkin 1998, section 5; Manteuffel 1980",
    .instance_size = sizeof(gradients),
    .params = params,
    .create = create,
    .solver = &solver,
};
