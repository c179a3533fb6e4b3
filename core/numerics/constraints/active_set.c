/* Determines which equations act. A one-sided equation acts (pushes) or is inactive (rests): the multipliers solve the
 * linear complementarity problem
 *     w = J W J^T lambda + q,   lambda >= 0,   w >= 0,   lambda w = 0,
 * by principal pivoting: solve for the equations that act, deactivate all with negative multipliers and activate all
 * that are violated; after some rounds change only the first of them, which terminates for any positive definite matrix
 * (Murty 1974; Judice and Pires 1994). */

#include "core/numerics/constraints/constraints.h"

#include <string.h>

enum { ROUNDS_OF_ALL = 10, MOST_ROUNDS = 400 };

static const double rounding = 1e-11; /* relative to the terms of a sum, after a solution with refinement */

/* moved = W J^T solution, for the particles that occur in equations. */
static void find_moved(hk_constraints *c) {
  for (size_t b = 0; b < c->blocks; b++) memset(c->moved + 3 * (size_t)c->list.pair[b][1], 0, 3 * sizeof *c->moved);
  hk_constraint_matrix_move(c, c->moved);
}

/* residual = w of every equation, correction = the sum of the magnitudes of its terms. */
static void find_slack(hk_constraints *c, const double *q) {
  find_moved(c);
  for (size_t k = 0; k < c->equations; k++) {
    c->residual[k] = q[k];
    c->correction[k] = fabs(q[k]);
  }
  for (size_t b = 0; b < c->blocks; b++) {
    const double *at = c->moved + 3 * (size_t)c->list.pair[b][1];
    c->residual[c->list.pair[b][0]] += hk_constraint_dot(c->J[b], at);
    c->correction[c->list.pair[b][0]] += sqrt(hk_constraint_dot(c->J[b], c->J[b]) * hk_constraint_dot(at, at));
  }
}

static double largest_multiplier(const hk_constraints *c) {
  double most = 0;
  for (size_t k = 0; k < c->equations; k++)
    if (c->scale[k] > 0) most = fmax(most, fabs(c->solution[k]) / c->scale[k]);
  return most;
}

/* Activates or deactivates the equations that are violated or have negative multipliers; false: there are none. */
static bool exchange(hk_constraints *c, const double *q, bool all) {
  double least = -rounding * largest_multiplier(c);
  bool any = false;
  find_slack(c, q);
  for (size_t k = 0; k < c->equations && (all || !any); k++) {
    if (!c->allowed[k] || c->held[k] || c->full[k] == 0) continue;
    bool wrong = c->rests[k] ? c->residual[k] < -rounding * c->correction[k] : c->solution[k] < least * c->scale[k];
    if (wrong) c->rests[k] = !c->rests[k];
    any |= wrong;
  }
  return any;
}

static bool some_act(const hk_constraints *c) {
  for (size_t k = 0; k < c->equations; k++)
    if (c->scale[k] > 0) return true;
  return false;
}

static hk_status solve_acting(hk_dynamics *d, const double *q, bool factorized) {
  hk_constraints *c = d->constraints;
  if (!some_act(c)) { /* a slack net has nothing to factorize */
    memset(c->solution, 0, c->equations * sizeof *c->solution);
    return HK_OK;
  }
  hk_status status = factorized ? HK_OK : hk_constraint_matrix_factorize(d);
  for (size_t k = 0; k < c->equations; k++) c->rhs[k] = -q[k];
  return status == HK_OK ? hk_constraint_matrix_solve(d) : status;
}

hk_status hk_active_set_solve(hk_dynamics *d, const double *q, bool factorized) {
  hk_constraints *c = d->constraints;
  if (c->one_sided_count == 0) return solve_acting(d, q, factorized);
  for (size_t k = 0; k < c->equations; k++)
    c->rests[k] = c->one_sided[k] ? !c->held[k] && !(c->allowed[k] && q[k] < 0) : c->implied[k];
  for (int round = 0; round < MOST_ROUNDS; round++) {
    hk_constraint_matrix_rest(c);
    hk_status status = solve_acting(d, q, false);
    if (status != HK_OK || !exchange(c, q, round < ROUNDS_OF_ALL)) return status;
  }
  return hk_error_set(d->error, HK_NOT_CONVERGED,
                      "which of %zu one-sided constraints push cannot be found in %d rounds", c->one_sided_count,
                      MOST_ROUNDS);
}
