/* The second derivatives of constraints' equations, d^2 g/dx^2 = H, as products. */
#ifndef HK_CONSTRAINT_BEND_H
#define HK_CONSTRAINT_BEND_H

#include "core/numerics/constraints/constraints.h"

/* Scratch: 9n numbers, and twice a gradient for every block as constraints name them. */
typedef struct hk_constraint_bend {
  size_t n;
  double *work, (*beside[2])[3];
} hk_constraint_bend;

size_t hk_constraint_bend_blocks(const hk_dynamics *); /* as constraints name them */
/* to += (sum u_k H_k) dx at x (n x 3 each); t is that of x, u has a number for every equation. */
hk_status hk_constraint_bend_add(hk_dynamics *, const hk_constraint_bend *, double t, const double *x, const double *u,
                                 const double *dx, double *to);
/* rate_k = w H_k dx: how J w changes along dx. */
hk_status hk_constraint_turn(hk_dynamics *, const hk_constraint_bend *, double t, const double *x, const double *dx,
                             const double *w, double *rate);

#endif
