/* Constraints g(x) = 0 by multipliers, all of a scene at once. Differentiating twice gives J a + c = 0, c = (dJ/dt) v,
 * so that with a = W (F + J^T lambda) the multipliers solve (J W J^T) lambda = -(J W F + c): the index is reduced from
 * 3 to 1. What this leaves open, the drift off g = 0 and J v = 0, is removed after every step: a mass-weighted Newton
 * iteration on the positions, then the velocities. W holds inverse masses with the pins in them (constraint_matrix.c).
 * Scripted particles enter by their position, velocity and acceleration, the last from differences of the path, so that
 * a method keeps its order on moving pins. Invariant: an evaluation is a function of t, x, v and a alone; no
 * factorization is carried from one to the next, so a resumed run repeats bit by bit.
 * Witkin, Physically based modeling: constrained dynamics (SIGGRAPH course notes); Hairer and Wanner, Solving ODEs II,
 * VII.1 and VII.2 (index reduction, projection). */
#include "core/dynamics/constraint_matrix.h"

#include <stdlib.h>
#include <string.h>

enum { ITERATIONS = 25, SAMPLE = 64 };

/* Positions: relative to the largest coordinate, which sets their rounding. Velocities: relative to the sum of
 * |J||v|. Convergence by less than `slow` a round asks for a new factorization. */
static const double position_tolerance = 1e-12, velocity_tolerance = 1e-13, slow = 0.1;

static hk_status prepare(hk_dynamics *d) {
  hk_status status = hk_constraint_matrix_build(d);
  if (status != HK_OK || d->constraints->equations == 0) return status;
  hk_constraint_matrix_linearise(d, d->system.t, d->state->X, d->state->X + 3 * d->state->model.n);
  return hk_constraint_matrix_check(d, false, HK_BAD_PARAM);
}

hk_status hk_constraints_open(hk_dynamics *d) {
  if (d->plugins->kind[HK_CONSTRAINT].count == 0) return HK_OK;
  d->constraints = calloc(1, sizeof *d->constraints);
  if (!d->constraints) return hk_error_set(d->error, HK_NO_MEMORY, "no memory for the constraints");
  /* An instance of their own: the scene's solver keeps the factors of an implicit method between evaluations. */
  hk_status status = hk_solver_twin(d, &d->constraints->linear.solver);
  return status == HK_OK ? prepare(d) : status;
}

hk_status hk_constraints_topology(hk_dynamics *d) { return d->constraints ? prepare(d) : HK_OK; }

hk_status hk_constraints_update(hk_dynamics *d) {
  bool any = false;
  for (size_t k = 0; k < d->plugins->kind[HK_CONSTRAINT].count; k++) {
    const hk_instance *instance = d->plugins->kind[HK_CONSTRAINT].item[k];
    bool changed = false;
    if (!instance->plugin->constraint->update) continue;
    hk_view view = hk_instance_view(instance, &d->state->view);
    const hk_instance *outer = hk_enter(instance);
    hk_status status = instance->plugin->constraint->update(instance->self, &view, &changed);
    hk_leave(instance, outer);
    if (status != HK_OK) return status;
    any |= changed;
  }
  return any ? prepare(d) : HK_OK;
}

void hk_constraints_close(hk_dynamics *d) {
  if (!d->constraints) return;
  hk_constraint_matrix_free(d->constraints);
  hk_instance_destroy(d->constraints->linear.solver);
  free(d->constraints);
  d->constraints = NULL;
}

static hk_status find_path_accelerations(hk_dynamics *d, double t) {
  hk_constraints *c = d->constraints;
  hk_status status = HK_OK;
  for (size_t k = 0; k < d->pins->count && status == HK_OK; k++) {
    const hk_pin_state *pin = &d->pins->item[k];
    if (pin->spec->kind == HK_PIN_PATH && !pin->released && c->path_used[k])
      status = hk_pin_acceleration(pin->spec, t, c->path[k], d->error);
  }
  return status;
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* vector += sign W J^T solution */
static void move(const hk_constraints *c, double sign, double *vector) {
  for (size_t b = 0; b < c->blocks; b++) {
    double s = sign * c->solution[c->list.pair[b][0]], *at = vector + 3 * (size_t)c->list.pair[b][1];
    for (int a = 0; a < 3; a++) at[a] += s * c->WJ[b][a];
  }
}

static hk_status accelerate(hk_dynamics *d, double t, const double *x, const double *v, double *a) {
  hk_constraints *c = d->constraints;
  hk_status status = d->pins->has_paths ? find_path_accelerations(d, t) : HK_OK;
  if (status != HK_OK) return status;
  hk_constraint_matrix_linearise(d, t, x, v);
  for (size_t k = 0; k < d->plugins->kind[HK_CONSTRAINT].count; k++) {
    const hk_instance *instance = d->plugins->kind[HK_CONSTRAINT].item[k];
    hk_view view = hk_constraint_view(d, instance, t, x, v);
    const hk_instance *outer = hk_enter(instance);
    instance->plugin->constraint->curvature(instance->self, &view, c->c + c->equation_first[k]);
    hk_leave(instance, outer);
  }
  status = hk_constraint_matrix_factorize(d);
  if (status != HK_OK) return status;
  for (size_t k = 0; k < c->equations; k++) c->rhs[k] = -c->c[k];
  for (size_t b = 0; b < c->blocks; b++) {
    uint32_t i = c->list.pair[b][1];
    c->rhs[c->list.pair[b][0]] -=
        dot(c->J[b], d->state->pin[i] == HK_PIN_PATH ? c->path[c->pin[b]] : a + 3 * (size_t)i);
  }
  status = hk_constraint_matrix_solve(d);
  if (status == HK_OK) move(c, 1, a);
  return status;
}

/* The time is the constraints', by their share of the equations. */
static void account(hk_dynamics *d, double seconds) {
  for (size_t k = 0; k < d->plugins->kind[HK_CONSTRAINT].count; k++) {
    const hk_constraints *c = d->constraints;
    hk_instance *instance = d->plugins->kind[HK_CONSTRAINT].item[k];
    instance->seconds += seconds * (double)(c->equation_first[k + 1] - c->equation_first[k]) / (double)c->equations;
    instance->sampled++;
  }
}

hk_status hk_constraints_accelerate(hk_dynamics *d, double t, const double *x, const double *v, double *a) {
  if (d->constraints->equations == 0) return HK_OK;
  bool sample = d->plugins->kind[HK_CONSTRAINT].item[0]->calls % SAMPLE == 0;
  double begin = sample ? hk_clock() : 0;
  hk_status status = accelerate(d, t, x, v, a);
  for (size_t k = 0; k < d->plugins->kind[HK_CONSTRAINT].count; k++) d->plugins->kind[HK_CONSTRAINT].item[k]->calls++;
  if (sample) account(d, hk_clock() - begin);
  return status;
}

static void evaluate(hk_dynamics *d, double t, const double *x, const double *v) {
  hk_constraints *c = d->constraints;
  for (size_t k = 0; k < d->plugins->kind[HK_CONSTRAINT].count; k++) {
    const hk_instance *instance = d->plugins->kind[HK_CONSTRAINT].item[k];
    hk_view view = hk_constraint_view(d, instance, t, x, v);
    const hk_instance *outer = hk_enter(instance);
    instance->plugin->constraint->value(instance->self, &view, c->g + c->equation_first[k]);
    hk_leave(instance, outer);
  }
}

/* The equation of largest |g|; NaN is larger than anything. Those that nothing can move are left out on request. */
static size_t worst_of(const hk_constraints *c, bool movable) {
  size_t worst = SIZE_MAX;
  for (size_t k = 0; k < c->equations; k++) {
    if (movable && c->scale[k] == 0) continue;
    if (worst == SIZE_MAX || !(fabs(c->g[k]) <= fabs(c->g[worst]))) worst = k;
    if (isnan(c->g[k])) break;
  }
  return worst;
}

static double extent(const hk_constraints *c, const double *x) {
  double largest = 0;
  for (size_t b = 0; b < c->blocks; b++)
    for (int a = 0; a < 3; a++) largest = fmax(largest, fabs(x[3 * (size_t)c->list.pair[b][1] + a]));
  return largest;
}

static hk_status gave_up(hk_dynamics *d, size_t equation, const char *what, double left, const char *unit) {
  size_t number;
  const hk_instance *instance = hk_constraint_of(d, equation, &number);
  return hk_error_set(d->error, isfinite(left) ? HK_NOT_CONVERGED : HK_NOT_FINITE,
                      "%s: the %s of equation %zu cannot be brought onto the constraint: %.3g %s are left",
                      instance->label, what, number, left, unit);
}

static hk_status renew(hk_dynamics *d, double t, const double *x, const double *v, bool *factorized) {
  hk_constraint_matrix_linearise(d, t, x, v);
  *factorized = true;
  return hk_constraint_matrix_factorize(d);
}

/* x -= W J^T (J W J^T)^-1 g until g is rounding. J is that of the first round, as long as it serves. */
static hk_status project_positions(hk_dynamics *d, double t, double *x, const double *v, bool *factorized) {
  hk_constraints *c = d->constraints;
  double tolerance = position_tolerance * extent(c, x), last = INFINITY;
  size_t worst = SIZE_MAX;
  hk_status status = HK_OK;
  hk_constraint_matrix_linearise(d, t, x, v);
  for (int round = 0; round < ITERATIONS && status == HK_OK; round++) {
    evaluate(d, t, x, v);
    worst = worst_of(c, true);
    double size = worst == SIZE_MAX ? 0 : fabs(c->g[worst]);
    if (size <= tolerance) return HK_OK;
    if (!isfinite(size)) break;
    if (round == 0 || size > slow * last) status = renew(d, t, x, v, factorized);
    last = size;
    memcpy(c->rhs, c->g, c->equations * sizeof *c->rhs);
    if (status == HK_OK) status = hk_constraint_matrix_solve(d);
    if (status == HK_OK) move(c, -1, x);
  }
  return status == HK_OK ? gave_up(d, worst, "position", c->g[worst], "m") : status;
}

/* rhs = J v; the largest of it relative to the sum of |J||v|, and its equation. */
static double velocity_residual(hk_constraints *c, const double *v, size_t *worst) {
  double largest = 0, *sum = c->c;
  memset(c->rhs, 0, c->equations * sizeof *c->rhs);
  memset(sum, 0, c->equations * sizeof *sum);
  for (size_t b = 0; b < c->blocks; b++) {
    const double *here = v + 3 * (size_t)c->list.pair[b][1];
    uint32_t k = c->list.pair[b][0];
    c->rhs[k] += dot(c->J[b], here);
    sum[k] += sqrt(dot(c->J[b], c->J[b]) * dot(here, here));
  }
  for (size_t k = 0; k < c->equations; k++) {
    double relative = c->scale[k] > 0 && sum[k] > 0 ? fabs(c->rhs[k]) / sum[k] : 0;
    if (relative <= largest) continue;
    largest = relative;
    *worst = k;
    if (isnan(relative)) break;
  }
  return largest;
}

/* v -= W J^T (J W J^T)^-1 J v, J at the new positions; the factors may be those of positions close by. */
static hk_status project_velocities(hk_dynamics *d, double t, const double *x, double *v, bool factorized) {
  hk_constraints *c = d->constraints;
  double last = INFINITY, left = 0;
  size_t worst = 0;
  hk_status status = HK_OK;
  hk_constraint_matrix_linearise(d, t, x, v);
  for (int round = 0; round < ITERATIONS && status == HK_OK; round++) {
    double relative = velocity_residual(c, v, &worst);
    if (relative <= velocity_tolerance) return HK_OK;
    left = c->rhs[worst];
    if (!isfinite(relative)) break;
    if (!factorized || relative > slow * last) {
      status = renew(d, t, x, v, &factorized);
      velocity_residual(c, v, &worst); /* linearising used rhs */
    }
    last = relative;
    if (status == HK_OK) status = hk_constraint_matrix_solve(d);
    if (status == HK_OK) move(c, -1, v);
  }
  return status == HK_OK ? gave_up(d, worst, "velocity", left, "m/s") : status;
}

hk_status hk_constraints_project(hk_dynamics *d, double t, double *x, double *v) {
  bool factorized = false;
  if (d->constraints->equations == 0) return HK_OK;
  hk_status status = project_positions(d, t, x, v, &factorized);
  return status == HK_OK ? project_velocities(d, t, x, v, factorized) : status;
}

double hk_constraints_violation(hk_dynamics *d) {
  if (!d->constraints || d->constraints->equations == 0) return 0;
  evaluate(d, d->system.t, d->state->X, d->state->X + 3 * d->state->model.n);
  return fabs(d->constraints->g[worst_of(d->constraints, false)]);
}
