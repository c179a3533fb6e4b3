/* The product with a symmetric block matrix beside streaming its numbers once, at 512 x 512; and both preconditioners
 * on the matrix of a stiff cloth of 128 x 128, M + h^2 K with k = 1e5 N/m and h = 1/60 s, curtain's masses and pins.
 * Times are medians of repeats taken in turn, so that both sides see the same machine. */
#include "core/engine/base/base.h"
#include "plugins/common/linear/block_product.h"
#include "plugins/common/linear/upper_matrix.h"
#include "tests/bench/cloth_matrix.h"
#include "tests/support/engine.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static int by_size(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

static double median(double *list, size_t count) {
  qsort(list, count, sizeof *list, by_size);
  return list[count / 2];
}

/* ---- the solver's host ---- */

typedef struct bench_solver {
  test_engine e;
  hk_shared shared;
  hk_instance *instance;
} bench_solver;

static hk_instance *open_solver(bench_solver *b, const char *preconditioner, int threads) {
  test_engine *e = &b->e;
  test_engine_open(e);
  b->shared = (hk_shared){
      .error = &e->error, .threads = hk_threads_create(threads), .allocations_left = -1, .lanes = hk_processor_lanes()};
  hk_plugin_spec *solver = test_plugin(e, HK_SOLVER, "pcg");
  hk_value value = {.kind = HK_VALUE_STRING, .text = preconditioner};
  const hk_param *param = hk_spec_param(solver, "preconditioner", &e->error);
  if (hk_spec_set(solver, param, &value, 0, &e->error) != HK_OK) exit(1);
  hk_instance *i = b->instance = hk_instance_create(solver, &b->shared, &e->error);
  if (!i || hk_instance_start(i, &(hk_view){.host = &i->host}, 1, &e->error) != HK_OK) exit(1);
  return i;
}

static void close_solver(bench_solver *b) {
  hk_instance_destroy(b->instance);
  hk_threads_destroy(b->shared.threads);
  test_engine_close(&b->e);
}

/* ---- the product ---- */

typedef double vector __attribute__((vector_size(32), aligned(8), may_alias));

typedef struct stream {
  const double *value;
  double *part;
} stream;

/* A sum as fast as vectors read. */
#if defined(__x86_64__) && !defined(__clang__)
__attribute__((target_clones("avx2", "default")))
#endif
static void
add_up(void *context, size_t begin, size_t end, size_t chunk) {
  const stream *s = context;
  vector a = {0}, b = {0}, c = {0}, d = {0};
  for (size_t k = begin; k + 16 <= end; k += 16) {
    a += *(const vector *)(s->value + k);
    b += *(const vector *)(s->value + k + 4);
    c += *(const vector *)(s->value + k + 8);
    d += *(const vector *)(s->value + k + 12);
  }
  a += b + c + d;
  s->part[chunk] = a[0] + a[1] + a[2] + a[3];
}

/* Symmetric blocks are packed, chunk by chunk. */
static double bytes_read(const hk_upper *m) {
  size_t bytes = 0;
  for (size_t k = 0; k < m->chunks; k++) {
    size_t end = (k + 1) * m->chunk < m->rows ? (k + 1) * m->chunk : m->rows;
    size_t slots =
        m->slot_start[(end + HK_UPPER_LANES - 1) / HK_UPPER_LANES] - m->slot_start[k * m->chunk / HK_UPPER_LANES];
    bytes += slots * HK_UPPER_LANES * sizeof(double) * (m->packed[k] ? 6 : 9);
  }
  return (double)bytes;
}

static void product(cloth_matrix *c, int threads) {
  enum { REPEATS = 41, GRAIN = 1 << 18 };
  double list[3][REPEATS];
  bench_solver opened;
  const hk_host *host = &open_solver(&opened, "block_jacobi", threads)->host;
  size_t n = 3 * c->A.rows, blocks = (c->A.row_start[c->A.rows] + c->A.rows) / 2;
  double *x = calloc(n, sizeof *x), *y = calloc(n, sizeof *y);
  for (size_t k = 0; k < n; k++) x[k] = noise(k);
  hk_upper m;
  if (hk_upper_analyze(&m, host, &c->A) != HK_OK) exit(1);
  hk_upper_fill(&m, host, &c->A);
  stream s = {m.value, calloc(9 * blocks / GRAIN + 1, sizeof *s.part)};
  for (int r = 0; r < REPEATS; r++) {
    double t0 = now();
    host->parallel_for(host, 9 * blocks, GRAIN, add_up, &s);
    double t1 = now();
    hk_upper_product(&m, host, x, y);
    double t2 = now();
    hk_block_product(host, &c->A, x, y);
    double t3 = now();
    list[0][r] = t1 - t0, list[1][r] = t2 - t1, list[2][r] = t3 - t2;
  }
  double once = median(list[0], REPEATS), upper = median(list[1], REPEATS), full = median(list[2], REPEATS);
  printf("%u x %u, %d thread%s: %.1f MB streamed in %.2f ms; upper triangle's product, which reads %.1f MB, %.2f ms: "
         "%.2fx; best of each %.2f and %.2f ms: %.2fx; full matrix's %.2f ms\n",
         c->side, c->side, threads, threads > 1 ? "s" : "", (double)(72 * blocks) * 1e-6, once * 1e3,
         bytes_read(&m) * 1e-6, upper * 1e3, upper / once, list[0][0] * 1e3, list[1][0] * 1e3, list[1][0] / list[0][0],
         full * 1e3);
  hk_upper_free(&m, host);
  free(s.part);
  free(x);
  free(y);
  close_solver(&opened);
}

/* ---- the solver ---- */

static void solve(cloth_matrix *c, const char *preconditioner, int threads) {
  bench_solver opened;
  hk_instance *solver = open_solver(&opened, preconditioner, threads);
  size_t n = 3 * c->A.rows;
  double *b = calloc(n, sizeof *b), *x = calloc(n, sizeof *x), m = 0.15 / (double)c->A.rows;
  for (size_t k = 0; k < n; k++)
    b[k] = k / 3 / c->side + 1 < c->side ? m * ((k % 3 == 2 ? -9.81 : 0) / 60 + 1e-2 * noise(k)) : 0;
  const hk_solver *functions = solver->plugin->solver;
  hk_solve_info info = {0};
  double t0 = now();
  hk_status status = functions->analyze(solver->self, &c->A);
  double t1 = now();
  if (status == HK_OK) status = functions->factorize(solver->self, &c->A);
  double t2 = now();
  if (status == HK_OK) status = functions->solve(solver->self, b, x, &info);
  double t3 = now();
  printf(
      "%u x %u, %s, %d thread%s: analysis %.0f ms, numbers %.0f ms, %d iterations in %.0f ms (%.2f ms each), residual "
      "%.1e%s%s\n",
      c->side, c->side, preconditioner, threads, threads > 1 ? "s" : "", (t1 - t0) * 1e3, (t2 - t1) * 1e3,
      info.iterations, (t3 - t2) * 1e3, (t3 - t2) * 1e3 / info.iterations, info.residual, status == HK_OK ? "" : ": ",
      status == HK_OK ? "" : opened.e.error.text);
  free(b);
  free(x);
  close_solver(&opened);
}

int main(void) {
  cloth_matrix c;
  open_cloth_matrix(&c, 512, 1e5, 1 / 60.0);
  for (int threads = 1; threads <= 2; threads++) product(&c, threads);
  close_cloth_matrix(&c);
  open_cloth_matrix(&c, 128, 1e5, 1 / 60.0);
  for (int threads = 1; threads <= 2; threads++) {
    solve(&c, "block_jacobi", threads);
    solve(&c, "incomplete_cholesky", threads);
  }
  close_cloth_matrix(&c);
  return 0;
}
