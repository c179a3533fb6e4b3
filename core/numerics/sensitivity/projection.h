/* Steps of scenes with constraints that keep g(x) = 0 by impulses: with a kick of k h at the begin, W the inverse
 * masses after pins, and J = dg/dx, v_h = v + k h a,  y = x + h v_h,  x' = y + W J(x)^T l with g(x') = 0,  v_m = v_h +
 * (x' - y)/h, w = v_m + (1 - k) h a(x', 2 v_m - v),  v' = w + W J(x')^T m with J(x') v' = 0, a without constraint
 * forces: RATTLE for k = 1/2 (Andersen 1983), the symplectic Euler method of Hairer, Lubich and Wanner, Geometric
 * Numerical Integration, VII.1.3 for k = 1. What the run's own a has along W J(x)^T, l takes back.
 *
 * By the implicit function theorem, with H_u = sum_k u_k d^2 g_k/dx^2 and what a parameter makes of masses and g,
 *     (J(x') W J(x)^T) dl = -(J(x') (dy + W H_l dx + dW J^T l) + dg),  dx' = dy + W H_l dx + dW J^T l + W J(x)^T dl,
 *     (J' W J'^T) dm = -(J' (dw + W H_m dx' + dW J'^T m) + (H v') dx'),  dv' likewise with J' = J(x'),
 * and the adjoint by the transposed systems. H is exact: of distances -(I - n n^T)/|d|, of differences none, of ways,
 * which are bilinear, the difference of two Jacobians. */
#ifndef HK_SENSITIVITY_PROJECTION_H
#define HK_SENSITIVITY_PROJECTION_H

#include "core/numerics/sensitivity/constraint_bend.h"
#include "core/numerics/sensitivity/sensitivity.h"

struct hk_projection {
  size_t equations;
  double kick;
  /* The step at hand, on the tape: x, x' and v' (3n each), l and m (an equation each). */
  double *from, *after, *end, *impulse, *lambda;
  double *by_equation, *by_mass; /* sums of an adjoint: by g of every equation, and by masses in W J^T l and m */
  double *push;                  /* 3n: W J^T of l or m */
  double *work;                  /* 30n and an equation each: scratch */
  hk_constraint_bend bend;
  double *memory;
};

/* What a parameter changes: g of every equation, m; masses, kg: by one of the parameter. */
typedef struct hk_projection_slopes {
  double *g, *mass; /* equations; n */
} hk_projection_slopes;

/* Refuses in one sentence constraints and methods whose steps are not differentiated. */
hk_status hk_projection_refuse(const hk_loop *, hk_error *);
/* HK_NO_MEMORY. */
hk_status hk_projection_open(hk_sensitivity *);
void hk_projection_close(hk_sensitivity *);
/* Numbers of the tape of a step, beside its points, and where they are. */
size_t hk_projection_taped(const hk_sensitivity *);
void hk_projection_put(hk_sensitivity *, double *at);

hk_status hk_projection_step(hk_sensitivity *, const hk_taken_step *, hk_carried *Z); /* takes it, from Z to Z */

/* Puts x and v onto the constraints, as a step that goes nowhere: x' = x + W J(x)^T l, v' = v + W J(x')^T m. Its
 * tangents are those of a step whose dv is 0 until x' is found. */
hk_status hk_projection_place(hk_sensitivity *, const hk_taken_step *, double *Z);

/* What parameters change, a list to be freed. Refuses those that change which equations there are. */
hk_status hk_projection_vary(hk_sensitivity *, const hk_varied *, size_t count, hk_projection_slopes **, hk_error *);

/* Of a step the tangents, `apart` numbers each, with da of the first stage: dx and dv in dZ become those of x' and v_m,
 * and dX that of the second stage's point. `by`, NULL: no parameters, has one for every tangent. */
hk_status hk_projection_drift(hk_sensitivity *, const hk_taken_step *, size_t count, size_t apart, const double *da,
                              const hk_projection_slopes *by, hk_carried *dZ, double *dX);
/* dv of w becomes that of v'. */
hk_status hk_projection_settle(hk_sensitivity *, const hk_taken_step *, size_t count, size_t apart,
                               const hk_projection_slopes *by, hk_carried *dZ);

/* ---- projection_adjoint.c ---- */

void hk_projection_begin(hk_sensitivity *); /* an adjoint */
/* L of x' and v' becomes that of x' and w; then that of x' and v_m becomes that of x and v, and u that of a. */
hk_status hk_projection_unsettle(hk_sensitivity *, const hk_taken_step *, hk_carried *L);
hk_status hk_projection_return(hk_sensitivity *, const hk_taken_step *, hk_carried *L, double *u);
/* Of a finished adjoint the derivative by a parameter through constraints. */
double hk_projection_slope(const hk_sensitivity *, const hk_projection_slopes *);

/* ---- projection.c, for both ---- */

/* J and W J at x; and the factors of J W J^T. */
hk_status hk_projection_linearise(hk_dynamics *, double t, const double *x);
hk_status hk_projection_stand(hk_sensitivity *, double t, const double *x);
/* J_end = J at x, the factors of J_end W J^T, and J and W J at the other place. */
hk_status hk_projection_mix(hk_sensitivity *, double t, const double *x, double t_of_push, const double *x_of_push);
void hk_projection_rates(const hk_constraints *, double (*J)[3], const double *u, double *of); /* of = J u */

#endif
