/* Constraints within a method's own step, for methods that keep g = 0 and J v + g_t = 0 themselves: SHAKE's correction
 * of positions,
 *     x += W J^T L,  J at the start of the step, with g(x, t) = 0 at its end,
 * by Newton's iteration with the matrix J W J^T of the start, whose error falls by a factor of the order of h a round,
 * and RATTLE's correction of velocities,
 *     v += W J^T M,  J at x, with J v + g_t = 0,
 * one linear solution. Both together with half a kick before and after make a symplectic and reversible map, because
 * impulses act along J^T of the ends of the step alone (Ryckaert, Ciccotti and Berendsen 1977; Andersen 1983;
 * Leimkuhler and Skeel 1994; Hairer, Lubich and Wanner, Geometric Numerical Integration, VII.1.4).
 *
 * The iteration goes on until rounding: what it left would be an impulse g/h in every step, of one sign.
 *
 * Invariant: the factors of the velocities' matrix serve the next step's positions. They are a function of (x, t)
 * alone, and `kept_x` and `kept_t` say of which, so that a run that goes on from a checkpoint makes the same ones anew.
 */
#include "core/dynamics/constraints.h"

#include <float.h>
#include <string.h>

enum { ROUNDS = 40 };

/* Relative to the largest coordinate: where the iteration may end although rounding still falls, and the rounding of a
 * length. `implied_tolerance` as in constraint_projection.c. */
static const double rounding = 4 * DBL_EPSILON, good = 1e-12, implied_tolerance = 1e-7;

static hk_status linearise(hk_dynamics *d, double t, const double *x, const double *v) {
  hk_constraints *c = d->constraints;
  c->kept = false;
  hk_status status = hk_constraint_matrix_linearise(d, t, x, v);
  if (status == HK_OK) status = hk_constraint_speed(d, t, x, v);
  if (status == HK_OK) status = hk_constraint_matrix_factorize(d);
  if (status != HK_OK) return status;
  memcpy(c->kept_x, x, 3 * d->state->model.n * sizeof *x);
  c->kept_t = t;
  c->kept = true;
  return HK_OK;
}

/* Makes J, A and its factors those of x and t, where the pins and parameters of t are imposed. */
static hk_status begin(hk_dynamics *d, double t, double *x, double *v) {
  const hk_constraints *c = d->constraints;
  if (c->kept && c->kept_t == t && memcmp(c->kept_x, x, 3 * d->state->model.n * sizeof *x) == 0) return HK_OK;
  hk_status status = hk_dynamics_impose(d, t, x, v);
  return status == HK_OK ? linearise(d, t, x, v) : status;
}

/* The largest |g| of the equations that act; NaN counts as the largest. */
static double largest_violation(const hk_constraints *c, size_t *worst) {
  double most = 0;
  for (size_t k = 0; k < c->equations; k++) {
    if (c->scale[k] == 0 || fabs(c->g[k]) <= most) continue;
    most = fabs(c->g[k]);
    *worst = k;
    if (isnan(most)) break;
  }
  return most;
}

/* Equations that follow from others hold because those do, or else all are solved for together from now on. */
static bool consequences_hold(hk_constraints *c, double size) {
  bool hold = true;
  for (size_t k = 0; k < c->equations; k++) hold &= !c->implied[k] || fabs(c->g[k]) <= implied_tolerance * size;
  if (hold) return true;
  memset(c->implied, 0, c->equations * sizeof *c->implied);
  memset(c->rests, 0, c->equations * sizeof *c->rests);
  return false;
}

/* The start of the step with all equations, and then its end again. */
static hk_status begin_anew(hk_dynamics *d, double t0, double *from, double t, double *x, double *v) {
  d->constraints->kept = false;
  hk_status status = begin(d, t0, from, from + 3 * d->state->model.n);
  if (status == HK_OK) status = hk_dynamics_impose(d, t, x, v);
  return status == HK_OK ? hk_constraint_value(d, t, x, v) : status;
}

static hk_status too_long(hk_dynamics *d, size_t equation, double left) {
  size_t number;
  const hk_instance *instance = hk_constraint_of(d, equation, &number);
  return hk_error_set(d->error, isfinite(left) ? HK_NOT_CONVERGED : HK_NOT_FINITE,
                      "%s%s%s: equation %zu cannot be met at the end of the step: %.3g m are left; shorten the step",
                      instance->where, *instance->where ? ": " : "", instance->label, number, left);
}

/* Moves x by W J^T solution and v by that over h. */
static void apply(hk_dynamics *d, double h, double *x, double *v) {
  hk_constraints *c = d->constraints;
  for (size_t b = 0; b < c->blocks; b++) {
    double s = c->solution[c->list.pair[b][0]];
    size_t at = 3 * (size_t)c->list.pair[b][1];
    for (size_t a = 0; a < 3; a++) {
      double by = s * c->WJ[b][a];
      x[at + a] += by;
      v[at + a] += by / h;
    }
  }
}

static hk_status solve_for(hk_dynamics *d, const double *q) {
  hk_constraints *c = d->constraints;
  for (size_t k = 0; k < c->equations; k++) c->rhs[k] = -q[k];
  return hk_constraint_matrix_solve(d);
}

void hk_constraints_forget(hk_dynamics *d) {
  if (d->constraints) d->constraints->kept = false;
}

hk_status hk_constraints_hold_positions(hk_system *s, double t, double *from, double h, double *x, double *v,
                                        double *work) {
  hk_dynamics *d = (hk_dynamics *)(void *)s;
  hk_constraints *c = d->constraints;
  double last = INFINITY, left = 0, size = hk_constraint_extent(c, x), done = 0;
  size_t worst = 0;
  hk_status status = begin(d, s->t, from, from + 3 * s->n);
  if (status == HK_OK) status = hk_dynamics_impose(d, t, x, v);
  for (int round = 0; round < ROUNDS && status == HK_OK; round++) {
    status = hk_constraint_value(d, t, x, v);
    left = largest_violation(c, &worst);
    if (status != HK_OK || !isfinite(left)) break;
    bool met = left <= rounding * size || (left <= good * size && left > 0.25 * last);
    if (met && consequences_hold(c, size)) {
      *work += done;
      return HK_OK;
    }
    if (met) status = begin_anew(d, s->t, from, t, x, v);
    last = met ? INFINITY : left;
    if (status == HK_OK) status = solve_for(d, c->g);
    if (status == HK_OK) apply(d, h, x, v);
    if (status == HK_OK) done += hk_constraint_power(d, from + 3 * s->n) / h;
  }
  return status == HK_OK ? too_long(d, worst, left) : status;
}

hk_status hk_constraints_hold_velocities(hk_system *s, double t, double *x, double h, double *v, double *work) {
  hk_dynamics *d = (hk_dynamics *)(void *)s;
  hk_constraints *c = d->constraints;
  hk_status status = begin(d, t, x, v);
  if (status != HK_OK) return status;
  hk_constraint_rate(c, v, c->c, c->residual);
  status = solve_for(d, c->c);
  if (status != HK_OK) return status;
  hk_constraint_matrix_move(c, v);
  *work += hk_constraint_power(d, v);
  for (size_t k = 0; k < c->equations; k++) c->lambda[k] = 2 / h * c->solution[k];
  return HK_OK;
}
