/* A leapfrog step's operations on the numbers begin to end - 1, before and after the evaluation at its end:
 *     x' = x + h (v + h/2 a),   v + h a;   then v' = v + h/2 (a + a') of v and v + h a alone. */
#ifndef HK_LEAP_H
#define HK_LEAP_H

#include <stddef.h>

/* Values of the state at the start of a step and at its end, and the acceleration. */
typedef struct hk_leap {
  const double *x, *v;
  double *x_next, *v_next, *a;
  double h;
} hk_leap;

/* hk_pass.prepare and finish, of an hk_leap: of the particles begin to end - 1. */
void hk_leap_predict(void *leap, size_t begin, size_t end);
void hk_leap_kick(void *leap, size_t begin, size_t end);

#endif
