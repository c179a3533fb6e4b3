/* Preconditioned conjugate gradients (gradients_loop.h) on a symmetric positive definite block matrix. Results are
 * bitwise equal for any number of threads if those of the preconditioner are. */
#ifndef HK_CONJUGATE_GRADIENTS_H
#define HK_CONJUGATE_GRADIENTS_H

#include "plugins/common/gradients/gradients_loop.h"
#include "plugins/common/linear/upper_matrix.h"

typedef struct hk_gradients_system {
  /* z = M^-1 r with M symmetric and positive definite; returns r.z. Both have eight numbers beyond their ends. */
  double (*precondition)(void *context, const double *r, double *z);
  void *context;
  double tolerance;   /* of |b - A x| / |b| where the caller asks for none */
  int64_t iterations; /* at most; 0: 10 more than there are unknowns, or 1000 if that is more */
} hk_gradients_system;

typedef struct hk_gradients {
  const hk_host *host;
  hk_upper A;
  size_t rows, block;                /* of the pattern that was analysed; 0: none was */
  bool ready;                        /* A has numbers, and the preconditioner those of A: set by the caller */
  const hk_gradients_system *system; /* during a solution */
  hk_gradients_loop loop;
  double *vectors; /* x, r, z, p, q, each of the unknowns and some padding */
  double *whole;   /* of chunks: b.b */
} hk_gradients;

/* Takes the pattern of A. HK_NO_MEMORY, HK_FAILED (more blocks than 32-bit numbers count), with a message. */
hk_status hk_gradients_analyze(hk_gradients *, const hk_host *, const hk_matrix *A);
/* Takes the numbers of A; not ready until the caller says so. HK_FAILED with a message: it has another pattern. */
hk_status hk_gradients_fill(hk_gradients *, const hk_host *, const hk_matrix *A);
void hk_gradients_free(hk_gradients *, const hk_host *);               /* a zeroed structure is allowed */
hk_status hk_gradients_no_memory(const hk_host *, const hk_matrix *A); /* fails: no memory to store A */
/* info: as of hk_solver.solve, NULL or with the tolerance; it gets the iterations and the residual b - A x that was
 * computed last, relative to b. HK_NOT_CONVERGED, HK_NOT_FINITE with a message; x is then as it was. */
hk_status hk_gradients_solve(hk_gradients *, const hk_host *, const hk_gradients_system *, const double *b, double *x,
                             hk_solve_info *info);

/* The parameters of a solver plugin, with int64_t iterations and double tolerance. */
#define HK_GRADIENTS_PARAMS(type)                                                                                      \
  {"tolerance",                                                                                                        \
   "",                                                                                                                 \
   "residual that will do, relative to the right-hand side, where the integrator asks for none",                       \
   .number = HK_AT(type, tolerance),                                                                                   \
   .initial = {1e-8},                                                                                                  \
   .limits = HK_ABOVE_TO(0, 1)},                                                                                       \
  {                                                                                                                    \
    "iterations", "",                                                                                                  \
        "limit; 0: 10 more than there are unknowns, which would do without rounding, or 1000 if that is more",         \
        .integer = HK_AT(type, iterations), .limits = HK_WITHIN(0, 1e9)                                                \
  }

#endif
