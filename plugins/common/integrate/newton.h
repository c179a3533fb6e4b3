/* One stage of an implicit method: the v that solves
 *     M (v - v*) = g F(t, x, v, y),   x = x* + g v,   y = y* + g dy/dt,      g = (the method's coefficient) h > 0.
 * With F = -dE/dx this is the minimum of the incremental potential (x - x* - g v*)^T M (x - x* - g v*) / (2 g^2) +
 * E(x), whose gradient the residual is (up to g): a Newton direction p has p.R < 0, and a step along it is shortened
 * while p.R has grown to the other side (Nocedal and Wright, Numerical Optimization, chapter 3). With an unsymmetric
 * Jacobian |R| has to fall instead.
 *
 * In a scene with constraints F has their forces in it, and the direction solves A dv + J^T l = -R, J dv = -J M^-1 R
 * (hk_system.solve): J M^-1 R is the constraints' own residual, J (v - v*) + g c with c = d^2 g/dt^2 - J a. How J and
 * the multipliers change with v is left out of the matrix, so convergence is linear at a rate of g |v|/L + g^2 |l|/(m
 * L), L being the length over which J turns; |R| has to fall, for there is no potential whose gradient it is.
 *
 * The matrix is A = M + g D + g^2 K. Its factors serve as long as they do: first as they are (chord steps), while g is
 * the same and the observed rate of convergence is below `slow`; then as the preconditioner of a few conjugate
 * gradients on the matrix of the present iterate; then new ones are made. A shortcut that fails is left out for a
 * while, twice as long each time. Blocks are projected to positive semi-definite only when a factorization or a descent
 * has failed.
 *
 * A change dv is measured by its energy norm, sqrt(dv.A dv / 3M) with M the moving mass (Newton's decrement; Boyd and
 * Vandenberghe, Convex Optimization, 9.5.1): what bends softly counts by its speed, what stretches springs by the
 * energy that it leaves in them, which is more. With an unsymmetric Jacobian it is the RMS of dv. Convergence is judged
 * as in CVODE (Hindmarsh and others 2005, section 2.1), |dv| min(1, rate) <= limit; below a few units of rounding of x
 * nothing more can be had, and that counts as converged too.
 *
 * Springs damped along their direction have an unsymmetric dF/dx. A solver for unsymmetric matrices gets it whole, and
 * convergence is quadratic; one for symmetric matrices gets it without the turning of the damping's direction, and
 * convergence is linear at a rate of c |u|/(k l).
 *
 * In a scene with contact every move is limited and, where all forces are gradients, the line search must decrease the
 * incremental potential itself (safe_move.h). */
#ifndef HK_NEWTON_H
#define HK_NEWTON_H

#include "plugins/common/integrate/stage.h"

enum { HK_NEWTON_STATES = 7 }; /* width of the field that `memory` is, HK_FIELD_STATE and scratch */

/* Something cheaper that may do: how often in a row it has not, and how many times it is left out. */
typedef struct hk_shortcut {
  int failures, wait;
} hk_shortcut;

typedef struct hk_newton {
  /* parameters */
  double tolerance;    /* algebraic error of v in a step, relative to the largest RMS speed so far */
  int64_t iterations;  /* at most, per stage */
  int64_t krylov_most; /* iterations of conjugate gradients that may stand for a factorization */
  bool reuse;          /* keep factors; false: new ones in every iteration */
  /* fields: saved */
  double speed; /* m/s, largest RMS so far */
  /* fields: scratch */
  double *memory;
  /* What is known of the factors in the solver; void after `create`. */
  double factor_g;
  double rate;  /* of convergence with them, 0: not seen yet */
  int definite; /* factorizations for which blocks are still projected */
  hk_shortcut chord, krylov;
} hk_newton;

/* HK_NOT_CONVERGED: X is worth nothing. s->X is not touched, but for its pins. */
hk_status hk_newton_solve(hk_newton *, hk_system *, const hk_stage *);
/* What a method with a fixed step asks of its stages: tolerance x the largest RMS speed so far, that of `v` included.
 */
double hk_newton_limit(hk_newton *, const hk_system *, const double *v);
void hk_newton_forget(hk_newton *); /* the factors are void: other particles, other forces */
/* After `solve`, for error estimates: x = (M + g D + g^2 K)^-1 M b with the factors at hand; b is overwritten. */
hk_status hk_newton_smooth(hk_system *, double *b, double *x);

#endif
