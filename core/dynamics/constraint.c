/* Constraints g(x, t) = 0 or g(x, t) >= 0 by multipliers, all constraints of a scene at once. Differentiating twice
 * gives J a + c = 0, so that with a = W (F + J^T lambda) the multipliers solve (J W J^T) lambda = -(J W F + c): the
 * index is reduced from 3 to 1. The remaining drift away from g = 0 and J v + g_t = 0 is removed after every step: by a
 * mass-weighted Newton iteration on the positions, and then for the velocities. W holds the inverse masses and includes
 * the pins (constraint_matrix.c). Scripted particles enter by their position, velocity and acceleration, the last from
 * differences of the path, so that a method keeps its order on moving pins.
 *
 * A one-sided equation may push during a step when, at the state at the start of the step, it held with equality and
 * was not opening. The signs of the multipliers decide in every evaluation which of these equations do push
 * (active_set.c). So the set of acting equations is a function of that state and of t, x, v, and stages that violate g
 * = 0 or J v = 0 by their error do not lose a contact. After the step g < 0 is brought to 0, and an approaching
 * velocity at a touching equation is set to 0 (an inelastic impact); a contact that pushed to the end of the step is
 * projected as an equality.
 *
 * Invariant: no factorization is kept from one evaluation to the next, so a resumed run repeats bit by bit. Witkin,
 * Physically based modeling: constrained dynamics (SIGGRAPH course notes); Hairer and Wanner, Solving ODEs II, VII.1
 * and VII.2 (index reduction, projection); Moreau 1988 (unilateral contact, inelastic impact). */
#include "core/dynamics/constraint_matrix.h"

#include <stdlib.h>
#include <string.h>

enum { ITERATIONS = 25, SAMPLE = 64 };

/* Tolerance of positions: relative to the largest coordinate, which determines their rounding. Of velocities: relative
 * to the sum of |J||v|. After a round that leaves more than `slow` of the residual a new factorization is made. */
static const double position_tolerance = 1e-12, velocity_tolerance = 1e-13, slow = 0.1;
/* `touching`: largest g that counts as contact, relative to the largest coordinate. `opening`: largest rate that counts
 * as not opening, relative to the sum of |J||v| plus the largest coordinate per second, since the speed of a resting
 * contact is only rounding. Both may be generous, because an equation in contact acts only while it pushes.
 * `implied_tolerance`: largest violation of an equation that follows from others before it is solved for: 1e5 times
 * position_tolerance, for equations at a small angle to each other. */
static const double touching = 1e-10, opening = 1e-9, implied_tolerance = 1e-7;

/* ---- calls of the plugins ---- */

typedef enum quantity { VALUE, CURVATURE, SPEED } quantity;

static hk_status ask(hk_dynamics *d, quantity what, double t, const double *x, const double *v, double *out) {
  hk_constraints *c = d->constraints;
  hk_status status = HK_OK;
  for (size_t k = 0; k < d->plugins->kind[HK_CONSTRAINT].count && status == HK_OK; k++) {
    const hk_instance *instance = d->plugins->kind[HK_CONSTRAINT].item[k];
    const hk_constraint *functions = instance->plugin->constraint;
    hk_status (*function)(void *, const hk_view *, double *) = what == VALUE       ? functions->value
                                                               : what == CURVATURE ? functions->curvature
                                                                                   : functions->speed;
    hk_view view = hk_constraint_view(d, instance, t, x, v);
    const hk_instance *outer = hk_enter(instance);
    if (function) status = function(instance->self, &view, out + c->equation_first[k]);
    hk_leave(instance, outer);
    status = hk_constraint_failed(d, instance, t, status);
  }
  return status;
}

static hk_status evaluate(hk_dynamics *d, double t, const double *x, const double *v) {
  return ask(d, VALUE, t, x, v, d->constraints->g);
}

static hk_status find_speed(hk_dynamics *d, double t, const double *x, const double *v) {
  return d->constraints->has_speed ? ask(d, SPEED, t, x, v, d->constraints->speed) : HK_OK;
}

/* ---- opening, and changes between steps ---- */

static double extent(const hk_constraints *c, const double *x) {
  double largest = 0;
  for (size_t b = 0; b < c->blocks; b++)
    for (int a = 0; a < 3; a++) largest = fmax(largest, fabs(x[3 * (size_t)c->list.pair[b][1] + a]));
  return largest;
}

/* rate = J v + g_t, sum = the sum of the magnitudes of its terms. */
static void find_rate(hk_constraints *c, const double *v, double *rate, double *sum) {
  for (size_t k = 0; k < c->equations; k++) {
    rate[k] = c->speed[k];
    sum[k] = fabs(c->speed[k]);
  }
  for (size_t b = 0; b < c->blocks; b++) {
    const double *here = v + 3 * (size_t)c->list.pair[b][1];
    uint32_t k = c->list.pair[b][0];
    rate[k] += hk_constraint_dot(c->J[b], here);
    sum[k] += sqrt(hk_constraint_dot(c->J[b], c->J[b]) * hk_constraint_dot(here, here));
  }
}

/* Finds the one-sided equations in contact; the equations are linearised, and g and `speed` are evaluated. */
static void find_contacts(hk_dynamics *d, const double *x, const double *v) {
  hk_constraints *c = d->constraints;
  double size = extent(c, x), near = touching * size;
  find_rate(c, v, c->residual, c->correction);
  for (size_t k = 0; k < c->equations; k++) {
    bool touches = c->one_sided[k] && c->g[k] <= near && c->residual[k] <= opening * (c->correction[k] + size);
    c->jumped |= touches != c->touches[k];
    c->touches[k] = touches;
  }
}

static hk_status look_at_contacts(hk_dynamics *d, double t, const double *x, const double *v) {
  if (d->constraints->one_sided_count == 0) return HK_OK;
  hk_status status = hk_constraint_matrix_linearise(d, t, x, v);
  if (status == HK_OK) status = evaluate(d, t, x, v);
  if (status == HK_OK) status = find_speed(d, t, x, v);
  if (status == HK_OK) find_contacts(d, x, v);
  return status;
}

hk_status hk_constraints_review(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  double t = d->system.t, *x = d->state->X, *v = x + 3 * d->state->model.n;
  if (!c || c->equations == 0) return HK_OK;
  hk_status status = hk_constraint_matrix_linearise(d, t, x, v);
  if (status == HK_OK) status = hk_constraint_matrix_review(d);
  if (status != HK_OK) return status;
  memcpy(c->rests, c->implied, c->equations * sizeof *c->rests);
  return look_at_contacts(d, t, x, v);
}

hk_status hk_constraints_open(hk_dynamics *d) {
  if (d->plugins->kind[HK_CONSTRAINT].count == 0) return HK_OK;
  d->constraints = calloc(1, sizeof *d->constraints);
  if (!d->constraints) return hk_error_set(d->error, HK_NO_MEMORY, "no memory for the constraints");
  /* The constraints have a solver instance of their own: the scene's solver keeps the factors of an implicit method
   * between evaluations. */
  hk_linear_system *linear = &d->constraints->linear;
  hk_status status = hk_solver_twins(d, linear);
  return status == HK_OK ? hk_constraint_matrix_build(d) : status;
}

hk_status hk_constraints_topology(hk_dynamics *d) {
  if (!d->constraints) return HK_OK;
  hk_status status = hk_constraint_matrix_build(d);
  return status == HK_OK ? hk_constraints_review(d) : status;
}

static hk_status update_one(hk_dynamics *d, const hk_instance *instance, bool *any) {
  bool changed = false;
  if (!instance->plugin->constraint->update) return HK_OK;
  hk_view view = hk_instance_view(instance, &d->state->view);
  const hk_instance *outer = hk_enter(instance);
  hk_status status = instance->plugin->constraint->update(instance->self, &view, &changed);
  hk_leave(instance, outer);
  *any |= changed;
  return hk_constraint_failed(d, instance, view.t, status);
}

hk_status hk_constraints_update(hk_dynamics *d) {
  bool any = false;
  hk_status status = HK_OK;
  for (size_t k = 0; k < d->plugins->kind[HK_CONSTRAINT].count && status == HK_OK; k++)
    status = update_one(d, d->plugins->kind[HK_CONSTRAINT].item[k], &any);
  if (status != HK_OK) return status;
  if (!any) return look_at_contacts(d, d->system.t, d->state->X, d->state->X + 3 * d->state->model.n);
  d->constraints->jumped = true;
  hk_jacobian_topology(d);
  return hk_constraints_topology(d);
}

bool hk_constraints_jumped(hk_dynamics *d) {
  bool jumped = d->constraints && d->constraints->jumped;
  if (jumped) d->constraints->jumped = false;
  return jumped;
}

void hk_constraints_close(hk_dynamics *d) {
  hk_saddle_point_close(d);
  if (!d->constraints) return;
  hk_constraint_matrix_free(d->constraints);
  hk_instance_destroy(d->constraints->linear.any);
  hk_instance_destroy(d->constraints->linear.special);
  free(d->constraints);
  d->constraints = NULL;
}

/* ---- accelerations ---- */

static hk_status find_path_accelerations(hk_dynamics *d, double t) {
  hk_constraints *c = d->constraints;
  hk_status status = HK_OK;
  for (size_t k = 0; k < d->pins->count && status == HK_OK; k++) {
    hk_pin_state *pin = &d->pins->item[k];
    if (pin->spec->kind == HK_PIN_PATH && !pin->released && c->path_used[k])
      status = hk_path_acceleration(&pin->path, t, c->path[k], d->error);
  }
  return status;
}

/* The power of constraint forces whose equations depend on time, -lambda g_t. */
static double power_of(const hk_constraints *c) {
  double power = 0;
  for (size_t k = 0; k < c->equations; k++) power -= c->solution[k] * c->speed[k];
  return power;
}

static void note_acting(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  size_t acting = 0;
  for (size_t k = 0; k < c->equations; k++) {
    acting += c->scale[k] > 0;
    c->pushes[k] = c->one_sided[k] && !c->rests[k] && c->solution[k] > 0;
  }
  memcpy(c->lambda, c->solution, c->equations * sizeof *c->lambda);
  d->system.equations = acting;
}

/* c->c = c + J a, where a excludes constraint forces. */
static hk_status find_free_acceleration(hk_dynamics *d, double t, const double *x, const double *v, const double *a) {
  hk_constraints *c = d->constraints;
  hk_status status = ask(d, CURVATURE, t, x, v, c->c);
  for (size_t b = 0; b < c->blocks; b++) {
    uint32_t i = c->list.pair[b][1];
    c->c[c->list.pair[b][0]] +=
        hk_constraint_dot(c->J[b], d->state->pin[i] == HK_PIN_PATH ? c->path[c->pin[b]] : a + 3 * (size_t)i);
  }
  return status;
}

static hk_status accelerate(hk_dynamics *d, double t, const double *x, const double *v, double *a, double *power) {
  hk_constraints *c = d->constraints;
  hk_status status = d->pins->has_paths ? find_path_accelerations(d, t) : HK_OK;
  if (status == HK_OK) status = hk_constraint_matrix_linearise(d, t, x, v);
  if (status == HK_OK) status = find_free_acceleration(d, t, x, v, a);
  if (status == HK_OK) status = find_speed(d, t, x, v);
  if (status != HK_OK) return status;
  for (size_t k = 0; k < c->equations; k++) c->allowed[k] = c->touches[k];
  memset(c->held, 0, c->equations * sizeof *c->held);
  status = hk_active_set_solve(d, c->c, false);
  if (status != HK_OK) return status;
  hk_constraint_matrix_move(c, a);
  note_acting(d);
  if (c->has_speed) *power += power_of(c);
  return HK_OK;
}

/* Distributes the computing time among the constraints by their share of the equations. */
static void account(hk_dynamics *d, double seconds) {
  for (size_t k = 0; k < d->plugins->kind[HK_CONSTRAINT].count; k++) {
    const hk_constraints *c = d->constraints;
    hk_instance *instance = d->plugins->kind[HK_CONSTRAINT].item[k];
    instance->seconds += seconds * (double)(c->equation_first[k + 1] - c->equation_first[k]) / (double)c->equations;
    instance->sampled++;
  }
}

hk_status hk_constraints_accelerate(hk_dynamics *d, double t, const double *x, const double *v, double *a,
                                    double *power) {
  if (d->constraints->equations == 0) return HK_OK;
  bool sample = d->plugins->kind[HK_CONSTRAINT].item[0]->calls % SAMPLE == 0;
  double begin = sample ? hk_clock() : 0;
  hk_status status = accelerate(d, t, x, v, a, power);
  for (size_t k = 0; k < d->plugins->kind[HK_CONSTRAINT].count; k++) d->plugins->kind[HK_CONSTRAINT].item[k]->calls++;
  if (sample) account(d, hk_clock() - begin);
  return status;
}

/* ---- projection ---- */

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

static hk_status gave_up(hk_dynamics *d, size_t equation, const char *what, double left, const char *unit) {
  size_t number;
  const hk_instance *instance = hk_constraint_of(d, equation, &number);
  return hk_error_set(d->error, isfinite(left) ? HK_NOT_CONVERGED : HK_NOT_FINITE,
                      "%s%s%s: the %s of equation %zu cannot be brought onto the constraint: %.3g %s are left; do "
                      "constraints contradict each other?",
                      instance->where, *instance->where ? ": " : "", instance->label, what, number, left, unit);
}

static hk_status renew(hk_dynamics *d, double t, const double *x, const double *v, bool *factorized) {
  hk_status status = hk_constraint_matrix_linearise(d, t, x, v);
  *factorized = true;
  if (d->constraints->one_sided_count) return status; /* hk_active_set_solve factorizes instead */
  return status == HK_OK ? hk_constraint_matrix_factorize(d) : status;
}

/* Equations that follow from others normally hold because those do. If not, all equations are solved for together. */
static bool consequences_hold(hk_constraints *c, double size) {
  bool hold = true;
  for (size_t k = 0; k < c->equations; k++) hold &= !c->implied[k] || fabs(c->g[k]) <= implied_tolerance * size;
  if (hold) return true;
  memset(c->implied, 0, c->equations * sizeof *c->implied);
  memset(c->rests, 0, c->equations * sizeof *c->rests);
  return false;
}

/* A one-sided equation that was violated is from now on projected as an equality, so that it ends at 0 and not beyond,
 * as J turns. */
static void hold_what_is_lifted(hk_constraints *c) {
  for (size_t k = 0; k < c->equations; k++)
    if (c->one_sided[k] && c->solution[k] > 0) c->held[k] = true;
}

/* x -= W J^T (J W J^T)^-1 g until g is zero up to rounding. J of the first round is kept while the error falls fast. */
static hk_status project_positions(hk_dynamics *d, double t, double *x, const double *v, bool *factorized) {
  hk_constraints *c = d->constraints;
  double size = extent(c, x), tolerance = position_tolerance * size, last = INFINITY;
  size_t worst = SIZE_MAX;
  hk_status status = hk_constraint_matrix_linearise(d, t, x, v);
  for (int round = 0; round < ITERATIONS && status == HK_OK; round++) {
    status = evaluate(d, t, x, v);
    if (status != HK_OK) return status;
    worst = worst_of(c, true);
    double left = worst == SIZE_MAX ? 0 : broken(c, worst);
    if (left <= tolerance) {
      if (consequences_hold(c, size)) return HK_OK;
      last = 0;
    }
    if (!isfinite(left)) break;
    if (round == 0 || left > slow * last || c->one_sided_count) status = renew(d, t, x, v, factorized);
    last = left;
    if (status == HK_OK) status = hk_active_set_solve(d, c->g, true);
    if (status == HK_OK) hk_constraint_matrix_move(c, x);
    if (status == HK_OK) hold_what_is_lifted(c);
  }
  return status == HK_OK ? gave_up(d, worst, "position", c->g[worst], "m") : status;
}

/* c->c = J v + g_t; returns the largest part that must be removed, relative to the sum of |J||v|, and its equation. */
static double velocity_residual(hk_constraints *c, const double *v, size_t *worst) {
  double largest = 0, *sum = c->residual;
  find_rate(c, v, c->c, sum);
  for (size_t k = 0; k < c->equations; k++) {
    bool asked = c->one_sided[k] ? c->held[k] || (c->allowed[k] && c->c[k] < 0) : !c->implied[k];
    double relative = asked && c->full[k] > 0 && sum[k] > 0 ? fabs(c->c[k]) / sum[k] : 0;
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
  if (status == HK_OK) status = find_speed(d, t, x, v);
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
    c->jumped |= strikes(c);
  }
  return status == HK_OK ? gave_up(d, worst, "velocity", left, "m/s") : status;
}

/* Equations that pushed to the end of the step are equalities in its projection. */
static void hold_what_pushes(hk_constraints *c) {
  for (size_t k = 0; k < c->equations; k++) c->held[k] = c->touches[k] && c->pushes[k];
}

static hk_status project(hk_dynamics *d, double t, double *x, double *v) {
  hk_constraints *c = d->constraints;
  bool factorized = false;
  hold_what_pushes(c);
  memcpy(c->allowed, c->one_sided, c->equations * sizeof *c->allowed);
  hk_status status = project_positions(d, t, x, v, &factorized);
  double near = touching * extent(c, x);
  hold_what_pushes(c);
  for (size_t k = 0; k < c->equations; k++) c->allowed[k] = c->one_sided[k] && c->g[k] <= near;
  memset(c->pushes, 0, c->equations * sizeof *c->pushes);
  return status == HK_OK ? project_velocities(d, t, x, v, factorized) : status;
}

static double energy_of(hk_dynamics *d, double t) {
  return hk_state_kinetic(d->state, d->state->X) + hk_probe_potential(d, t, d->state->X);
}

static bool sinks(const hk_constraints *c) {
  for (size_t k = 0; k < c->equations; k++)
    if (c->one_sided[k] && !(c->touches[k] && c->pushes[k]) && c->g[k] < 0) return true;
  return false;
}

/* The change of energy by an impact, and by lifting particles that penetrated before contact was detected, counts as
 * work done on the scene. */
static hk_status project_with_contacts(hk_dynamics *d, double t, double *x, double *v) {
  hk_state *s = d->state;
  hk_status status = evaluate(d, t, x, v);
  if (status != HK_OK) return status;
  bool impact = x == s->X && sinks(d->constraints);
  double before = impact ? energy_of(d, t) : 0;
  d->constraints->jumped = false;
  status = project(d, t, x, v);
  if (status == HK_OK) status = look_at_contacts(d, t, x, v);
  if (status == HK_OK && impact) s->X[s->size - 1] += energy_of(d, t) - before;
  return status;
}

hk_status hk_constraints_project(hk_dynamics *d, double t, double *x, double *v) {
  if (d->constraints->equations == 0) return HK_OK;
  hk_status status = d->has_timed && t != d->timed_at ? hk_dynamics_impose(d, t, x, v) : HK_OK;
  if (status != HK_OK) return status;
  return d->constraints->one_sided_count ? project_with_contacts(d, t, x, v) : project(d, t, x, v);
}

hk_status hk_constraints_project_equalities(hk_dynamics *d, double t, double *x, double *v) {
  if (!d->constraints || d->constraints->one_sided_count) return HK_OK;
  return hk_constraints_project(d, t, x, v);
}

hk_status hk_constraints_violation(hk_dynamics *d, double *violation) {
  hk_constraints *c = d->constraints;
  double t = d->system.t, *x = d->state->X, *v = x + 3 * d->state->model.n;
  *violation = 0;
  if (!c || c->equations == 0) return HK_OK;
  hk_status status = d->has_timed && t != d->timed_at ? hk_dynamics_impose(d, t, x, v) : HK_OK;
  if (status == HK_OK) status = evaluate(d, t, x, v);
  if (status != HK_OK) return status;
  memset(c->held, 0, c->equations * sizeof *c->held);
  *violation = broken(c, worst_of(c, false));
  return HK_OK;
}
