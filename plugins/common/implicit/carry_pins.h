/* The start of an implicit stage in which scripted particles move into others: the stage must begin at positions
 * without overlap that have these particles where they are at its time. They are carried there by safe moves from the
 * state before the step, and push what stands in their way: every move is a Newton step of the stage in which they go
 * on to the stage's time, or as far as is safe.
 * (Baraff and Witkin 1998, section 5.1, for prescribed motion in a linear system; the safe part as in safe_move.h.) */
#ifndef HK_CARRY_PINS_H
#define HK_CARRY_PINS_H

#include "plugins/common/integrate/stage.h"

enum { HK_CARRY_VECTORS = 8 }; /* memory, in vectors of n x 3, beside a and dy */

/* stage->X: any on entry; on return positions without overlap at stage->t, and their v. `slopes`: shaped as s->X less
 * its first 3n; `memory`: HK_CARRY_VECTORS x 3n. HK_NOT_CONVERGED: there is no way, or it takes too many moves. */
hk_status hk_carry_pins(hk_system *, const hk_stage *, double *slopes, double *memory);

#endif
