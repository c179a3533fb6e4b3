/* The solver plugin cholmod against CHOLMOD called directly on the same matrices, with every ordering and one or two
 * BLAS threads, on the implicit matrix M + h D + h^2 K of a stiff cloth (k = 1e5 N/m, h = 1/60 s); and what assembly
 * takes of a Newton iteration. To reach: factorize at most 1.1 of CHOLMOD's best, assembly at most 15 %. Then three
 * right-hand sides on the n x n matrix of local_global, against cholmod_solve2. */
#include "tests/bench/cloth.h"

#include <cholmod.h>
#include <string.h>

enum { REPEATS = 11, RIVALS = 8 };

extern void openblas_set_num_threads(int threads) __attribute__((weak)); /* NULL with another BLAS */

typedef struct rival {
  const char *name;
  int ordering, threads;
  cholmod_factor *L;
  double flops; /* of a factorization */
  double factor[REPEATS], solve[REPEATS];
} rival;

static const rival rivals[RIVALS] = {
    {.name = "AMD, 1 thread", .ordering = CHOLMOD_AMD, .threads = 1},
    {.name = "METIS, 1 thread", .ordering = CHOLMOD_METIS, .threads = 1},
    {.name = "NESDIS, 1 thread", .ordering = CHOLMOD_NESDIS, .threads = 1},
    {.name = "default, 1 thread", .ordering = -1, .threads = 1},
    {.name = "AMD, 2 threads", .ordering = CHOLMOD_AMD, .threads = 2},
    {.name = "METIS, 2 threads", .ordering = CHOLMOD_METIS, .threads = 2},
    {.name = "NESDIS, 2 threads", .ordering = CHOLMOD_NESDIS, .threads = 2},
    {.name = "default, 2 threads", .ordering = -1, .threads = 2},
};

/* The upper triangle, column by column, in scalars. */
static cholmod_sparse *upper(const hk_matrix *A, cholmod_common *common) {
  size_t b = A->block, n = A->rows * b, most = A->row_start[A->rows] * b * b, at = 0;
  cholmod_sparse *U = cholmod_l_allocate_sparse(n, n, most, 1, 1, 1, CHOLMOD_REAL, common);
  int64_t *start = U->p, *row = U->i;
  double *value = U->x;
  for (size_t column = 0; column < n; column++) {
    start[column] = (int64_t)at;
    for (size_t e = A->row_start[column / b]; e < A->row_start[column / b + 1]; e++)
      for (size_t j = 0; j < b; j++) {
        if (b * A->column[e] + j > column) continue;
        row[at] = (int64_t)(b * A->column[e] + j);
        value[at++] = A->value[b * b * e + b * (column % b) + j];
      }
  }
  start[n] = (int64_t)at;
  return U;
}

/* s; of one thread its own time, which others on the machine disturb less, of two the wall's. */
static double clock_of(int threads) {
  struct timespec t;
  clock_gettime(threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void set_threads(int threads) {
  if (openblas_set_num_threads) openblas_set_num_threads(threads);
}

static void analyze(rival *r, cholmod_sparse *A, cholmod_common *common) {
  common->final_ll = 1;
  common->postorder = 1;
  common->supernodal = CHOLMOD_AUTO;
  common->nmethods = r->ordering < 0 ? 0 : 1;
  common->method[0].ordering = r->ordering < 0 ? CHOLMOD_GIVEN : r->ordering;
  r->L = cholmod_l_analyze(A, common);
  r->flops = common->fl;
}

/* Numeric factorization and the solution of `columns` right-hand sides. */
static void direct(rival *r, cholmod_sparse *A, size_t columns, cholmod_common *common, int repeat) {
  cholmod_dense *b = cholmod_l_ones(A->nrow, columns, CHOLMOD_REAL, common), *x = NULL, *y = NULL, *e = NULL;
  set_threads(r->threads);
  double t0 = clock_of(r->threads);
  cholmod_l_factorize(A, r->L, common);
  double t1 = clock_of(r->threads);
  cholmod_l_solve2(CHOLMOD_A, r->L, b, NULL, &x, NULL, &y, &e, common);
  double t2 = clock_of(r->threads);
  cholmod_l_solve2(CHOLMOD_A, r->L, b, NULL, &x, NULL, &y, &e, common); /* workspaces are there now */
  r->factor[repeat] = t1 - t0;
  r->solve[repeat] = clock_of(r->threads) - t2;
  cholmod_l_free_dense(&b, common);
  cholmod_l_free_dense(&x, common);
  cholmod_l_free_dense(&y, common);
  cholmod_l_free_dense(&e, common);
}

static void must(test_engine *e, hk_status status) {
  if (status == HK_OK) return;
  printf("%s\n", e->run->error.text);
  exit(1);
}

typedef struct timing {
  double assembly[REPEATS], factor[REPEATS], solve[REPEATS];
} timing;

/* Assembly, factorization and one solution through the system, as an integrator has them. */
static void plugin(test_engine *e, double *X, const double *b, double *x, hk_matrix *A, timing *t, int repeat) {
  hk_system *s = &e->run->dynamics.system;
  hk_matrix K, D;
  double h = 1.0 / 60, t0 = clock_of(1);
  must(e, s->jacobian(s, 0, X, HK_WANT_SYMMETRIC, &K, &D));
  must(e, s->combine(s, 1, h, h * h, A));
  double t1 = clock_of(1);
  must(e, s->factorize(s, A));
  double t2 = clock_of(1);
  must(e, s->solve(s, b, x, NULL));
  double t3 = clock_of(1);
  must(e, s->solve(s, b, x, NULL)); /* as the rivals' second */
  t->assembly[repeat] = t1 - t0;
  t->factor[repeat] = t2 - t1;
  t->solve[repeat] = clock_of(1) - t3;
}

/* What is least disturbed by others on the machine. */
static double least(const double *list) {
  double best = INFINITY;
  for (int r = 0; r < REPEATS; r++) best = fmin(best, list[r]);
  return best;
}

/* Returns the best rival's factorization, s. */
static double report(rival *list, cholmod_common *common) {
  double best = INFINITY;
  for (int k = 0; k < RIVALS; k++) {
    double factor = least(list[k].factor);
    best = fmin(best, factor);
    printf("  %-19s factor %7.2f ms, solve %6.3f ms, %.3g Gflop\n", list[k].name, factor * 1e3,
           least(list[k].solve) * 1e3, list[k].flops * 1e-9);
    cholmod_l_free_factor(&list[k].L, common);
  }
  return best;
}

static void newton(uint32_t N) {
  test_engine e;
  timing t;
  rival list[RIVALS];
  cholmod_common common;
  hk_matrix A;
  open_cloth(&e, N, 1e5);
  test_run(&e);
  hk_system *s = &e.run->dynamics.system;
  size_t n = 3 * s->n;
  double *X = malloc(s->size * sizeof *X), *b = malloc(2 * n * sizeof *b);
  for (size_t k = 0; k < s->size; k++) X[k] = 1.02 * s->X[k]; /* stretched: the matrix is definite */
  for (size_t k = 0; k < n; k++) b[k] = 1;
  s->filter(s, b);
  cholmod_l_start(&common);
  memcpy(list, rivals, sizeof list);
  plugin(&e, X, b, b + n, &A, &t, 0);
  cholmod_sparse *U = upper(&A, &common);
  for (int k = 0; k < RIVALS; k++) analyze(&list[k], U, &common);
  for (int r = 0; r < REPEATS; r++) {
    plugin(&e, X, b, b + n, &A, &t, r);
    for (int k = 0; k < RIVALS; k++) direct(&list[k], U, 1, &common, r);
  }
  printf("%u x %u, implicit matrix, %zu unknowns\n", N, N, n);
  double best = report(list, &common), assembly = least(t.assembly), factor = least(t.factor), solve = least(t.solve);
  printf("  plugin              factor %7.2f ms: %.2f of the best; solve %.3f ms\n", factor * 1e3, factor / best,
         solve * 1e3);
  printf("  assembly %.2f ms: %.1f %% of a Newton iteration\n", assembly * 1e3,
         100 * assembly / (assembly + factor + solve));
  cholmod_l_free_sparse(&U, &common);
  cholmod_l_finish(&common);
  free(X);
  free(b);
  test_engine_close(&e);
}

/* The matrix of local_global is what it gives to the system's `factorize`. */
static hk_status (*factorize)(hk_system *, const hk_matrix *);
static hk_matrix seen;

static hk_status look(hk_system *s, const hk_matrix *A) {
  seen = *A;
  return factorize(s, A);
}

static void columns(uint32_t N) {
  test_engine e;
  rival list[RIVALS];
  cholmod_common common;
  double plugin_solve[REPEATS];
  open_cloth(&e, N, 1e4);
  test_plugin(&e, HK_INTEGRATOR, "local_global");
  e.scene->fps = 30;
  e.options.dt = 1.0 / 30;
  test_run(&e);
  hk_system *s = &e.run->dynamics.system;
  factorize = s->factorize;
  s->factorize = look;
  test_advance(&e, 1.0 / 30);
  double *b = malloc(6 * s->n * sizeof *b);
  for (size_t k = 0; k < 3 * s->n; k++) b[k] = 1;
  cholmod_l_start(&common);
  memcpy(list, rivals, sizeof list);
  cholmod_sparse *U = upper(&seen, &common);
  for (int k = 0; k < RIVALS; k++) analyze(&list[k], U, &common);
  for (int r = 0; r < REPEATS; r++) {
    for (int k = 0; k < RIVALS; k++) direct(&list[k], U, 3, &common, r);
    must(&e, s->solve_columns(s, b, b + 3 * s->n, 3)); /* what the others pushed out of the cache comes back */
    double t0 = clock_of(1);
    must(&e, s->solve_columns(s, b, b + 3 * s->n, 3));
    plugin_solve[r] = clock_of(1) - t0;
  }
  printf("%u x %u, n x n matrix, three right-hand sides\n", N, N);
  double best = INFINITY, mine = least(plugin_solve);
  for (int k = 0; k < RIVALS; k++) best = fmin(best, least(list[k].solve));
  report(list, &common);
  printf("  plugin              solve %.3f ms: %.2f of CHOLMOD's best\n", mine * 1e3, mine / best);
  cholmod_l_free_sparse(&U, &common);
  cholmod_l_finish(&common);
  free(b);
  test_engine_close(&e);
}

int main(void) {
  newton(64);
  newton(128);
  columns(81);
  columns(128);
  return 0;
}
