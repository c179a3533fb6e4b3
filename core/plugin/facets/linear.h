/* Jacobians and linear systems, for implicit methods. */
#ifndef HK_PLUGIN_LINEAR_H
#define HK_PLUGIN_LINEAR_H

#include "core/plugin/force.h"
#include "core/plugin/integrator.h"
#include "core/plugin/solver.h"

/* hk_system.linear */
typedef struct hk_linear_table {
  /* K = -dF/dx, D = -dF/dv at (t, x, v), 3x3 blocks with one common pattern that holds the whole diagonal; not
   * filtered, without masses. `want`: HK_WANT_...; K->symmetric says whether the blocks are symmetric. Valid until the
   * next call. */
  hk_status (*jacobian)(hk_system *, double t, double *X, unsigned want, hk_matrix *K, hk_matrix *D);
  /* A = m M + d D + k K of the last `jacobian`, with the pins: A = S (m M + d D + k K) S + s (I - S), where S is
   * `filter` and s a number of the size of the diagonal, so that the solution for a filtered right-hand side satisfies
   * the pins (up to rounding on slides: filter it). Valid until the next call. */
  hk_status (*combine)(hk_system *, double m, double d, double k, hk_matrix *A);
  /* Factorizes A, as `combine` made it, by the scene's solver. In a scene with constraints, b is a force and x
   * satisfies J x = J M^-1 b beside A x + J^T lambda = b, J being that of the last evaluation. The host calls `analyze`
   * when the pattern (row_start, column) has changed. */
  hk_status (*factorize)(hk_system *, const hk_matrix *A);
  hk_status (*solve)(hk_system *, const double *b, double *x, hk_solve_info *info);
  /* As `solve`, with J x = J u (u: n x 3): for methods whose right-hand side is not a residual of forces. */
  hk_status (*solve_along)(hk_system *, const double *b, const double *u, double *x, hk_solve_info *info);
  hk_status (*solve_columns)(hk_system *, const double *b, double *x, size_t columns); /* as hk_solver's */
  /* The flags HK_SOLVES_... of the scene's solver, which is already chosen: the direct one for symmetric matrices,
   * unless a force has an unsymmetric Jacobian only, or the scene is very large. With constraints: one for indefinite
   * matrices. */
  hk_status (*solver_flags)(hk_system *, unsigned *flags);
  /* dF = (dF/dx) dx + (dF/dv) dv of the included forces (n x 3), by their blocks; K and D
   * of the last `jacobian` are then invalid. */
  hk_status (*product)(hk_system *, double t, const double *X, const double *dx, const double *dv, double *dF);
  /* Given to the forces with `jacobian` (hk_blocks); a method that sets them sets them to NULL again after it. */
  const double *linearised, *reached;
  /* The potential energy in J at time t of the included forces that have an energy, also of those with timed
   * parameters. */
  hk_status (*potential)(hk_system *, double t, const double *X, double *joule);
} hk_linear_table;

#endif
