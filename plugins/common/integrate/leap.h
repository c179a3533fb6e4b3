/* A leapfrog step's operations on a block of particles, before and after the evaluation at its end:
 *     x' = x + h (v + h/2 a),   v + h a;   then v' = v + h/2 (a + a'). */
#ifndef HK_LEAP_H
#define HK_LEAP_H

#include <stddef.h>

/* The state and its slope at the start of a step, and at its end. */
typedef struct hk_leap {
  const double *x, *v, *a;
  double *x_next, *v_next;
  const double *a_next;
  double h;
} hk_leap;

/* hk_pass.prepare and finish, of an hk_leap: of the particles begin to end - 1. */
void hk_leap_predict(void *leap, size_t begin, size_t end);
void hk_leap_predict_here(void *leap, size_t begin, size_t end); /* in place, from x_next and v_next */
void hk_leap_kick(void *leap, size_t begin, size_t end);         /* of v and v + h a: `a` may have become a_next */
void hk_leap_correct(void *leap, size_t begin, size_t end); /* the same of v + h a and both slopes: v is not read */

#endif
