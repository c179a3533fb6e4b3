/* The solver supernodal beside CHOLMOD called directly, on the matrix of an implicit step of a cloth of 64 to 256
 * squared (M + h^2 K, k = 1e5 N/m, h = 1/60 s), on one thread: factorizations and solutions in turn, the least of
 * each; CHOLMOD with its orders by AMD, METIS and NESDIS, through the BLAS that is named. To reach: never slower
 * than the best of CHOLMOD's. The last column is the rate that dgemm of that BLAS has at 512 x 512.
 * usage: cholmod [SIDE ...] */
#define _GNU_SOURCE /* dlsym */
#include "plugins/common/linear/blas.h"
#include "plugins/common/linear/blas_name.h"
#include "tests/bench/cloth_matrix.h"
#include "tests/support/solver_matrix.h"

#include <cholmod.h>
#include <dlfcn.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

enum { ORDERS = 3, GEMM = 512 };

static const struct {
  const char *name;
  int ordering;
} orders[ORDERS] = {{"AMD", CHOLMOD_AMD}, {"METIS", CHOLMOD_METIS}, {"NESDIS", CHOLMOD_NESDIS}};

typedef void gemm(const char *, const char *, const int *, const int *, const int *, const double *, const double *,
                  const int *, const double *, const int *, const double *, double *, const int *);

/* Of this thread: others on the machine disturb it less than the wall's. */
static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

typedef struct times {
  double analyze, factorize, solve; /* s */
} times;

static void keep_least(double *least, double value) {
  if (value < *least) *least = value;
}

/* ---- CHOLMOD ---- */

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

typedef struct rival {
  cholmod_factor *L;
  double flops; /* of a factorization */
  times best;
} rival;

static void analyze(rival *r, int ordering, cholmod_sparse *A, cholmod_common *common) {
  common->supernodal = CHOLMOD_SUPERNODAL;
  common->nmethods = 1;
  common->method[0].ordering = ordering;
  double t0 = now();
  r->L = cholmod_l_analyze(A, common);
  r->best = (times){now() - t0, INFINITY, INFINITY};
  r->flops = common->fl;
}

static void direct(rival *r, cholmod_sparse *A, cholmod_common *common) {
  cholmod_dense *b = cholmod_l_ones(A->nrow, 1, CHOLMOD_REAL, common), *x = NULL, *y = NULL, *e = NULL;
  double t0 = now();
  cholmod_l_factorize(A, r->L, common);
  double t1 = now();
  cholmod_l_solve2(CHOLMOD_A, r->L, b, NULL, &x, NULL, &y, &e, common);
  double t2 = now();
  cholmod_l_solve2(CHOLMOD_A, r->L, b, NULL, &x, NULL, &y, &e, common); /* workspaces are there now */
  keep_least(&r->best.factorize, t1 - t0);
  keep_least(&r->best.solve, now() - t2);
  cholmod_l_free_dense(&b, common);
  cholmod_l_free_dense(&x, common);
  cholmod_l_free_dense(&y, common);
  cholmod_l_free_dense(&e, common);
}

/* ---- the plugin ---- */

static void must(test_solver *s, hk_status status) {
  if (status == HK_OK) return;
  printf("%s\n", s->e.error.text);
  exit(1);
}

static void plugin(test_solver *s, const double *b, double *x, times *best) {
  double t0 = now();
  must(s, test_solver_factorize(s));
  double t1 = now();
  must(s, test_solver_solve(s, b, x, NULL));
  double t2 = now();
  must(s, test_solver_solve(s, b, x, NULL)); /* as the rivals' second */
  keep_least(&best->factorize, t1 - t0);
  keep_least(&best->solve, now() - t2);
}

static void print(const char *name, const times *t, double flops) {
  printf("  %-20s analysis %8.1f ms, factor %8.2f ms, solve %7.2f ms, %6.3g Gflop, %5.1f GFLOP/s\n", name,
         t->analyze * 1e3, t->factorize * 1e3, t->solve * 1e3, flops * 1e-9, 1e-9 * flops / t->factorize);
}

static void compare(uint32_t side) {
  cloth_matrix c;
  test_solver s;
  rival list[ORDERS];
  cholmod_common common;
  open_cloth_matrix(&c, side, 1e5, 1 / 60.0);
  test_solver_open(&s, "supernodal", 1);
  s.A = c.A;
  size_t n = 3 * c.A.rows;
  double *b = malloc(2 * n * sizeof *b), flops = INFINITY, fastest = INFINITY, t0 = now();
  for (size_t k = 0; k < n; k++) b[k] = noise(k);
  must(&s, test_solver_analyze(&s));
  times own = {now() - t0, INFINITY, INFINITY};
  cholmod_l_start(&common);
  cholmod_sparse *U = upper(&c.A, &common);
  for (int k = 0; k < ORDERS; k++) analyze(&list[k], orders[k].ordering, U, &common);
  for (int k = 0; k < ORDERS; k++) flops = fmin(flops, list[k].flops);
  for (double spent = 0; spent < fmax(6e9, 2.5 * flops); spent += fmax(flops, 2e8)) { /* memory is new to the first */
    plugin(&s, b, b + n, &own);
    for (int k = 0; k < ORDERS; k++) direct(&list[k], U, &common);
  }
  printf("%u x %u, %zu unknowns, residual %.1e\n", side, side, n, test_matrix_residual(&s.A, b, b + n));
  for (int k = 0; k < ORDERS; k++) {
    char name[32];
    snprintf(name, sizeof name, "CHOLMOD, %s", orders[k].name);
    print(name, &list[k].best, list[k].flops);
    fastest = fmin(fastest, list[k].best.factorize);
    cholmod_l_free_factor(&list[k].L, &common);
  }
  print("supernodal", &own, flops);
  printf("  supernodal takes %.2f of the fastest of CHOLMOD's (rate by the fewest operations)\n",
         own.factorize / fastest);
  cholmod_l_free_sparse(&U, &common);
  cholmod_l_finish(&common);
  free(b);
  s.A.value = NULL;
  test_solver_close(&s);
  close_cloth_matrix(&c);
}

static void name_blas(void) {
  static double A[GEMM * GEMM], B[GEMM * GEMM], C[GEMM * GEMM];
  const int n = GEMM;
  const double one = 1, zero = 0;
  hk_blas blas;
  double least = INFINITY;
  gemm *dgemm = NULL; /* of the BLAS that CHOLMOD is linked with */
  hk_blas_loaded(&blas);
  *(void **)&dgemm = dlsym(RTLD_DEFAULT, "dgemm_");
  for (size_t k = 0; k < GEMM * GEMM; k++) A[k] = B[k] = noise(k);
  for (int repeat = 0; repeat < 8 && dgemm; repeat++) {
    double t0 = now();
    dgemm("N", "T", &n, &n, &n, &one, A, &n, B, &n, &zero, C, &n);
    keep_least(&least, now() - t0);
  }
  printf("%s, dgemm of %d x %d: %.1f GFLOP/s; hooke takes vectors of %d doubles\n", blas.name, GEMM, GEMM,
         2e-9 * GEMM * GEMM * GEMM / least, hk_processor_lanes());
}

int main(int count, char **arguments) {
  static const uint32_t sides[] = {64, 128, 192, 256};
  hk_blas_threads(1);
  name_blas();
  for (int k = 1; k < count; k++) compare((uint32_t)strtoul(arguments[k], NULL, 10));
  for (size_t k = 0; k < sizeof sides / sizeof *sides && count < 2; k++) compare(sides[k]);
  return 0;
}
