/* Sparse Cholesky factorization A = P^T L L^T P of symmetric positive definite matrices, by CHOLMOD.
 *
 * `analyze` orders the graph of blocks and writes their upper triangle as one scalar compressed-column matrix, which is
 * kept; `factorize` updates its values and reuses the ordering and the structure of L; `solve` reuses its workspaces.
 * Only that triangle is read, so of a matrix that is symmetric up to rounding one half is used. CHOLMOD uses the
 * simplicial method for small fill and the supernodal one with the BLAS for large fill, by its count of operations. One
 * thread is the default: the order of sums in a threaded BLAS, and with it the last digit of results, depends on the
 * machine. Several right-hand sides are solved by plugins/common/linear/triangular.c, which copies L at the first such
 * solve of a factorization. Invariant: between calls `A` has the pattern of the last analysis, `ready` says that L has
 * its numbers, `copied` that `columns` has them too. Chen, Davis, Hager and Rajamanickam, Algorithm 887: CHOLMOD, ACM
 * TOMS 35 (2008). */
#include "plugins/common/linear/blas.h"
#include "plugins/common/linear/blas_name.h"
#include "plugins/common/linear/triangular.h"

#include <cholmod.h>
#include <stdio.h>
#include <string.h>

enum { ORDER_BEST, ORDER_AMD, ORDER_METIS };

static const double metis_pays = 1e9; /* operations of a factorization with AMD's order, above which METIS is tried */

typedef struct cholesky {
  int ordering;
  int64_t threads;
  const hk_host *host;
  cholmod_common common;
  bool started, ready, copied;
  size_t rows, block; /* sizes of the analysed matrix */
  cholmod_sparse *A;
  cholmod_factor *L;
  cholmod_dense *b, *x, *y, *e; /* right-hand side, solution and CHOLMOD's workspaces */
  hk_triangular *columns;       /* NULL until several right-hand sides are solved */
  int64_t *shape;               /* index arrays of the factor view of L */
} cholesky;

/* clang-format off */
static const hk_param params[] = {
    {"ordering", "",
     "fill-reducing ordering; best: AMD, or METIS where the factorization is long and METIS makes it shorter",
     HK_CHOICE, {ORDER_BEST}, 0, 0, offsetof(cholesky, ordering), 0, "best|amd|metis"},
    {"threads", "",
     "threads of CHOLMOD and of an OpenBLAS, for the whole process; more than 1 may change the last digit",
     HK_INTEGER, {1}, 1, 1024, offsetof(cholesky, threads), 0, NULL},
    {0},
};
/* clang-format on */

static void free_matrix(cholesky *s) {
  cholmod_l_free_factor(&s->L, &s->common);
  cholmod_l_free_sparse(&s->A, &s->common);
  cholmod_l_free_dense(&s->b, &s->common);
  cholmod_l_free_dense(&s->x, &s->common);
  cholmod_l_free_dense(&s->y, &s->common);
  cholmod_l_free_dense(&s->e, &s->common);
  hk_triangular_free(s->columns, s->host);
  s->host->release(s->host, s->shape);
  s->columns = NULL;
  s->shape = NULL;
  s->ready = s->copied = false;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  cholesky *s = self;
  (void)view;
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

static void destroy(void *self, const hk_host *host) {
  cholesky *s = self;
  (void)host;
  if (!s->started) return;
  free_matrix(s);
  cholmod_l_finish(&s->common);
}

static hk_status failed(cholesky *s, const char *what) {
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
static cholmod_sparse *graph_of(cholesky *s, const hk_matrix *A) {
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

static cholmod_factor *order_by(cholesky *s, cholmod_sparse *graph, int ordering, double *flops) {
  s->common.nmethods = 1;
  s->common.method[0].ordering = ordering;
  s->common.postorder = 1;
  cholmod_factor *L = cholmod_l_analyze(graph, &s->common);
  *flops = s->common.fl * pow((double)s->block, 3);
  return L;
}

/* METIS takes some ten times as long as AMD, so it is tried where the factorization takes at least as long as METIS;
 * the order with fewer operations is used. */
static cholmod_factor *order_graph(cholesky *s, cholmod_sparse *graph) {
  double flops, other;
  if (s->ordering == ORDER_METIS) return order_by(s, graph, CHOLMOD_METIS, &flops);
  cholmod_factor *L = order_by(s, graph, CHOLMOD_AMD, &flops);
  if (!L || s->ordering == ORDER_AMD || flops < metis_pays) return L;
  cholmod_factor *second = order_by(s, graph, CHOLMOD_METIS, &other);
  if (second && other < flops) {
    cholmod_l_free_factor(&L, &s->common);
    return second;
  }
  cholmod_l_free_factor(&second, &s->common);
  return L;
}

/* The order of the matrix's rows from the order of its blocks; NULL: the ordering failed. */
static int64_t *order_rows(cholesky *s, const hk_matrix *A) {
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

static hk_status analyze(void *self, const hk_matrix *A) {
  cholesky *s = self;
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
  return s->L ? HK_OK : failed(s, "analyse");
}

static hk_status not_definite(cholesky *s) {
  size_t minor = s->L->minor, column = minor < s->L->n && s->L->Perm ? (size_t)((int64_t *)s->L->Perm)[minor] : minor;
  if (s->block != 3)
    return s->host->fail(s->host, HK_NOT_CONVERGED, "the matrix is not positive definite, seen at row %zu", column + 1);
  return s->host->fail(s->host, HK_NOT_CONVERGED,
                       "the matrix is not positive definite, seen at the %zuth particle's %c: the step is too long for "
                       "a force that pushes apart",
                       column / 3 + 1, "xyz"[column % 3]);
}

static hk_status factorize(void *self, const hk_matrix *A) {
  cholesky *s = self;
  if (!s->L || A->rows != s->rows || A->block != s->block)
    return s->host->fail(s->host, HK_FAILED, "the pattern of the matrix was not analysed");
  s->ready = s->copied = false;
  fill_upper(A, NULL, NULL, s->A->x);
  hk_blas_threads((int)s->threads);
  int fine = cholmod_l_factorize(s->A, s->L, &s->common);
  if (s->common.status == CHOLMOD_NOT_POSDEF || (fine && s->L->minor < s->L->n)) return not_definite(s);
  if (!fine) return failed(s, "factorize");
  s->ready = true;
  return HK_OK;
}

/* |b - A x| / |b|, from the upper triangle. b is overwritten. */
static double residual(const cholesky *s, double *b, const double *x) {
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

static hk_status solve(void *self, const double *b, double *x, hk_solve_info *info) {
  cholesky *s = self;
  size_t bytes = s->rows * s->block * sizeof *x;
  if (!s->ready) return s->host->fail(s->host, HK_FAILED, "there is no factorization to solve with");
  memcpy(s->b->x, b, bytes);
  if (!cholmod_l_solve2(CHOLMOD_A, s->L, s->b, NULL, &s->x, NULL, &s->y, &s->e, &s->common)) return failed(s, "solve");
  memcpy(x, s->x->x, bytes);
  double left = residual(s, s->b->x, x);
  if (!isfinite(left)) return s->host->fail(s->host, HK_NOT_FINITE, "the solution of a linear system is not finite");
  if (info) info->iterations = 0, info->residual = left;
  return HK_OK;
}

/* ---- Several right-hand sides ---- */

static void supernodes_of(const cholmod_factor *L, hk_factor_view *f, int64_t *first, int64_t *list, int64_t *rows,
                          int64_t *column) {
  const int64_t *super = L->super, *index = L->pi, *value = L->px;
  f->supernodes = L->nsuper;
  f->row = L->s;
  for (size_t k = 0; k < L->nsuper; k++) {
    first[k] = super[k];
    list[k] = index[k];
    rows[k] = index[k + 1] - index[k];
    for (int64_t c = super[k]; c < super[k + 1]; c++) column[c] = value[k] + (c - super[k]) * rows[k];
  }
  first[f->supernodes] = (int64_t)L->n;
}

/* Finds the supernodes of L: a column joins the one before when it has the same rows except for that column's
 * diagonal. */
static void columns_of(const cholmod_factor *L, hk_factor_view *f, int64_t *first, int64_t *list, int64_t *rows,
                       int64_t *column) {
  const int64_t *start = L->p, *count = L->nz, *row = L->i;
  f->supernodes = 0;
  f->row = row;
  for (size_t j = 0; j < L->n; j++) {
    bool joins = j > 0 && count[j - 1] == count[j] + 1 && row[start[j - 1] + 1] == (int64_t)j;
    if (!joins) {
      first[f->supernodes] = (int64_t)j;
      list[f->supernodes] = start[j];
      rows[f->supernodes++] = count[j];
    }
    column[j] = start[j] - ((int64_t)j - first[f->supernodes - 1]);
  }
  first[f->supernodes] = (int64_t)L->n;
}

static hk_status copy_factor(cholesky *s) {
  size_t n = s->L->n;
  if (!s->shape) s->shape = s->host->allocate(s->host, (4 * n + 1) * sizeof *s->shape);
  if (s->shape) {
    int64_t *first = s->shape, *list = first + n + 1, *rows = list + n, *column = rows + n;
    hk_factor_view f = {.n = n, .first = first, .list = list, .rows = rows, .column = column};
    f.value = s->L->x;
    f.order = s->L->Perm;
    (s->L->is_super ? supernodes_of : columns_of)(s->L, &f, first, list, rows, column);
    if (!s->columns) s->columns = hk_triangular_create(s->host, &f);
    if (s->columns) hk_triangular_fill(s->columns, &f);
  }
  s->copied = s->columns != NULL;
  return s->copied ? HK_OK : s->host->fail(s->host, HK_NO_MEMORY, "no memory to copy a factor of %zu rows", n);
}

static hk_status solve_columns(void *self, const double *b, double *x, size_t columns) {
  cholesky *s = self;
  if (!s->ready) return s->host->fail(s->host, HK_FAILED, "there is no factorization to solve with");
  hk_status status = s->copied ? HK_OK : copy_factor(s);
  if (status != HK_OK) return status;
  hk_triangular_solve(s->columns, b, x, columns);
  double bad = 0;
  for (size_t k = 0; k < columns * s->L->n; k++) bad += x[k] * 0;
  if (bad != 0) return s->host->fail(s->host, HK_NOT_FINITE, "the solution of a linear system is not finite");
  return HK_OK;
}

static void describe(const void *self, char *text, size_t size) {
  char library[64];
  int version[3];
  (void)self;
  cholmod_l_version(version);
  snprintf(library, sizeof library, "CHOLMOD %d.%d.%d", version[0], version[1], version[2]);
  hk_blas_describe(library, text, size);
}

static const hk_solver solver = {.size = sizeof(hk_solver),
                                 .flags = 0,
                                 .analyze = analyze,
                                 .factorize = factorize,
                                 .solve = solve,
                                 .solve_columns = solve_columns,
                                 .describe = describe};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SOLVER,
    .name = "cholmod",
    .summary = "sparse Cholesky, A = P^T L L^T P, for symmetric positive definite matrices",
    .reference =
        "Chen, Davis, Hager and Rajamanickam 2008, ACM TOMS 35, algorithm 887; Davis, Direct methods, chapter 4",
    .instance_size = sizeof(cholesky),
    .params = params,
    .create = create,
    .destroy = destroy,
    .solver = &solver,
};
