/* See cholesky.h. Only the upper triangle is read, so of a matrix that is symmetric up to rounding one half is used.
 * CHOLMOD uses the simplicial method for small fill and the supernodal one with the BLAS for large fill, by its count
 * of operations. Invariant: between calls `A` has the pattern of the last analysis, `ready` says that L has its
 * numbers. */
#include "plugins/common/cholesky/cholesky.h"
#include "plugins/common/linear/blas.h"
#include "plugins/common/linear/blas_name.h"

#include <stdio.h>
#include <string.h>

static const double metis_pays = 1e9; /* operations of a factorization with AMD's order, above which METIS is tried */

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

/* Blocks up to the diagonal in block row r. */
static size_t upper_blocks(const hk_matrix *A, size_t r) {
  size_t e = A->row_start[r];
  while (e < A->row_start[r + 1] && A->column[e] <= r) e++;
  return e - A->row_start[r];
}

static size_t upper_count(const hk_matrix *A) {
  size_t b = A->block, count = 0;
  for (size_t r = 0; r < A->rows; r++) {
    size_t blocks = upper_blocks(A, r);
    bool diagonal = blocks && A->column[A->row_start[r] + blocks - 1] == r;
    count += blocks * b * b - (diagonal ? b * (b - 1) / 2 : 0);
  }
  return count;
}

/* Row 3r+k of A up to the diagonal is column 3r+k of its upper triangle. Without `start` only the values are copied. */
static void fill_upper(const hk_matrix *A, int64_t *start, int64_t *row, double *value) {
  size_t b = A->block, at = 0, column = 0;
  for (size_t r = 0; r < A->rows; r++) {
    size_t begin = A->row_start[r], end = begin + upper_blocks(A, r);
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

/* The graph of blocks is ordered, which keeps the unknowns of a particle together and is 9 times smaller. */
static cholmod_sparse *graph_of(hk_cholesky *s, const hk_matrix *A) {
  size_t n = A->rows, count = 0;
  for (size_t r = 0; r < n; r++) count += upper_blocks(A, r);
  cholmod_sparse *graph = cholmod_l_allocate_sparse(n, n, count, 1, 1, 1, CHOLMOD_PATTERN, &s->common);
  int64_t *start = graph ? graph->p : NULL;
  for (size_t r = 0; graph && r < n; r++) {
    start[r + 1] = start[r] + (int64_t)upper_blocks(A, r);
    for (int64_t e = 0; e < start[r + 1] - start[r]; e++)
      ((int64_t *)graph->i)[start[r] + e] = A->column[A->row_start[r] + (size_t)e];
  }
  return graph;
}

static cholmod_factor *order_by(hk_cholesky *s, cholmod_sparse *graph, int ordering, double *flops) {
  s->common.nmethods = 1;
  s->common.method[0].ordering = ordering;
  s->common.postorder = 1;
  cholmod_factor *L = cholmod_l_analyze(graph, &s->common);
  *flops = s->common.fl * pow((double)s->block, 3);
  return L;
}

/* METIS takes some ten times as long as AMD, so it is tried where the factorization takes at least as long as METIS;
 * the order with fewer operations is used. */
static cholmod_factor *order_graph(hk_cholesky *s, cholmod_sparse *graph) {
  double flops, other;
  if (s->ordering == HK_ORDER_METIS) return order_by(s, graph, CHOLMOD_METIS, &flops);
  cholmod_factor *L = order_by(s, graph, CHOLMOD_AMD, &flops);
  if (!L || s->ordering == HK_ORDER_AMD || flops < metis_pays) return L;
  cholmod_factor *second = order_by(s, graph, CHOLMOD_METIS, &other);
  if (second && other < flops) {
    cholmod_l_free_factor(&L, &s->common);
    return second;
  }
  cholmod_l_free_factor(&second, &s->common);
  return L;
}

/* The order of the matrix's rows from the order of its blocks; NULL: the ordering failed. */
static int64_t *order_rows(hk_cholesky *s, const hk_matrix *A) {
  size_t n = A->rows, b = A->block;
  cholmod_sparse *graph = graph_of(s, A);
  cholmod_factor *L = graph ? order_graph(s, graph) : NULL;
  int64_t *order = L ? s->host->allocate(s->host, (n * b + 1) * sizeof *order) : NULL;
  if (L && !order) s->common.status = CHOLMOD_OUT_OF_MEMORY;
  for (size_t k = 0; order && k < n * b; k++) order[k] = (int64_t)b * ((int64_t *)L->Perm)[k / b] + (int64_t)(k % b);
  cholmod_l_free_factor(&L, &s->common);
  cholmod_l_free_sparse(&graph, &s->common);
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
