/* Sparse Cholesky factorization A = P^T L L^T P of symmetric positive definite matrices, by CHOLMOD.
 *
 * The factor is that of plugins/common/cholesky. One thread is the default: the order of sums in a threaded BLAS, and
 * with it the last digit of results, depends on the machine. Several right-hand sides are solved by
 * plugins/common/linear/triangular.c, which copies L at the first such solve of a factorization. Invariant: between
 * calls `copied` says that `columns` has the numbers of the factor. Chen, Davis, Hager and Rajamanickam, Algorithm 887:
 * CHOLMOD, ACM TOMS 35 (2008).
 *
 * For patterns of which nothing is known, and as the yardstick: `supernodal`, for blocks of three, takes 0.64 s where
 * this takes 0.98 (32 x 32 particles, 1e6 N/m, 24 steps of bdf2), `banded` a fourteenth on hair.
 */
#include "plugins/common/cholesky/cholesky.h"
#include "plugins/common/linear/triangular.h"

typedef struct cholesky {
  hk_cholesky factor;
  int ordering;
  int64_t threads;
  const hk_host *host;
  bool copied;
  hk_triangular *columns; /* NULL until several right-hand sides are solved */
  int64_t *shape;         /* index arrays of the factor view of L */
} cholesky;

static const hk_param params[] = {
    {"ordering", "",
     "fill-reducing ordering; best: AMD, or METIS where the factorization is long and METIS makes it shorter",
     .choice = HK_AT(cholesky, ordering), .initial = {HK_ORDER_BEST}, .choices = "best|amd|metis"},
    {"threads", "",
     "threads of CHOLMOD and of an OpenBLAS, for the whole process; more than 1 may change the last digit",
     .integer = HK_AT(cholesky, threads), .initial = {1}, .limits = HK_WITHIN(1, 1024)},
    {0},
};

static void free_columns(cholesky *s) {
  hk_triangular_free(s->columns, s->host);
  s->host->release(s->host, s->shape);
  s->columns = NULL;
  s->shape = NULL;
  s->copied = false;
}

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  cholesky *s = self;
  (void)view;
  s->host = host;
  s->factor.ordering = s->ordering;
  s->factor.threads = (int)s->threads;
  return hk_cholesky_open(&s->factor, host);
}

static void destroy(void *self, const hk_host *host) {
  cholesky *s = self;
  (void)host;
  if (!s->factor.started) return;
  free_columns(s);
  hk_cholesky_close(&s->factor);
}

static hk_status analyze(void *self, const hk_matrix *A) {
  cholesky *s = self;
  free_columns(s);
  return hk_cholesky_analyze(&s->factor, A);
}

static hk_status factorize(void *self, const hk_matrix *A) {
  cholesky *s = self;
  s->copied = false;
  hk_status status = hk_cholesky_take(&s->factor, A);
  return status == HK_OK ? hk_cholesky_factorize(&s->factor, 0) : status;
}

static hk_status solve(void *self, const double *b, double *x, hk_solve_info *info) {
  cholesky *s = self;
  hk_status status = hk_cholesky_solve(&s->factor, b, x);
  if (status != HK_OK) return status;
  double left = hk_cholesky_residual(&s->factor, s->factor.b->x, x);
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
  const cholmod_factor *L = s->factor.L;
  size_t n = L->n;
  if (!s->shape) s->shape = s->host->allocate(s->host, (4 * n + 1) * sizeof *s->shape);
  if (s->shape) {
    int64_t *first = s->shape, *list = first + n + 1, *rows = list + n, *column = rows + n;
    hk_factor_view f = {.n = n, .first = first, .list = list, .rows = rows, .column = column};
    f.value = L->x;
    f.order = L->Perm;
    (L->is_super ? supernodes_of : columns_of)(L, &f, first, list, rows, column);
    if (!s->columns) s->columns = hk_triangular_create(s->host, &f);
    if (s->columns) hk_triangular_fill(s->columns, &f);
  }
  s->copied = s->columns != NULL;
  return s->copied ? HK_OK : s->host->fail(s->host, HK_NO_MEMORY, "no memory to copy a factor of %zu rows", n);
}

static hk_status solve_columns(void *self, const double *b, double *x, size_t columns) {
  cholesky *s = self;
  if (!s->factor.ready) return s->host->fail(s->host, HK_FAILED, "there is no factorization to solve with");
  hk_status status = s->copied ? HK_OK : copy_factor(s);
  if (status != HK_OK) return status;
  hk_triangular_solve(s->columns, b, x, columns);
  double bad = 0;
  for (size_t k = 0; k < columns * s->factor.L->n; k++) bad += x[k] * 0;
  if (bad != 0) return s->host->fail(s->host, HK_NOT_FINITE, "the solution of a linear system is not finite");
  return HK_OK;
}

static void describe(const void *self, char *text, size_t size) {
  (void)self;
  hk_cholesky_describe(text, size);
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
