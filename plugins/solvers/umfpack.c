/* Sparse LU factorization P R A Q = L U of any square matrix, by UMFPACK: for the unsymmetric Jacobians of wind, of
 * follower forces, and of springs damped along their direction.
 *
 * `analyze` writes the rows of A as compressed columns, which is A^T, and has UMFPACK order its pattern without values,
 * so that the order does not depend on the state at the analysis; `factorize` updates the values and the factors;
 * `solve` solves with the transpose and up to two steps of iterative refinement. The matrix is singular when a pivot is
 * at rounding level relative to its column, with the rows scaled as by UMFPACK, so that units and ratios of masses do
 * not matter. The BLAS uses one thread, since the order of sums in a threaded BLAS depends on the machine. Invariant:
 * `symbolic` fits start and row; `numeric` is not NULL only if the numbers in `value` were factorized. Davis, Algorithm
 * 832: UMFPACK V4.3, ACM TOMS 30 (2004).
 *
 * For unsymmetric matrices alone: on a symmetric one it takes fifteen times as long as `supernodal` (9.5 and 0.64 s, as
 * in cholmod.c).
 */
#include "core/plugin.h"
#include "plugins/common/linear/blas.h"
#include "plugins/common/linear/blas_name.h"

#include <float.h>
#include <stdio.h>
#include <umfpack.h>

/* SuiteSparse 5 has a type of its own, which later versions know as int64_t. */
#ifdef SuiteSparse_long
typedef SuiteSparse_long integer;
#else
typedef int64_t integer;
#endif

/* A smaller ratio of a pivot to its column is the result of cancellation in a singular matrix. */
static const double rounding = 64 * DBL_EPSILON;

typedef struct lu {
  const hk_host *host;
  size_t rows, block, unknowns; /* sizes of the analysed matrix */
  void *symbolic, *numeric;
  integer *start, *row; /* A^T by columns: row k of A is column k */
  double *value;
  integer *integers; /* unknowns: workspace */
  integer *P, *Q;    /* unknowns each: the order of rows and columns of A^T */
  double *pivot;     /* unknowns: diagonal of U */
  double *scale;     /* unknowns: of the rows of A^T */
  double *work;      /* 5 unknowns */
} lu;

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  lu *s = self;
  (void)view;
  s->host = host;
  hk_blas_stay_loaded();
  hk_blas_warn(host, "UMFPACK");
  return HK_OK;
}

static void forget(lu *s) {
  const hk_host *host = s->host;
  if (s->numeric) umfpack_dl_free_numeric(&s->numeric);
  if (s->symbolic) umfpack_dl_free_symbolic(&s->symbolic);
  host->release(host, s->start);
  host->release(host, s->row);
  host->release(host, s->value);
  host->release(host, s->integers);
  host->release(host, s->P);
  host->release(host, s->Q);
  host->release(host, s->pivot);
  host->release(host, s->scale);
  host->release(host, s->work);
  *s = (lu){.host = host};
}

static void destroy(void *self, const hk_host *host) {
  lu *s = self;
  if (s->host == host) forget(s);
}

static hk_status failed(const lu *s, const char *what, size_t unknowns, integer status) {
  if (status == UMFPACK_ERROR_out_of_memory)
    return s->host->fail(s->host, HK_NO_MEMORY, "no memory to %s a matrix of %zu rows", what, unknowns);
  return s->host->fail(s->host, HK_FAILED, "cannot %s a matrix of %zu rows: UMFPACK status %ld", what, unknowns,
                       (long)status);
}

/* Row b r + k of A becomes column b r + k. Without `start` only the values are copied. */
static void fill(const hk_matrix *A, integer *start, integer *row, double *value) {
  size_t b = A->block, at = 0, column = 0;
  for (size_t r = 0; r < A->rows; r++)
    for (size_t k = 0; k < b; k++, column++) {
      if (start) start[column] = (integer)at;
      for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
        for (size_t j = 0; j < b; j++, at++) {
          if (row) row[at] = (integer)(b * A->column[e] + j);
          value[at] = A->value[b * b * e + b * k + j];
        }
    }
  if (start) start[column] = (integer)at;
}

static bool get_memory(lu *s, size_t entries) {
  const hk_host *host = s->host;
  size_t n = s->unknowns + 1;
  s->start = host->allocate(host, n * sizeof *s->start);
  s->row = host->allocate(host, (entries + 1) * sizeof *s->row);
  s->value = host->allocate(host, (entries + 1) * sizeof *s->value);
  s->integers = host->allocate(host, n * sizeof *s->integers);
  s->P = host->allocate(host, n * sizeof *s->P);
  s->Q = host->allocate(host, n * sizeof *s->Q);
  s->pivot = host->allocate(host, n * sizeof *s->pivot);
  s->scale = host->allocate(host, n * sizeof *s->scale);
  s->work = host->allocate(host, 5 * n * sizeof *s->work);
  return s->start && s->row && s->value && s->integers && s->P && s->Q && s->pivot && s->scale && s->work;
}

static hk_status analyze(void *self, const hk_matrix *A) {
  lu *s = self;
  size_t b = A->block, n = A->rows * b;
  forget(s);
  s->rows = A->rows;
  s->block = b;
  s->unknowns = n;
  if (!get_memory(s, A->row_start[A->rows] * b * b)) {
    forget(s);
    return failed(s, "store", n, UMFPACK_ERROR_out_of_memory);
  }
  fill(A, s->start, s->row, s->value);
  hk_blas_threads(1);
  integer status = umfpack_dl_symbolic((integer)n, (integer)n, s->start, s->row, NULL, &s->symbolic, NULL, NULL);
  if (status == UMFPACK_OK) return HK_OK;
  forget(s);
  return failed(s, "analyse", n, status);
}

static hk_status not_finite(const lu *s) {
  for (size_t k = 0; k < s->unknowns; k++)
    for (integer e = s->start[k]; e < s->start[k + 1]; e++)
      if (!isfinite(s->value[e]))
        return s->host->fail(s->host, HK_NOT_FINITE, "the matrix is not finite: row %zu, column %ld", k + 1,
                             (long)s->row[e] + 1);
  return HK_OK;
}

/* The largest number of column k of A^T as UMFPACK scaled it. */
static double column_size(const lu *s, size_t k, bool reciprocal) {
  double most = 0;
  for (integer e = s->start[k]; e < s->start[k + 1]; e++) {
    double scale = s->scale[s->row[e]];
    most = fmax(most, fabs(reciprocal ? s->value[e] * scale : s->value[e] / scale));
  }
  return most;
}

/* Finds the pivot with the smallest ratio to its column; *fraction: this ratio. */
static hk_status least_pivot(lu *s, size_t *least, double *fraction) {
  integer reciprocal;
  integer status = umfpack_dl_get_numeric(NULL, NULL, NULL, NULL, NULL, NULL, s->P, s->Q, s->pivot, &reciprocal,
                                          s->scale, s->numeric);
  if (status != UMFPACK_OK) return failed(s, "read the factors of", s->unknowns, status);

  for (size_t k = 0; k < s->unknowns; k++) {
    double pivot = fabs(s->pivot[k]), size = column_size(s, (size_t)s->Q[k], reciprocal != 0);
    double here = pivot > 0 ? pivot / size : 0;
    if (here < *fraction) *fraction = here, *least = k;
  }
  return HK_OK;
}

static hk_status check_pivots(lu *s) {
  size_t k = 0;
  double fraction = INFINITY;
  hk_status status = least_pivot(s, &k, &fraction);
  if (status != HK_OK || fraction > rounding) return status;
  size_t row = (size_t)s->Q[k], column = (size_t)s->P[k];
  if (s->block != 3)
    return s->host->fail(s->host, HK_NOT_CONVERGED,
                         "the matrix is singular, seen at row %zu, column %zu (a pivot is %.2g of its row)", row + 1,
                         column + 1, fraction);
  return s->host->fail(s->host, HK_NOT_CONVERGED,
                       "the matrix is singular: nothing determines the %zuth particle's %c (in the equation of the "
                       "%zuth's %c its pivot is %.2g of the row)",
                       column / 3 + 1, "xyz"[column % 3], row / 3 + 1, "xyz"[row % 3], fraction);
}

static hk_status factorize(void *self, const hk_matrix *A) {
  lu *s = self;
  if (!s->symbolic || A->rows != s->rows || A->block != s->block)
    return s->host->fail(s->host, HK_FAILED, "the pattern of the matrix was not analysed");
  if (s->numeric) umfpack_dl_free_numeric(&s->numeric);
  fill(A, NULL, NULL, s->value);
  hk_status fine = not_finite(s);
  if (fine != HK_OK) return fine;
  hk_blas_threads(1);
  integer status = umfpack_dl_numeric(s->start, s->row, s->value, s->symbolic, &s->numeric, NULL, NULL);
  if (status != UMFPACK_OK && status != UMFPACK_WARNING_singular_matrix)
    return failed(s, "factorize", s->unknowns, status);
  fine = check_pivots(s);
  if (fine != HK_OK) umfpack_dl_free_numeric(&s->numeric);
  return fine;
}

/* |b - A x| / |b| */
static double residual(const lu *s, const double *b, const double *x) {
  double left = 0, whole = 0;
  for (size_t k = 0; k < s->unknowns; k++) {
    double r = b[k];
    for (integer e = s->start[k]; e < s->start[k + 1]; e++) r -= s->value[e] * x[s->row[e]];
    left += r * r;
    whole += b[k] * b[k];
  }
  return whole == 0 ? 0 : sqrt(left / whole); /* NaN is returned as NaN */
}

static hk_status solve(void *self, const double *b, double *x, hk_solve_info *info) {
  lu *s = self;
  if (!s->numeric) return s->host->fail(s->host, HK_FAILED, "there is no factorization to solve with");
  integer status =
      umfpack_dl_wsolve(UMFPACK_At, s->start, s->row, s->value, x, b, s->numeric, NULL, NULL, s->integers, s->work);
  if (status != UMFPACK_OK) return failed(s, "solve", s->unknowns, status);
  double left = residual(s, b, x);
  if (!isfinite(left)) return s->host->fail(s->host, HK_NOT_FINITE, "the solution of a linear system is not finite");
  if (info) *info = (hk_solve_info){0, left, info->tolerance};
  return HK_OK;
}

static void describe(const void *self, char *text, size_t size) {
  char library[64];
  (void)self;
  snprintf(library, sizeof library, "UMFPACK %d.%d.%d", UMFPACK_MAIN_VERSION, UMFPACK_SUB_VERSION,
           UMFPACK_SUBSUB_VERSION);
  hk_blas_describe(library, text, size);
}

static const hk_solver solver = {.size = sizeof(hk_solver),
                                 .flags = HK_SOLVES_UNSYMMETRIC | HK_SOLVES_INDEFINITE,
                                 .analyze = analyze,
                                 .factorize = factorize,
                                 .solve = solve,
                                 .describe = describe};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SOLVER,
    .name = "umfpack",
    .summary = "sparse LU, P R A Q = L U, for matrices that are unsymmetric or indefinite",
    .reference = "Davis 2004, ACM TOMS 30, algorithm 832; Direct methods, chapter 6",
    .instance_size = sizeof(lu),
    .create = create,
    .destroy = destroy,
    .solver = &solver,
};
