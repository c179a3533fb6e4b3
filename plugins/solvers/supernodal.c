/* Sparse Cholesky factorization P A P^T = L L^T of symmetric positive definite matrices in blocks of 3 x 3 numbers, by
 * the multifrontal method of plugins/common/supernodal with CHOLMOD's order.
 *
 * Beside CHOLMOD's own factorization with the best of its orders it takes 0.62, 0.65, 0.74 and 0.82 of the time for
 * cloths of 64, 128, 192 and 256 squared, in turns (tests/bench/cholmod.c, one thread of a Sapphire Rapids, OpenBLAS
 * 0.3.21; with AVX2 on both sides 0.67, 0.72, 0.86 and 0.90), and alone 17, 128, 375 and 820 ms (18, 170, 520 and
 * 1,160). Rows are found by blocks, products are made in tiles for columns by threes of factors that lie in strips
 * (dense_loops.h), and updates are stored, not added to zeros. Where products read fronts as they lay, 256 squared took
 * 1,640 (2,540) ms. Duff and Reid, ACM TOMS 9 (1983); Liu, SIAM Review 34 (1992); Chen, Davis, Hager and Rajamanickam,
 * Algorithm 887: CHOLMOD, ACM TOMS 35 (2008).
 *
 * NESDIS saves a twelfth of METIS's operations at 192 x 192 and nothing at 64, 128 and 256, and would be one more
 * ordering in every analysis: it is not tried.
 *
 * Gradients preconditioned by the factor of an earlier matrix, in floats, were slower in short steps as well: a cloth
 * of 96 x 96 particles, k = 1e5 N/m, 34 steps of bdf2 of 0.5 ms, 19.2 s of the processor beside 7.9; they are left out.
 */
#include "plugins/common/cholesky/block_order.h"
#include "plugins/common/supernodal/supernodal.h"

#include <stdio.h>

typedef struct multifrontal {
  hk_supernodal factor;
  int ordering;
} multifrontal;

static const hk_param params[] = {
    {"ordering", "",
     "fill-reducing ordering; best: AMD, or METIS where the factorization is long and METIS makes it shorter",
     .choice = HK_AT(multifrontal, ordering), .initial = {HK_ORDER_BEST}, .choices = "best|amd|metis"},
    {0},
};

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  multifrontal *s = self;
  (void)view;
  return hk_supernodal_open(&s->factor, host, false);
}

static void destroy(void *self, const hk_host *host) {
  multifrontal *s = self;
  (void)host;
  hk_supernodal_close(&s->factor);
}

static hk_status analyze(void *self, const hk_matrix *A) {
  multifrontal *s = self;
  return hk_supernodal_analyze(&s->factor, A, s->ordering);
}

static hk_status factorize(void *self, const hk_matrix *A) {
  multifrontal *s = self;
  return hk_supernodal_factorize(&s->factor, A);
}

static size_t unknowns(const multifrontal *s) { return s->factor.nodes.rows * s->factor.nodes.block; }

static hk_status no_factor(const multifrontal *s) {
  return s->factor.host->fail(s->factor.host, HK_FAILED, "there is no factorization to solve with");
}

static hk_status check_finite(const multifrontal *s, const double *x, size_t count) {
  double bad = 0;
  for (size_t k = 0; k < count; k++) bad += x[k] * 0;
  if (bad == 0) return HK_OK;
  return s->factor.host->fail(s->factor.host, HK_NOT_FINITE, "the solution of a linear system is not finite");
}

static hk_status solve(void *self, const double *b, double *x, hk_solve_info *info) {
  multifrontal *s = self;
  if (!s->factor.ready) return no_factor(s);
  hk_supernodal_solve(&s->factor, b, x);
  if (info) info->iterations = 0;
  return check_finite(s, x, unknowns(s));
}

static hk_status solve_columns(void *self, const double *b, double *x, size_t columns) {
  multifrontal *s = self;
  if (!s->factor.ready) return no_factor(s);
  hk_status status = hk_supernodal_solve_columns(&s->factor, b, x, columns);
  return status == HK_OK ? check_finite(s, x, columns * unknowns(s)) : status;
}

static void describe(const void *self, char *text, size_t size) {
  int version[3];
  (void)self;
  cholmod_l_version(version);
  snprintf(text, size, "CHOLMOD %d.%d.%d for the order", version[0], version[1], version[2]);
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
    .name = "supernodal",
    .summary =
        "sparse Cholesky, A = P^T L L^T P, by dense fronts on all threads, for symmetric positive definite matrices",
    .reference = "Duff and Reid 1983, ACM TOMS 9; Liu 1992, SIAM Review 34; Chen, Davis, Hager and Rajamanickam 2008",
    .instance_size = sizeof(multifrontal),
    .params = params,
    .create = create,
    .destroy = destroy,
    .solver = &solver,
};
