/* Moves of an implicit stage in a scene with contact, hk_system.contact. A move begins at a state without overlap; the
 * forces update their contacts for it (hk_system.update) and state its safe fraction (step_limit); no more than that is
 * taken. So no evaluation ever sees an overlap (Li and others 2020, "Incremental Potential Contact", section 5). These
 * functions must not be called for systems without contact.
 *
 * Where all forces are gradients of their energies, a stage minimises the incremental potential
 *     (v - v*)^T M (v - v*) / 2 + E(x* + g v),
 * whose gradient with respect to v is the residual of Newton's method; a line search must then decrease it. */
#ifndef HK_SAFE_MOVE_H
#define HK_SAFE_MOVE_H

#include "plugins/common/integrate/stage.h"

/* *part: the safe fraction of the displacement dx (n x 3) from X at time t. `scratch`: n x 3. */
hk_status hk_safe_part(hk_system *, double t, const double *X, const double *dx, double *scratch, double *part);
/* To be called before the first evaluation of a stage. Where the straight line from s->X to the guess is not safe, the
 * stage starts at the positions of s->X. *safe is false where scripted particles move into contact from there: see
 * carry_pins.h. dx and scratch: n x 3. */
hk_status hk_safe_start(hk_system *, const hk_stage *, double *dx, double *scratch, bool *safe);
/* HK_NOT_CONVERGED when the straight line from the positions of the stage to those of X, the new state, is not safe. */
hk_status hk_safe_end(hk_system *, double t, const double *stage, const double *X, double *dx, double *scratch);

bool hk_stage_minimises(const hk_system *); /* whether there is contact and all included forces are gradients */
/* The incremental potential in J at stage->X, whose positions must be those of the last evaluation; infinite where it
 * is not finite. */
hk_status hk_stage_potential(hk_system *, const hk_stage *, double *value);
/* *above: the incremental potential at stage->X is above that of particles which stay where the stage begins (pinned
 * ones move as they must), so that the solution is a stationary point behind a barrier. `power`, W, is that of the
 * forces without an energy, whose work may lift it. `rest`: 3n numbers, on return the velocities of that other state.
 */
hk_status hk_stage_above_rest(hk_system *, const hk_stage *, double power, double *rest, bool *above);

/* The incremental potential at the start of a line search, and its derivative `slope` along the direction. */
typedef struct hk_descent {
  bool known; /* false: the stage minimises no potential */
  double start, slope;
} hk_descent;

/* Whether a step of length alpha to `value` decreases the potential: Armijo's condition (Nocedal and Wright, section
 * 3.1). Also accepted is a step that changes the potential by no more than its rounding, when `level` says that the
 * derivative has not grown beyond the minimum (Hager and Zhang 2005). */
bool hk_descent_falls(const hk_descent *, double value, double alpha, bool level);

#endif
