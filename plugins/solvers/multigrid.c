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
 * and 4.6 s with set-up, 0.54 GB at 512; pcg 108 at 64 and 582 at 256 to 1e-3. `supernodal` factorizes 256 in 0.8 s and
 * solves in 0.1, so this pays beyond. */
#include "plugins/common/gradients/conjugate_gradients.h"
#include "plugins/common/multigrid/hierarchy.h"

typedef struct multigrid {
  double tolerance;
  int64_t iterations;
  const hk_host *host;
  size_t rows, block; /* sizes of the analysed matrix */
  bool analyzed, ready;
  hk_upper upper;
  hk_gradients gradients;
  hk_hierarchy hierarchy;
} multigrid;

static const hk_param params[] = {
    {"tolerance", "", "residual that will do, relative to the right-hand side, where the integrator asks for none",
     .number = HK_AT(multigrid, tolerance), .initial = {1e-8}, .limits = HK_ABOVE_TO(0, 1)},
    {"iterations", "",
     "limit; 0: 10 more than there are unknowns, which would do without rounding, or 1000 if that is more",
     .integer = HK_AT(multigrid, iterations), .limits = HK_WITHIN(0, 1e9)},
    {0},
};

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

static hk_status no_memory(const multigrid *s, const hk_matrix *A) {
  return s->host->fail(s->host, HK_NO_MEMORY, "no memory to store a matrix of %zu rows", A->rows * A->block);
}

static hk_status analyze(void *self, const hk_matrix *A) {
  multigrid *s = self;
  s->analyzed = s->ready = false;
  hk_upper_free(&s->upper, s->host);
  if (A->row_start[A->rows] >= UINT32_MAX)
    return s->host->fail(s->host, HK_FAILED, "%zu blocks are more than 32-bit numbers can count",
                         A->row_start[A->rows]);
  s->rows = A->rows;
  s->block = A->block;
  if (hk_upper_analyze(&s->upper, s->host, A) != HK_OK) return no_memory(s, A);
  if (hk_gradients_analyze(&s->gradients, s->host, A->rows * A->block) != HK_OK) return no_memory(s, A);
  s->analyzed = true;
  return HK_OK;
}

static hk_status factorize(void *self, const hk_matrix *A) {
  multigrid *s = self;
  if (!s->analyzed || A->rows != s->rows || A->block != s->block)
    return s->host->fail(s->host, HK_FAILED, "the pattern of the matrix was not analysed");
  s->ready = false;
  hk_upper_fill(&s->upper, s->host, A);
  hk_status status = hk_hierarchy_build(&s->hierarchy, A, &s->upper);
  s->ready = status == HK_OK;
  return status;
}

static double precondition(void *context, const double *r, double *z) {
  return hk_hierarchy_apply(&((multigrid *)context)->hierarchy, r, z);
}

static hk_status solve(void *self, const double *b, double *x, hk_solve_info *info) {
  multigrid *s = self;
  if (!s->ready) return s->host->fail(s->host, HK_FAILED, "there is no matrix to solve with");
  hk_gradients_system system = {&s->upper, precondition, s, s->tolerance, s->iterations};
  return hk_gradients_solve(&s->gradients, &system, b, x, info);
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
