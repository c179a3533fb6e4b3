/* One stage of an implicit method: the v that solves
 *     M (v - v*) = g F(t, x, v, y),   x = x* + g v,   y = y* + g dy/dt,      g = (the method's coefficient) h > 0.
 * With F = -dE/dx this is the minimum of the incremental potential (x - x* - g v*)^T M (x - x* - g v*) / (2 g^2) +
 * E(x), whose gradient is the residual R (up to g): a Newton direction p has p.R < 0, and a step along it is shortened
 * while p.R is positive and above 0.9 of its initial size (Nocedal and Wright, Numerical Optimization, chapter 3). With
 * an unsymmetric Jacobian |R| must decrease instead.
 *
 * In a scene with constraints F includes the constraint forces, and the direction solves A dv + J^T l = -R, J dv = -J
 * M^-1 R (hk_system.solve): J M^-1 R is the residual of the constraints, J (v - v*) + g c with c = d^2 g/dt^2 - J a.
 * The matrix omits the change of J and of the multipliers with v, so convergence is linear at a rate of g |v|/L + g^2
 * |l|/(m L), L being the length over which J turns; |R| must decrease, because R is not the gradient of a potential.
 *
 * The matrix is A = M + g D + g^2 K. Its factors are kept as long as possible: first they are used unchanged (chord
 * steps), while g is the same and the observed rate of convergence is below `slow`; then as the preconditioner of a few
 * conjugate gradient iterations on the matrix of the present iterate; then A is factorized again. A shortcut that fails
 * is omitted for a while, twice as long each time. Blocks are projected to positive semi-definite only after a
 * factorization or a line search has failed.
 *
 * A change dv is measured by its energy norm, sqrt(dv.A dv / 3M) with M the moving mass (Newton's decrement; Boyd and
 * Vandenberghe, Convex Optimization, 9.5.1): motion against soft forces counts by its speed, and stretching of stiff
 * springs by the energy it leaves in them, which is more. With an unsymmetric Jacobian it is the RMS of dv. Convergence
 * is judged as in CVODE (Hindmarsh and others 2005, section 2.1), |dv| min(1, rate) <= limit; a change below a few
 * units of rounding of x counts as converged too, since it cannot be reduced further.
 *
 * Springs damped along their direction have an unsymmetric dF/dx. A solver for unsymmetric matrices gets all of it, and
 * convergence is quadratic; one for symmetric matrices gets it without the rotation of the damping's direction, and
 * convergence is linear at a rate of c |u|/(k l).
 *
 * The channels' equation is solved (channels.h) at every v that the iteration reaches, before the next direction.
 *
 * In a scene with contact every move is limited and, where all forces are gradients, the line search must decrease the
 * incremental potential itself (safe_move.h). */
#ifndef HK_NEWTON_H
#define HK_NEWTON_H

#include "plugins/common/integrate/channels.h"

enum { HK_NEWTON_STATES = 5 }; /* width of the scratch field of `memory`, a field `state` */

/* A cheaper substitute for a factorization: how often in a row it failed, and how many times it is to be omitted. */
typedef struct hk_shortcut {
  int failures, wait;
} hk_shortcut;

typedef struct hk_newton {
  /* parameters */
  double tolerance;    /* algebraic error of v in a step, relative to the largest RMS speed so far */
  int64_t iterations;  /* most iterations per stage */
  int64_t krylov_most; /* most iterations of conjugate gradients that are tried instead of a factorization */
  bool reuse;          /* keep factors; false: new ones in every iteration */
  /* fields: saved */
  double speed; /* m/s, largest RMS speed so far */
  /* fields: scratch */
  double *memory;
  /* Data of the solver's factors; invalid after `create`. */
  double factor_g;
  double rate;  /* rate of convergence with these factors; 0: not observed yet */
  int definite; /* number of coming factorizations whose blocks are projected to positive semi-definite */
  hk_shortcut chord, krylov;
  hk_channels channels;
} hk_newton;

/* Functions hk_plugin.create, .destroy and .topology of methods whose instance is, or begins with, a hk_newton. */
hk_status hk_newton_create(void *self, const hk_host *host, const hk_view *view);
void hk_newton_destroy(void *self, const hk_host *host);
hk_status hk_newton_topology(void *self, const hk_view *view);

/* The parameters of hk_newton, for the table of a method whose instance `type` has it as its member `newton`: the
 * default and the description of the tolerance, and the same of the iterations. */
/* clang-format off */
#define HK_NEWTON_PARAMS(type, tolerance_default, tolerance_doc, iterations_default, iterations_doc)                   \
  {"tolerance", "", tolerance_doc, .number = HK_AT(type, newton.tolerance), .initial = {tolerance_default},            \
   .limits = HK_ABOVE_TO(0, 1)},                                                                                       \
  {"iterations", "", iterations_doc, .integer = HK_AT(type, newton.iterations), .initial = {iterations_default},       \
   .limits = HK_WITHIN(1, 1000)},                                                                                      \
  {"reuse", "", "keep the factors of the matrix while the iteration converges with them",                              \
   .boolean = HK_AT(type, newton.reuse), .initial = {1}},                                                              \
  {"krylov", "", "iterations of conjugate gradients with old factors that are tried before new ones are made",         \
   .integer = HK_AT(type, newton.krylov_most), .initial = {8}, .limits = HK_WITHIN(0, 1000)}
/* clang-format on */

/* HK_NOT_CONVERGED: stage->X is invalid. s->X changes by its pins only. */
hk_status hk_newton_solve(hk_newton *, hk_system *, const hk_stage *);
/* The limit that a fixed-step method sets its stages: tolerance x the largest RMS speed so far, that of `v` included.
 */
double hk_newton_limit(hk_newton *, const hk_system *, const double *v);
void hk_newton_forget(hk_newton *); /* invalidates the factors, after a change of particles or forces */

#endif
