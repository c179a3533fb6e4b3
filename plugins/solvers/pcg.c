/* Conjugate gradients with a preconditioner, for symmetric positive definite matrices that are too large to factorize.
 *
 * This is the method of Baraff and Witkin 1998, section 5, whose filter is already in the matrix: A = S (..) S + s (I -
 * S), with S the filter of the pins, so for a filtered right-hand side every iterate satisfies the pins, bitwise for a
 * fixed particle, whose rows have diagonal entries only. The preconditioners preserve this property: both are built
 * from the same blocks.
 *
 * The iteration is that of plugins/common/gradients/conjugate_gradients. Invariant: between calls `gradients` and
 * the preconditioner have the pattern of the last analysis, and `ready` says that they have its numbers. Hestenes and
 * Stiefel 1952, J. Res. NBS 49; Baraff and Witkin 1998, Large steps in cloth simulation.
 *
 * For matrices whose factor does not fit into memory; where it does, `supernodal` is faster: a cloth of 160 x 160
 * particles, k = 1e4 N/m, three steps of linear_bdf2: 9.2 s of the processor by supernodal, 18.1 by this; 32 x 32, 1e6
 * N/m, 24 steps of bdf2: 0.64 and 2.65 s (hooke run scripts/scenes/stiff_cloth.lua --threads 1 --solver NAME).
 */
#include "core/plugin.h"
#include "plugins/common/gradients/conjugate_gradients.h"
#include "plugins/common/linear/incomplete_cholesky.h"

enum { BLOCK_JACOBI, INCOMPLETE_CHOLESKY };
enum { CHUNK = 4096 };

typedef struct gradients {
  int preconditioner;
  double tolerance;
  int64_t iterations;
  const hk_host *host;
  hk_incomplete incomplete;
  hk_gradients gradients;
  double *inverse;  /* rows x block x block: inverses of the diagonal blocks */
  const double *r;  /* what block_jacobi is given, */
  double *z, *part; /* and what it gives; a sum for each chunk of rows */
} gradients;

static const hk_param params[] = {
    {"preconditioner", "", "block_jacobi: inverse 3x3 diagonal blocks; incomplete_cholesky: factors without fill",
     .choice = HK_AT(gradients, preconditioner), .initial = {INCOMPLETE_CHOLESKY},
     .choices = "block_jacobi|incomplete_cholesky"},
    HK_GRADIENTS_PARAMS(gradients),
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
  hk_incomplete_free(&s->incomplete, s->host);
  hk_gradients_free(&s->gradients, s->host);
  s->host->release(s->host, s->inverse);
  s->host->release(s->host, s->part);
  s->inverse = s->part = NULL;
}

static hk_status analyze(void *self, const hk_matrix *A) {
  gradients *s = self;
  const hk_host *host = s->host;
  forget(s);
  hk_status status = hk_gradients_analyze(&s->gradients, host, A);
  if (status != HK_OK) return status;
  bool incomplete = s->preconditioner == INCOMPLETE_CHOLESKY;
  s->inverse = host->allocate(host, (A->rows * A->block * A->block + 1) * sizeof *s->inverse);
  s->part = host->allocate(host, (A->rows / CHUNK + 1) * sizeof *s->part);
  if (s->inverse && s->part && (!incomplete || hk_incomplete_analyze(&s->incomplete, host, A) == HK_OK)) return HK_OK;
  forget(s);
  return hk_gradients_no_memory(host, A);
}

static hk_status not_definite(gradients *s, size_t row) {
  if (s->gradients.block != 3)
    return s->host->fail(s->host, HK_NOT_CONVERGED, "the matrix is not positive definite, seen at row %zu", row + 1);
  return s->host->fail(s->host, HK_NOT_CONVERGED,
                       "the matrix is not positive definite, seen at the %zuth particle's %c: the step is too long for "
                       "a force that pushes apart",
                       row / 3 + 1, "xyz"[row % 3]);
}

static hk_status invert_diagonal(gradients *s, const hk_matrix *A) {
  size_t b = s->gradients.block, bb = b * b;
  for (size_t r = 0; r < s->gradients.rows; r++) {
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
  hk_status status = hk_gradients_fill(&s->gradients, s->host, A);
  if (status == HK_OK) status = invert_diagonal(s, A);
  if (status != HK_OK) return status;
  if (s->preconditioner == INCOMPLETE_CHOLESKY && !hk_incomplete_factorize(&s->incomplete, s->host, A))
    return s->host->fail(s->host, HK_NOT_CONVERGED,
                         "the matrix has no incomplete Cholesky factors, however much its diagonal is raised: it is "
                         "not positive definite, or not finite");
  s->gradients.ready = true;
  return HK_OK;
}

/* ---- Preconditioners and solution ------------------------------------------------------------------------------ */

/* z = inverse diagonal blocks times r, by rows; computes the chunk's part of r.z. */
static void apply_diagonal(void *context, size_t begin, size_t end, size_t chunk) {
  const gradients *s = context;
  const double *restrict I = s->inverse, *restrict r = s->r;
  double *restrict z = s->z, sum = 0;
  for (size_t k = begin; k < end && s->gradients.block == 1; k++) {
    z[k] = I[k] * r[k];
    sum += r[k] * z[k];
  }
  for (size_t k = begin; k < end && s->gradients.block == 3; k++) {
    const double *B = I + 9 * k, *u = r + 3 * k;
    double a = B[0] * u[0] + B[1] * u[1] + B[2] * u[2], b = B[3] * u[0] + B[4] * u[1] + B[5] * u[2];
    double c = B[6] * u[0] + B[7] * u[1] + B[8] * u[2];
    z[3 * k] = a;
    z[3 * k + 1] = b;
    z[3 * k + 2] = c;
    sum += u[0] * a + u[1] * b + u[2] * c;
  }
  s->part[chunk] = sum;
}

static double block_jacobi(void *context, const double *r, double *z) {
  gradients *s = context;
  double sum = 0;
  s->r = r;
  s->z = z;
  s->host->parallel_for(s->host, s->gradients.rows, CHUNK, apply_diagonal, s);
  for (size_t k = 0; k < (s->gradients.rows + CHUNK - 1) / CHUNK; k++) sum += s->part[k];
  return sum;
}

static double incomplete_cholesky(void *context, const double *r, double *z) {
  const gradients *s = context;
  return hk_incomplete_apply(&s->incomplete, s->host, r, z);
}

static hk_status solve(void *self, const double *b, double *x, hk_solve_info *info) {
  gradients *s = self;
  bool jacobi = s->preconditioner == BLOCK_JACOBI;
  hk_gradients_system system = {jacobi ? block_jacobi : incomplete_cholesky, s, s->tolerance, s->iterations};
  return hk_gradients_solve(&s->gradients, s->host, &system, b, x, info);
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
