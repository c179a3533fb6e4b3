/* Moves of a method in a scene with contact: where a force has `update` or `step_limit`. Methods call the first two
 * before every move. */
#ifndef HK_PLUGIN_MOVES_H
#define HK_PLUGIN_MOVES_H

#include "core/plugin/integrator.h"

/* hk_system.contact */
typedef struct hk_contact_table {
  /* Calls `update` of all acting forces, from X to the positions x_to (n x 3); before a line search. K, D, A and the
   * factors remain valid; the next Jacobian has the new pattern. */
  hk_status (*update)(hk_system *, double t, const double *X, const double *x_to);
  /* The minimum over all acting forces, in (0, 1], for the displacement dx (n x 3); to be called after `update`. */
  double (*step_limit)(hk_system *, double t, const double *X, const double *dx);
  /* The potential energy in J at time t of the included forces that have an energy, also of those with timed
   * parameters. */
  hk_status (*potential)(hk_system *, double t, const double *X, double *joule);
  /* J, of the motion and of the forces whose work is not counted in the last entry of X. */
  hk_status (*energy)(hk_system *, double t, const double *X, double *kinetic, double *potential);
} hk_contact_table;

#endif
