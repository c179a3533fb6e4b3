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
       HK_ITERATIVE = 4 /* needs little memory: the host's choice for very many unknowns */
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

#endif
