/* Projection onto the constraints: what the stages of a method leave of g = 0 and J v + g_t = 0 is removed after every
 * step by a mass-weighted Newton iteration on the positions, and then for the velocities. g < 0 of a one-sided equation
 * is brought to 0, and an approaching velocity at a touching one is set to 0 (an inelastic impact); a contact that
 * pushed to the end of the step is projected as an equality. Hairer and Wanner, Solving ODEs II, VII.2; Moreau 1988.
 *
 * Methods that keep g = 0 and J v + g_t = 0 in their own steps ask for SHAKE's correction of positions,
 *     x += W J^T L,  J at the start of the step, with g(x, t) = 0 at its end,
 * by Newton's iteration with the matrix J W J^T of the start, whose error falls by a factor of the order of h a round
 * (where it does not, as where bars turn by half a radian in a step, with J of the last round on the left),
 * and for RATTLE's correction of velocities,
 *     v += W J^T M,  J at x, with J v + g_t = 0,
 * one linear solution. With half a kick before and after they make a symplectic and reversible map, because impulses
 * act along J^T of the ends of the step alone (Ryckaert, Ciccotti and Berendsen 1977; Andersen 1983; Leimkuhler and
 * Skeel 1994; Hairer, Lubich and Wanner, Geometric Numerical Integration, VII.1.4). Here the iteration goes on until
 * rounding: what it left would be an impulse g/h in every step, of one sign.
 *
 * Invariant: the factors for the velocities serve the next step's positions. They are a function of (x, t) alone, and
 * `kept_x` and `kept_t` say of which, so that a run that goes on from a checkpoint makes the same ones anew. */

#include "core/numerics/constraints/constraints.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

enum { ITERATIONS = 25, ROUNDS = 40, PATIENCE = 3, MOST_NAMED = 3, NAME = 96, REST = 800 };

/* Of positions relative to the largest coordinate, which determines their rounding; of velocities to the sum of |J||v|,
 * or to the rounding of the largest. A round that leaves more than `slow` calls for new factors. An equation at a small
 * angle to others, from which it follows, is solved for where it is violated by more than `implied_tolerance`. */
static const double position_tolerance = 1e-12, velocity_tolerance = 1e-13, slow = 0.1, implied_tolerance = 1e-7;
static const double to_be_named = 0.01; /* part of the largest violation */
/* A round of the iteration with the matrix of the start that leaves more than this part of g is slow; after PATIENCE of
 * them every round has its own matrix. */
static const double tardy = 0.5;
static const double rounding = 4 * DBL_EPSILON; /* of a length, relative to the largest coordinate */
/* A round with the matrix of the start leaves about the same part of g each time: one after which a tenth of the
 * rounding would be left is the last, without another look. */
static const double foreseen = 0.1;

/* The violation of an equation. */
static double broken(const hk_constraints *c, size_t k) {
  return c->one_sided[k] && !c->held[k] && c->g[k] > 0 ? 0 : fabs(c->g[k]);
}

/* The equation with the largest violation; NaN counts as the largest. With `movable`, equations without movable
 * particles and those that follow from others are skipped. */
static size_t worst_of(const hk_constraints *c, bool movable) {
  size_t worst = SIZE_MAX;
  for (size_t k = 0; k < c->equations; k++) {
    if (movable && (c->full[k] == 0 || c->implied[k])) continue;
    if (worst == SIZE_MAX || !(broken(c, k) <= broken(c, worst))) worst = k;
    if (isnan(c->g[k])) break;
  }
  return worst;
}

/* Appends what else is left of g, beside `equation`: at the point that Newton's iteration ends at, constraints that
 * contradict each other share what is missing. */
static void name_others(const hk_dynamics *d, size_t equation, char *text, size_t size) {
  const hk_constraints *c = d->constraints;
  size_t at = 0, named = 0;
  *text = 0;
  for (size_t k = 0; k < c->equations && named < MOST_NAMED && at < size; k++) {
    char name[NAME];
    size_t number;
    if (k == equation || !(broken(c, k) > to_be_named * broken(c, equation))) continue;
    hk_constraint_name(d, k, name, sizeof name);
    at += (size_t)snprintf(text + at, size - at, "%s%s %s: %.3g m", named++ ? ", " : " Beside it ",
                           hk_constraint_of(d, k, &number)->label, name, c->g[k]);
  }
}

static hk_status refuse(hk_dynamics *d, size_t equation, double left, const char *what, const char *rest) {
  char name[NAME];
  size_t number;
  const hk_instance *instance = hk_constraint_of(d, equation, &number);
  hk_constraint_name(d, equation, name, sizeof name);
  return hk_error_set(d->error, isfinite(left) ? HK_NOT_CONVERGED : HK_NOT_FINITE, "%s%s%s: %s%s%s", instance->where,
                      *instance->where ? ": " : "", instance->label, what, name, rest);
}

static hk_status gave_up(hk_dynamics *d, size_t equation, bool position, double left) {
  char rest[REST], others[REST / 2] = "", doubt[REST / 4];
  if (position && isfinite(left)) name_others(d, equation, others, sizeof others);
  snprintf(rest, sizeof rest, " cannot be brought onto the constraint: %.3g %s are left; %s%s", left,
           position ? "m" : "m/s", hk_constraint_doubt(d, equation, doubt, sizeof doubt), others);
  return refuse(d, equation, left, position ? "the position of " : "the velocity of ", rest);
}

/* Equations whose particles nothing can move, such as a bar between two pins, have to hold by themselves. */
static hk_status check_immovable(hk_dynamics *d, double size) {
  const hk_constraints *c = d->constraints;
  for (size_t k = 0; k < c->equations; k++) {
    if (c->full[k] > 0 || c->one_sided[k] || !(broken(c, k) > implied_tolerance * size)) continue;
    char rest[REST];
    snprintf(rest, sizeof rest,
             " does not hold, by %.3g m, and pins keep its particles from moving: it contradicts them", c->g[k]);
    return refuse(d, k, c->g[k], "", rest);
  }
  return HK_OK;
}

static hk_status renew(hk_dynamics *d, double t, const double *x, const double *v, bool *factorized) {
  hk_status status = hk_constraint_matrix_linearise(d, t, x, v);
  *factorized = true;
  if (d->constraints->one_sided_count) return status; /* hk_active_set_solve factorizes instead */
  return status == HK_OK ? hk_constraint_matrix_factorize(d) : status;
}

static bool implied_hold(const hk_constraints *c, double size) {
  bool hold = true;
  for (size_t k = 0; k < c->equations; k++) hold &= !c->implied[k] || fabs(c->g[k]) <= implied_tolerance * size;
  return hold;
}

/* Equations that follow from others normally hold because those do. If not, all equations are solved for together. */
static bool consequences_hold(hk_constraints *c, double size) {
  if (implied_hold(c, size)) return true;
  memset(c->implied, 0, c->equations * sizeof *c->implied);
  memcpy(c->rests, c->one_sided, c->equations * sizeof *c->rests);
  return false;
}

/* A one-sided equation that was violated is from now on projected as an equality, so that it ends at 0 and not beyond,
 * as J turns. */
static void hold_lifted(hk_constraints *c) {
  for (size_t k = 0; k < c->equations; k++)
    if (c->one_sided[k] && c->solution[k] > 0) c->held[k] = true;
}

/* x -= W J^T (J W J^T)^-1 g until g is zero up to rounding. J of the first round is kept while the error falls fast. */
static hk_status project_positions(hk_dynamics *d, double t, double *x, const double *v, bool *factorized) {
  hk_constraints *c = d->constraints;
  double size = hk_constraint_extent(c, x), tolerance = position_tolerance * size, last = INFINITY;
  size_t worst = SIZE_MAX;
  hk_status status = hk_constraint_matrix_linearise(d, t, x, v);
  for (int round = 0; round < ITERATIONS && status == HK_OK; round++) {
    status = hk_constraint_value(d, t, x, v);
    if (status != HK_OK) return status;
    worst = worst_of(c, true);
    double left = worst == SIZE_MAX ? 0 : broken(c, worst);
    if (left <= tolerance) {
      if (consequences_hold(c, size)) return check_immovable(d, size);
      last = 0;
    }
    if (!isfinite(left)) break;
    if (round == 0 || left > slow * last || c->one_sided_count) status = renew(d, t, x, v, factorized);
    last = left;
    if (status == HK_OK) status = hk_active_set_solve(d, c->g, true);
    if (status == HK_OK) hk_constraint_matrix_move(c, x);
    if (status == HK_OK) hold_lifted(c);
  }
  return status == HK_OK ? gave_up(d, worst, true, c->g[worst]) : status;
}

/* c->c = J v + g_t, less what it is after an impact; returns the largest part that must be removed, relative to the sum
 * of |J||v|, and its equation. */
static double velocity_residual(hk_constraints *c, const double *v, size_t *worst) {
  double largest = 0, most = 0, *sum = c->residual;
  hk_constraint_rate(c, v, c->c, sum);
  for (size_t k = 0; k < c->equations; k++) most = fmax(most, DBL_EPSILON * sum[k]);
  hk_restitution_subtract(c, c->c);
  for (size_t k = 0; k < c->equations; k++) {
    bool asked = c->one_sided[k] ? c->held[k] || (c->allowed[k] && c->c[k] < 0) : !c->implied[k];
    double relative = asked && c->full[k] > 0 && sum[k] > 0 ? fabs(c->c[k]) / fmax(sum[k], most) : 0;
    if (relative <= largest) continue;
    largest = relative;
    *worst = k;
    if (isnan(relative)) break;
  }
  return largest;
}

static bool strikes(const hk_constraints *c) {
  for (size_t k = 0; k < c->equations; k++)
    if (c->one_sided[k] && !c->held[k] && c->solution[k] > 0) return true;
  return false;
}

/* v -= W J^T (J W J^T)^-1 (J v + g_t), J at the new positions; the factors may be those of nearby positions. */
static hk_status project_velocities(hk_dynamics *d, double t, const double *x, double *v, bool factorized) {
  hk_constraints *c = d->constraints;
  double last = INFINITY, left = 0;
  size_t worst = 0;
  hk_status status = hk_constraint_matrix_linearise(d, t, x, v);
  if (status == HK_OK) status = hk_constraint_speed(d, t, x, v);
  if (status == HK_OK && c->one_sided_count) hk_restitution_begin(c, x, v);
  for (int round = 0; round < ITERATIONS && status == HK_OK; round++) {
    double relative = velocity_residual(c, v, &worst);
    if (relative <= velocity_tolerance) return HK_OK;
    left = c->c[worst];
    if (!isfinite(relative)) break;
    if (!factorized || relative > slow * last) status = renew(d, t, x, v, &factorized);
    last = relative;
    if (status == HK_OK) status = hk_active_set_solve(d, c->c, true);
    if (status != HK_OK) return status;
    hk_constraint_matrix_move(c, v);
    c->struck |= strikes(c);
  }
  return status == HK_OK ? gave_up(d, worst, false, left) : status;
}

/* Equations that pushed to the end of the step are equalities in its projection. */
static void hold_pushing(hk_constraints *c) {
  for (size_t k = 0; k < c->equations; k++) c->held[k] = c->touches[k] && c->pushes[k];
}

static hk_status project(hk_dynamics *d, double t, double *x, double *v) {
  hk_constraints *c = d->constraints;
  bool factorized = false;
  hold_pushing(c);
  for (size_t k = 0; k < c->equations && c->meets; k++) c->held[k] |= c->met[k];
  c->meets = false;
  memcpy(c->allowed, c->one_sided, c->equations * sizeof *c->allowed);
  hk_status status = project_positions(d, t, x, v, &factorized);
  hold_pushing(c);
  if (c->one_sided_count) hk_release_end(c);
  memset(c->pushes, 0, c->equations * sizeof *c->pushes);
  return status == HK_OK ? project_velocities(d, t, x, v, factorized) : status;
}

static bool sinks(const hk_constraints *c) {
  for (size_t k = 0; k < c->equations; k++)
    if (c->one_sided[k] && !(c->touches[k] && c->pushes[k]) && c->g[k] < 0) return true;
  return false;
}

/* The change of energy by an impact, and by lifting particles that penetrated before contact was detected, counts as
 * work done on the scene: kinetic energy where velocities jumped, potential energy where positions did. */
static hk_status project_with_contacts(hk_dynamics *d, double t, double *x, double *v) {
  hk_state *s = d->state;
  hk_constraints *c = d->constraints;
  hk_status status = hk_constraint_value(d, t, x, v);
  if (status != HK_OK) return status;
  bool counts = x == s->X, lifted = counts && (c->meets || sinks(c));
  double kinetic = counts ? hk_state_kinetic(s, x) : 0, potential = lifted ? hk_query_potential(d, t, x) : 0;
  c->jumped = c->struck = false;
  status = project(d, t, x, v);
  c->jumped |= c->struck;
  if (status == HK_OK) status = hk_constraint_find_contacts(d, t, x, v);
  if (status != HK_OK || !counts) return status;
  if (c->struck) s->X[s->size - 1] += hk_state_kinetic(s, x) - kinetic;
  if (lifted) s->X[s->size - 1] += hk_query_potential(d, t, x) - potential;
  return HK_OK;
}

hk_status hk_constraints_project(hk_dynamics *d, double t, double *x, double *v) {
  if (d->constraints->equations == 0) return HK_OK;
  hk_status status = d->has_timed && t != d->timed_at ? hk_dynamics_impose(d, t, x, v) : HK_OK;
  if (status != HK_OK) return status;
  return d->constraints->one_sided_count ? project_with_contacts(d, t, x, v) : project(d, t, x, v);
}

hk_status hk_constraints_project_equalities(hk_system *s, double t, double *x, double *v) {
  hk_dynamics *d = (hk_dynamics *)(void *)s;
  if (!d->constraints || d->constraints->one_sided_count) return HK_OK;
  return hk_constraints_project(d, t, x, v);
}

hk_status hk_constraints_violation(hk_dynamics *d, double *violation) {
  hk_constraints *c = d->constraints;
  double t = d->system.t, *x = d->state->X, *v = x + 3 * d->state->model.n;
  *violation = 0;
  if (!c || c->equations == 0) return HK_OK;
  hk_status status = d->has_timed && t != d->timed_at ? hk_dynamics_impose(d, t, x, v) : HK_OK;
  if (status == HK_OK) status = hk_constraint_value(d, t, x, v);
  if (status != HK_OK) return status;
  memset(c->held, 0, c->equations * sizeof *c->held);
  *violation = broken(c, worst_of(c, false));
  return HK_OK;
}

/* ---- within a step ---- */

static hk_status linearise(hk_dynamics *d, double t, const double *x, const double *v) {
  hk_constraints *c = d->constraints;
  for (size_t k = 0; k < c->equations; k++) c->rests[k] = c->one_sided[k] || c->implied[k];
  hk_status status = hk_constraint_matrix_linearise(d, t, x, v); /* nothing is kept any more */
  if (status == HK_OK) status = hk_constraint_speed(d, t, x, v);
  if (status == HK_OK) status = hk_constraint_matrix_factorize(d);
  if (status != HK_OK) return status;
  memcpy(c->kept_x, x, 3 * d->state->model.n * sizeof *x);
  c->kept_t = t;
  c->kept = true;
  return HK_OK;
}

/* Makes J, A and its factors those of x and t. Pins are imposed each time, which rounds x, as in a run that goes on. */
static hk_status begin(hk_dynamics *d, double t, double *x, double *v) {
  const hk_constraints *c = d->constraints;
  hk_status status = hk_dynamics_impose(d, t, x, v);
  bool same = c->kept && c->kept_t == t && memcmp(c->kept_x, x, 3 * d->state->model.n * sizeof *x) == 0;
  return status == HK_OK && !same ? linearise(d, t, x, v) : status;
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

/* The start of the step with all equations, and then its end again. */
static hk_status begin_anew(hk_dynamics *d, double t0, double *from, double t, double *x, double *v) {
  d->constraints->kept = false;
  hk_status status = begin(d, t0, from, from + 3 * d->state->model.n);
  if (status == HK_OK) status = hk_dynamics_impose(d, t, x, v);
  return status == HK_OK ? hk_constraint_value(d, t, x, v) : status;
}

static hk_status solve_for(hk_dynamics *d, const double *q) {
  hk_constraints *c = d->constraints;
  for (size_t k = 0; k < c->equations; k++) c->rhs[k] = -q[k];
  return hk_constraint_matrix_solve(d);
}

/* A round adds to x, and to v over h all rounds together, at the end. */
static hk_status shake_round(hk_dynamics *d, double t, double *x, const double *v, bool anew) {
  hk_constraints *c = d->constraints;
  hk_status status = anew ? hk_constraint_matrix_newton(d, t, x, v) : solve_for(d, c->g);
  if (status != HK_OK) return status;
  hk_constraint_matrix_push(c, c->solution, 1, x);
  for (size_t k = 0; k < c->equations; k++) c->impulse[k] += c->solution[k];
  return HK_OK;
}

static hk_status shake(hk_dynamics *d, double t0, double *from, double t, double h, double *x, double *v,
                       double *work) {
  const hk_system *s = &d->system;
  hk_constraints *c = d->constraints;
  if (c->groups && hk_rigid_groups_shake(d, t0, from, t, h, x, v)) return HK_OK;
  double last = INFINITY, left = 0, size = hk_constraint_extent(c, x), done = 0;
  size_t worst = 0;
  int slowly = 0;
  bool arrived = false;
  memset(c->impulse, 0, c->equations * sizeof *c->impulse);
  hk_status status = begin(d, t0, from, from + 3 * s->n);
  if (status == HK_OK) status = hk_dynamics_impose(d, t, x, v);
  for (int round = 0; round < ROUNDS && status == HK_OK && !arrived; round++) {
    status = hk_constraint_value(d, t, x, v);
    left = largest_violation(c, &worst);
    if (status != HK_OK || !isfinite(left)) break;
    bool met = left <= rounding * size || (left <= position_tolerance * size && left > 0.25 * last);
    arrived = met && consequences_hold(c, size);
    if (arrived) break;
    if (met) status = begin_anew(d, t0, from, t, x, v);
    slowly = met ? 0 : slowly + (left > tardy * last);
    arrived = !met && isfinite(last) && left / last * left <= foreseen * rounding * size && implied_hold(c, size);
    last = met ? INFINITY : left;
    if (status == HK_OK) status = shake_round(d, t, x, v, slowly >= PATIENCE);
    if (status == HK_OK) done += hk_constraint_power(d, from + 3 * s->n) / h;
  }
  if (status == HK_NOT_CONVERGED && !*d->error->text) status = HK_OK; /* Newton's matrix is singular */
  if (status == HK_OK && !arrived) return gave_up(d, worst, true, c->g[worst]);
  if (status != HK_OK) return status;
  hk_constraint_matrix_push(c, c->impulse, 1 / h, v);
  *work += done;
  return check_immovable(d, size);
}

hk_status hk_constraints_shake_from(hk_system *s, double t_from, double *from, double t, double h, double *x, double *v,
                                    double *work) {
  hk_dynamics *d = (hk_dynamics *)(void *)s;
  double start = hk_constraint_sampled(d) ? hk_clock() : 0;
  hk_status status = shake(d, t_from, from, t, h, x, v, work);
  hk_constraint_account(d, start, false);
  return status;
}

hk_status hk_constraints_shake(hk_system *s, double t, double *from, double h, double *x, double *v, double *work) {
  return hk_constraints_shake_from(s, s->t, from, t, h, x, v, work);
}

static hk_status rattle(hk_dynamics *d, double t, double *x, double h, double *v, double *work) {
  hk_constraints *c = d->constraints;
  if (c->groups && hk_rigid_groups_rattle(d, t, x, h, v)) return HK_OK;
  hk_status status = begin(d, t, x, v);
  if (status != HK_OK) return status;
  hk_constraint_rate(c, v, c->c, NULL);
  status = solve_for(d, c->c);
  if (status != HK_OK) return status;
  hk_constraint_matrix_move(c, v);
  *work += hk_constraint_power(d, v);
  for (size_t k = 0; k < c->equations; k++) c->lambda[k] = 2 / h * c->solution[k];
  return HK_OK;
}

hk_status hk_constraints_rattle(hk_system *s, double t, double *x, double h, double *v, double *work) {
  hk_dynamics *d = (hk_dynamics *)(void *)s;
  double start = hk_constraint_sampled(d) ? hk_clock() : 0;
  hk_status status = rattle(d, t, x, h, v, work);
  hk_constraint_account(d, start, true);
  return status;
}
