/* Static equilibrium of a run: positions at which forces and the forces of constraints balance, with all velocities 0.
 */
#ifndef HK_EQUILIBRIUM_H
#define HK_EQUILIBRIUM_H

#include "core/run/run/run.h"

typedef struct hk_equilibrium {
  double tolerance; /* residual that is allowed, relative to the largest force at the start; in */
  /* what was found */
  bool balanced;        /* the residual is within `allowed` */
  double residual;      /* N, the largest force that is left on a particle that may move */
  uint32_t id;          /* that particle */
  double first;         /* N, the same at the start */
  double allowed;       /* N: by the tolerance, or what the rounding of positions leaves */
  double lowered;       /* J, by which the potential energy fell; NAN: forces without one act */
  size_t stages;        /* Newton's method was solved so often */
  bool asked, returned; /* it was pushed by `pushed`, and came back */
  double pushed, away;  /* m, RMS: the push; the distance from there at which it balances after it */
} hk_equilibrium;

/* Takes the run's state to the equilibrium that it would slide to. HK_BAD_PARAM: the scene has what has no equilibrium,
 * or none that this finds. The run's method has to solve linear systems (HK_NEEDS_JACOBIAN). */
hk_status hk_equilibrium_find(hk_run *, hk_equilibrium *, hk_error *);

#endif
