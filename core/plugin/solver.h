/* Solvers of sparse linear systems. */
#ifndef HK_PLUGIN_SOLVER_H
#define HK_PLUGIN_SOLVER_H

#include "core/plugin/model.h"

/* Sparse matrix in block compressed rows, both triangles stored; columns rise within a row. */
typedef struct hk_matrix {
  size_t rows;             /* block rows = block columns */
  size_t block;            /* 3 or 1: a block is block x block numbers, row-major */
  const size_t *row_start; /* rows + 1 */
  const uint32_t *column;  /* row_start[rows] */
  double *value;           /* row_start[rows] x block x block */
  bool symmetric;          /* equal to its transpose up to rounding */
  uint64_t pattern; /* number of the pattern (row_start and column): equal numbers mean equal patterns; 0: no number */
} hk_matrix;

typedef struct hk_solve_info {
  int iterations;   /* 0 for direct solvers */
  double residual;  /* |b - A x| / |b|; direct solvers may leave it as it is */
  double tolerance; /* input for iterative solvers: the residual to reach; 0: the solver's own */
} hk_solve_info;

enum { /* hk_solver.flags */
       HK_SOLVES_UNSYMMETRIC = 1,
       HK_SOLVES_INDEFINITE = 2,
       HK_ITERATIVE = 4, /* needs little memory: the host's choice for very many unknowns */
       HK_MULTILEVEL = 8 /* iterations hardly grow with the size, for a dear factorization: for the largest alone */
};

typedef struct hk_solver {
  size_t size;
  unsigned flags;
  hk_status (*analyze)(void *self, const hk_matrix *A); /* analyses the pattern; once per pattern; may be NULL */
  /* factorizes the values; HK_NOT_CONVERGED: A is not positive definite */
  hk_status (*factorize)(void *self, const hk_matrix *A);
  hk_status (*solve)(void *self, const double *b, double *x, hk_solve_info *info); /* b, x: rows x block; b != x */
  /* Several right-hand sides; b, x: (rows x block) x columns, row-major. NULL: the host solves them one by one. */
  hk_status (*solve_columns)(void *self, const double *b, double *x, size_t columns);
  /* The libraries in use, "OpenBLAS 0.3.21", at any time after create. NULL: the solver uses none. */
  void (*describe)(const void *self, char *text, size_t size);
  /* For a solver of matrices of one kind: whether A, by its pattern, is one of them, so that this solver is the host's
   * choice for it; the last analysis and factors stay as they are. NULL: the host may choose it for any pattern. */
  bool (*fits)(void *self, const hk_matrix *A);
} hk_solver;

/* ---- "solvers/1", which the host serves itself ------------------------------------------------------------------- */

/* For forces, correctors and others that solve sparse linear systems of their own, A x = b: a projection, a potential.
 * Each has a solver plugin of its own, apart from that of an implicit method: they share nothing. The calls use the
 * host's threads, so not inside a parallel_for nor in `add_part`; for the same A and b, x has the same bits whatever
 * their number. Errors name the plugin that asked; return their status, as the run ends by it. */
typedef struct hk_linear hk_linear; /* a solver with the pattern that it has analysed, a copy of A, and its factors */

typedef struct hk_solvers {
  void *self;
  /* Called in `create`, where `host` is the caller's; `made` is valid until its `destroy`. `needs`: the flags
   * HK_SOLVES_... that its matrices need, 0: all are symmetric and positive definite. `name`: of a solver plugin; NULL:
   * the scene's where that has these flags, or else one that the host chooses by them, the pattern and the size.
   * HK_BAD_PARAM: there is no such solver, or it lacks a flag. */
  hk_status (*open)(void *self, const hk_host *host, const char *name, unsigned needs, hk_linear **made);
  /* Factorizes A, of at least one row, which it copies. It compares the pattern with the last one itself, whatever A->
   * pattern says, and analyses, and allocates, only when that has changed. Without HK_SOLVES_UNSYMMETRIC, A is compared
   * with its transpose, whatever A->symmetric says. Checkpoints hold no factors: where A changes with the state,
   * factorize in each call that solves; what depends on the topology alone, in `create` and `topology`. HK_FAILED,
   * HK_NOT_CONVERGED: A is no matrix of the kind asked for, or it is singular up to rounding: with a right-hand side
   * of random numbers, |A x - b| is above 1e-6 |b| (largest numbers; not tried with iterative solvers). HK_NOT_FINITE.
   */
  hk_status (*factorize)(hk_linear *, const hk_matrix *A);
  /* x of the last A; b, x: rows x block; b != x. `info` may be NULL; its tolerance, |b - A x| / |b|, is a wish to
   * iterative solvers, 0: their own. HK_NOT_CONVERGED: |A x - b| is above 1e-6 |b|, or above twice the tolerance. */
  hk_status (*solve)(hk_linear *, const double *b, double *x, hk_solve_info *info);
} hk_solvers;

#endif
