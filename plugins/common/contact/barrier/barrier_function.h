/* The barrier b(u) = -(u - 1)^2 ln u of Li and others 2020 (Incremental Potential Contact, equation 6) and its
 * derivatives, for 0 < u < 1: infinite at u = 0, and with two continuous derivatives 0 from u = 1 on. */
#ifndef HK_BARRIER_FUNCTION_H
#define HK_BARRIER_FUNCTION_H

#include <math.h>

typedef struct hk_barrier_function {
  double value, slope, curvature;
} hk_barrier_function;

static inline hk_barrier_function hk_barrier_at(double u) {
  double below = u - 1, ln = log(u), part = below / u;
  return (hk_barrier_function){-below * below * ln, -below * (2 * ln + part), -2 * ln - 4 * part + part * part};
}

#endif
