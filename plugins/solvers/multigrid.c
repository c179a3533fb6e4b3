/* Conjugate gradients preconditioned by algebraic multigrid, for symmetric positive definite matrices of sheets and
 * solids that are too large to factorize: a number of iterations that hardly grows with the size.
 *
 * The preconditioner is one V-cycle of smoothed aggregation (plugins/common/multigrid/hierarchy.c), with translations
 * as near-null space: a solver is given a matrix and no positions. A fixed particle, whose rows have diagonal entries
 * only, is on no further level, so it satisfies its pin bitwise; a particle on a line or plane does to the tolerance,
 * and methods filter the solution. Levels follow from the matrix alone and are made in every factorization, so that a
 * run that goes on from a checkpoint has the same. Vanek, Mandel and Brezina, Computing 56 (1996).
 *
 * No library: hypre and PETSc bring MPI along and give bits that depend on the number of processes, AMGCL is C++ and
 * not in Debian; SuiteSparse, which is there for direct solvers, has no multigrid.
 *
 * On the matrix of an implicit step of a cloth, k = 1e5 N/m, h = 1/60 s, residual 1e-6, one thread of a busy Sapphire
 * Rapids (tests/bench/multigrid.c): 64, 128, 256 and 512 squared take 11, 13, 17 and 16 iterations, 0.05, 0.2, 0.9
 * and 4.5 s with set-up, 0.47 GB at 512; pcg 108 at 64 and 582 at 256 to 1e-3. `supernodal` factorizes 256 in 0.8 s and
 * solves in 0.1, so this pays beyond. */
#include "plugins/common/gradients/conjugate_gradients.h"
#include "plugins/common/multigrid/hierarchy.h"

typedef struct multigrid {
  double tolerance;
  int64_t iterations;
  const hk_host *host;
  hk_gradients gradients;
  hk_hierarchy hierarchy;
} multigrid;

static const hk_param params[] = {HK_GRADIENTS_PARAMS(multigrid), {0}};

static hk_status create(void *self, const hk_host *host, const hk_view *view) {
  multigrid *s = self;
  (void)view;
  s->host = host;
  return hk_hierarchy_open(&s->hierarchy, host);
}

static void destroy(void *self, const hk_host *host) {
  multigrid *s = self;
  (void)host;
  hk_hierarchy_close(&s->hierarchy);
}

static hk_status analyze(void *self, const hk_matrix *A) {
  multigrid *s = self;
  return hk_gradients_analyze(&s->gradients, s->host, A);
}

static hk_status factorize(void *self, const hk_matrix *A) {
  multigrid *s = self;
  hk_status status = hk_gradients_fill(&s->gradients, s->host, A);
  if (status == HK_OK) status = hk_hierarchy_build(&s->hierarchy, A, &s->gradients.A);
  s->gradients.ready = status == HK_OK;
  return status;
}

static double precondition(void *context, const double *r, double *z) {
  return hk_hierarchy_apply(&((multigrid *)context)->hierarchy, r, z);
}

static hk_status solve(void *self, const double *b, double *x, hk_solve_info *info) {
  multigrid *s = self;
  hk_gradients_system system = {precondition, s, s->tolerance, s->iterations};
  return hk_gradients_solve(&s->gradients, s->host, &system, b, x, info);
}

static const hk_solver solver = {.size = sizeof(hk_solver),
                                 .flags = HK_ITERATIVE | HK_MULTILEVEL,
                                 .analyze = analyze,
                                 .factorize = factorize,
                                 .solve = solve};

HK_EXPORT const hk_plugin hk_plugin_main = {
    .abi = HK_ABI,
    .kind = HK_SOLVER,
    .name = "multigrid",
    .summary = "conjugate gradients with smoothed aggregation, for large symmetric positive definite matrices",
    .reference = "Vanek, Mandel and Brezina 1996, Computing 56; Adams, Brezina, Hu and Tuminaro 2003",
    .instance_size = sizeof(multigrid),
    .params = params,
    .create = create,
    .destroy = destroy,
    .solver = &solver,
};
