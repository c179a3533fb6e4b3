/* A solver plugin together with the pattern it has analysed. Where the run has chosen the solvers, every new pattern
 * decides between two: one for matrices of a kind, which goes first where it fits, and one for any matrix. */
#ifndef HK_LINEAR_SYSTEM_H
#define HK_LINEAR_SYSTEM_H

#include "core/dynamics/dynamics.h"

typedef struct hk_linear_system {
  hk_instance *solver;  /* the one in use */
  hk_instance *any;     /* takes every pattern; NULL until it is needed */
  hk_instance *special; /* takes those that it fits (hk_solver.fits), or NULL */
  bool apart;           /* these are instances of its own, not those of the run */
  uint64_t pattern;     /* number or hash of the analysed pattern */
  bool analyzed;
  size_t rows; /* length of a right-hand side */
} hk_linear_system;

/* The solver in use becomes the one for the pattern of A, which is not analysed yet. */
hk_status hk_linear_system_choose(hk_dynamics *, hk_linear_system *, const hk_matrix *A);
/* Second instances with the parameters of the run's, for the multipliers; the caller destroys them. */
hk_status hk_solver_twins(hk_dynamics *, hk_linear_system *);
/* Analyses A when its pattern differs from the last one, then factorizes it. */
hk_status hk_linear_system_factorize(hk_dynamics *, hk_linear_system *, const hk_matrix *A);
hk_status hk_linear_system_solve(hk_dynamics *, hk_linear_system *, const double *b, double *x,
                                 hk_solve_info *info); /* info: or NULL */
hk_status hk_linear_system_solve_columns(hk_dynamics *, hk_linear_system *, const double *b, double *x, size_t columns);

#endif
