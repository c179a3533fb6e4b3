/* See cholesky.h. Only the upper triangle is read, so of a matrix that is symmetric up to rounding one half is used.
 * CHOLMOD uses the simplicial method for small fill and the supernodal one with the BLAS for large fill, by its count
 * of operations. Invariant: between calls `A` has the pattern of the last analysis, `ready` says that L has its
 * numbers. */
#include "plugins/common/cholesky/cholesky.h"
#include "plugins/common/linear/blas.h"
#include "plugins/common/linear/blas_name.h"

#include <stdio.h>
#include <string.h>

static void free_matrix(hk_cholesky *s) {
  cholmod_l_free_factor(&s->L, &s->common);
  cholmod_l_free_sparse(&s->A, &s->common);
  cholmod_l_free_dense(&s->b, &s->common);
  cholmod_l_free_dense(&s->x, &s->common);
  cholmod_l_free_dense(&s->y, &s->common);
  cholmod_l_free_dense(&s->e, &s->common);
  s->ready = false;
}

hk_status hk_cholesky_open(hk_cholesky *s, const hk_host *host) {
  s->host = host;
  hk_blas_stay_loaded();
  hk_blas_warn(host, "CHOLMOD");
  if (!cholmod_l_start(&s->common)) return host->fail(host, HK_FAILED, "CHOLMOD does not start");
  s->started = true;
  s->common.print = 0;
  s->common.error_handler = NULL;
  s->common.final_ll = 1; /* L D L^T would accept an indefinite matrix */
  s->common.quick_return_if_not_posdef = 1;
  return HK_OK;
}

void hk_cholesky_close(hk_cholesky *s) {
  if (!s->started) return;
  free_matrix(s);
  cholmod_l_finish(&s->common);
  s->started = false;
}

static hk_status failed(hk_cholesky *s, const char *what) {
  int status = s->common.status;
  if (status == CHOLMOD_OUT_OF_MEMORY)
    return s->host->fail(s->host, HK_NO_MEMORY, "no memory to %s a matrix of %zu rows", what, s->rows * s->block);
  return s->host->fail(s->host, HK_FAILED, "cannot %s a matrix of %zu rows: %s (CHOLMOD status %d)", what,
                       s->rows * s->block, status == CHOLMOD_TOO_LARGE ? "it is too large" : "invalid input", status);
}

static size_t upper_count(const hk_matrix *A) {
  size_t b = A->block, count = 0;
  for (size_t r = 0; r < A->rows; r++) {
    size_t blocks = hk_upper_blocks(A, r);
    bool diagonal = blocks && A->column[A->row_start[r] + blocks - 1] == r;
    count += blocks * b * b - (diagonal ? b * (b - 1) / 2 : 0);
  }
  return count;
}

/* Row 3r+k of A up to the diagonal is column 3r+k of its upper triangle. Without `start` only the values are copied. */
static void fill_upper(const hk_matrix *A, int64_t *start, int64_t *row, double *value) {
  size_t b = A->block, at = 0, column = 0;
  for (size_t r = 0; r < A->rows; r++) {
    size_t begin = A->row_start[r], end = begin + hk_upper_blocks(A, r);
    for (size_t k = 0; k < b; k++, column++) {
      if (start) start[column] = (int64_t)at;
      for (size_t e = begin; e < end; e++) {
        size_t last = A->column[e] == r ? k + 1 : b;
        for (size_t j = 0; j < last; j++, at++) {
          if (row) row[at] = (int64_t)(b * A->column[e] + j);
          value[at] = A->value[b * b * e + b * k + j];
        }
      }
    }
  }
  if (start) start[column] = (int64_t)at;
}

/* The order of the matrix's rows from the order of its blocks; NULL: the ordering failed. */
static int64_t *order_rows(hk_cholesky *s, const hk_matrix *A) {
  size_t n = A->rows, b = A->block;
  cholmod_factor *L = hk_block_order(&s->common, A, s->ordering);
  int64_t *order = L ? s->host->allocate(s->host, (n * b + 1) * sizeof *order) : NULL;
  if (L && !order) s->common.status = CHOLMOD_OUT_OF_MEMORY;
  for (size_t k = 0; order && k < n * b; k++) order[k] = (int64_t)b * ((int64_t *)L->Perm)[k / b] + (int64_t)(k % b);
  cholmod_l_free_factor(&L, &s->common);
  return order;
}

hk_status hk_cholesky_analyze(hk_cholesky *s, const hk_matrix *A) {
  size_t n = A->rows * A->block;
  free_matrix(s);
  s->rows = A->rows;
  s->block = A->block;
  s->A = cholmod_l_allocate_sparse(n, n, upper_count(A), 1, 1, 1, CHOLMOD_REAL, &s->common);
  s->b = cholmod_l_allocate_dense(n, 1, n, CHOLMOD_REAL, &s->common);
  if (!s->A || !s->b) return failed(s, "store");
  fill_upper(A, s->A->p, s->A->i, s->A->x);
  int64_t *order = order_rows(s, A);
  if (!order) return failed(s, "order");
  s->common.nmethods = 1;
  s->common.method[0].ordering = CHOLMOD_GIVEN;
  s->L = cholmod_l_analyze_p(s->A, (void *)order, NULL, 0, &s->common);
  s->host->release(s->host, order);
  s->flops = s->common.fl;
  s->entries = s->common.lnz;
  return s->L ? HK_OK : failed(s, "analyse");
}

static hk_status not_definite(hk_cholesky *s) {
  size_t minor = s->L->minor, column = minor < s->L->n && s->L->Perm ? (size_t)((int64_t *)s->L->Perm)[minor] : minor;
  if (s->block != 3)
    return s->host->fail(s->host, HK_NOT_CONVERGED, "the matrix is not positive definite, seen at row %zu", column + 1);
  return s->host->fail(s->host, HK_NOT_CONVERGED,
                       "the matrix is not positive definite, seen at the %zuth particle's %c: the step is too long for "
                       "a force that pushes apart",
                       column / 3 + 1, "xyz"[column % 3]);
}

hk_status hk_cholesky_take(hk_cholesky *s, const hk_matrix *A) {
  if (!s->L || A->rows != s->rows || A->block != s->block)
    return s->host->fail(s->host, HK_FAILED, "the pattern of the matrix was not analysed");
  fill_upper(A, NULL, NULL, s->A->x);
  return HK_OK;
}

hk_status hk_cholesky_factorize(hk_cholesky *s, double shift) {
  double beta[2] = {shift, 0};
  s->ready = false;
  hk_blas_threads(s->threads);
  int fine = cholmod_l_factorize_p(s->A, beta, NULL, 0, s->L, &s->common);
  if (s->common.status == CHOLMOD_NOT_POSDEF || (fine && s->L->minor < s->L->n)) return not_definite(s);
  if (!fine) return failed(s, "factorize");
  s->ready = true;
  return HK_OK;
}

double hk_cholesky_residual(const hk_cholesky *s, double *b, const double *x) {
  const int64_t *start = s->A->p, *row = s->A->i;
  const double *value = s->A->x;
  double left = 0, whole = 0;
  for (size_t j = 0; j < s->A->ncol; j++) whole += b[j] * b[j];
  for (size_t j = 0; j < s->A->ncol; j++) {
    double sum = 0;
    for (int64_t e = start[j]; e < start[j + 1]; e++) {
      size_t i = (size_t)row[e];
      sum += value[e] * x[i];
      if (i != j) b[i] -= value[e] * x[j];
    }
    b[j] -= sum;
  }
  for (size_t j = 0; j < s->A->ncol; j++) left += b[j] * b[j];
  return whole > 0 ? sqrt(left / whole) : 0;
}

hk_status hk_cholesky_solve(hk_cholesky *s, const double *b, double *x) {
  size_t bytes = s->rows * s->block * sizeof *x;
  if (!s->ready) return s->host->fail(s->host, HK_FAILED, "there is no factorization to solve with");
  memcpy(s->b->x, b, bytes);
  if (!cholmod_l_solve2(CHOLMOD_A, s->L, s->b, NULL, &s->x, NULL, &s->y, &s->e, &s->common)) return failed(s, "solve");
  memcpy(x, s->x->x, bytes);
  return HK_OK;
}

void hk_cholesky_describe(char *text, size_t size) {
  char library[64];
  int version[3];
  cholmod_l_version(version);
  snprintf(library, sizeof library, "CHOLMOD %d.%d.%d", version[0], version[1], version[2]);
  hk_blas_describe(library, text, size);
}
