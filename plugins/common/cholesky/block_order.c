/* See block_order.h. METIS takes some ten times as long as AMD, so it is tried where the factorization takes at least
 * as long as METIS; the order with fewer operations is used. */
#include "plugins/common/cholesky/block_order.h"

#include <math.h>
#include <signal.h>

static const double metis_pays = 1e9; /* operations of a factorization with AMD's order, above which METIS is tried */

size_t hk_upper_blocks(const hk_matrix *A, size_t r) {
  size_t e = A->row_start[r];
  while (e < A->row_start[r + 1] && A->column[e] <= r) e++;
  return e - A->row_start[r];
}

static cholmod_sparse *graph_of(cholmod_common *common, const hk_matrix *A) {
  size_t n = A->rows, count = 0;
  for (size_t r = 0; r < n; r++) count += hk_upper_blocks(A, r);
  cholmod_sparse *graph = cholmod_l_allocate_sparse(n, n, count, 1, 1, 1, CHOLMOD_PATTERN, common);
  int64_t *start = graph ? graph->p : NULL;
  for (size_t r = 0; graph && r < n; r++) {
    start[r + 1] = start[r] + (int64_t)hk_upper_blocks(A, r);
    for (int64_t e = 0; e < start[r + 1] - start[r]; e++)
      ((int64_t *)graph->i)[start[r] + e] = A->column[A->row_start[r] + (size_t)e];
  }
  return graph;
}

/* METIS takes these signals for its own errors (signal(), in GKlib), and gives them back without what sigaction had
 * set. */
static const int of_metis[] = {SIGABRT, SIGTERM};
enum { SIGNALS = sizeof of_metis / sizeof *of_metis };

static cholmod_factor *order_by(cholmod_common *common, cholmod_sparse *graph, int ordering) {
  struct sigaction before[SIGNALS];
  common->nmethods = 1;
  common->method[0].ordering = ordering;
  common->postorder = 1;
  for (int k = 0; k < SIGNALS; k++) sigaction(of_metis[k], NULL, &before[k]);
  cholmod_factor *L = cholmod_l_analyze(graph, common);
  for (int k = 0; k < SIGNALS; k++) sigaction(of_metis[k], &before[k], NULL);
  return L;
}

static cholmod_factor *best_order(cholmod_common *common, cholmod_sparse *graph, size_t block) {
  cholmod_factor *L = order_by(common, graph, CHOLMOD_AMD);
  double operations = common->fl;
  if (!L || operations * pow((double)block, 3) < metis_pays) return L;
  cholmod_factor *second = order_by(common, graph, CHOLMOD_METIS);
  bool better = second && common->fl < operations;
  cholmod_l_free_factor(better ? &L : &second, common);
  return better ? second : L;
}

cholmod_factor *hk_block_order(cholmod_common *common, const hk_matrix *A, int ordering) {
  cholmod_sparse *graph = graph_of(common, A);
  cholmod_factor *L = NULL;
  if (graph && ordering == HK_ORDER_BEST) L = best_order(common, graph, A->block);
  if (graph && ordering != HK_ORDER_BEST)
    L = order_by(common, graph, ordering == HK_ORDER_METIS ? CHOLMOD_METIS : CHOLMOD_AMD);
  cholmod_l_free_sparse(&graph, common);
  return L;
}
