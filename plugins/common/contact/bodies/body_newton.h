/* Newton's iteration for all impacts at once. */
#ifndef HK_BODY_NEWTON_H
#define HK_BODY_NEWTON_H

#include "plugins/common/contact/bodies/body_system.h"

typedef struct hk_body_newton_task {
  bool speeds;      /* of velocities, y = v; else y = x */
  bool rest;        /* what lies still: where the iteration stops, convex programs (cone_program.h) begin it again */
  double tolerance; /* m or m/s */
  double *y;        /* n x 3 */
  bool still;       /* what touches lies still, or nearly so */
} hk_body_newton_task;

/* Solves all impacts of a level together that take part and have been met. *solved: to the tolerance; else nothing was
 * changed. */
hk_status hk_body_newton(hk_body_impacts *, hk_contact_solver *, const hk_body_newton_task *, bool *solved);

#endif
