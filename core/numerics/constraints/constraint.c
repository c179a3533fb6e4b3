/* Constraints g(x, t) = 0 or g(x, t) >= 0 by multipliers, all constraints of a scene at once. Differentiating twice
 * gives J a + c = 0, so that with a = W (F + J^T lambda) the multipliers solve (J W J^T) lambda = -(J W F + c): the
 * index is reduced from 3 to 1. The remaining drift away from g = 0 and J v + g_t = 0 is removed after every step
 * (constraint_projection.c); methods that keep both in their own steps need none of this (the same file). W
 * holds the inverse masses and includes the pins (constraint_matrix.c). Scripted particles enter by their position,
 * velocity and acceleration, the last from differences of the path, so that a method keeps its order on moving pins.
 *
 * A one-sided equation may push during a step when, at the state at the start of the step, it held with equality and
 * was not opening. The signs of the multipliers decide in every evaluation which of these equations do push
 * (active_set.c). So the set of acting equations is a function of that state and of t, x, v, and stages that violate g
 * = 0 or J v = 0 by their error do not lose a contact.
 *
 * Invariant: no factorization is kept from one evaluation to the next, so a resumed run repeats bit by bit. Witkin,
 * Physically based modeling: constrained dynamics (SIGGRAPH course notes); Hairer and Wanner, Solving ODEs II, VII.1
 * and VII.2 (index reduction, projection); Moreau 1988 (unilateral contact, inelastic impact). */

#include "core/numerics/constraints/constraints.h"

#include <stdlib.h>
#include <string.h>

enum { SAMPLE = 64, INVERSE_ITERATIONS = 3 };

/* A has a unit diagonal. A chain of N bars has the eigenvalue (pi/N)^2, far above `dependent`; rounding errors are
 * below `dependent`. */
static const double shift = 1e-11, dependent = 1e-13;

/* ---- opening, and changes between steps ---- */

/* Finds the one-sided equations in contact; the equations are linearised, and g and `speed` are evaluated. */
static void find_contacts(hk_dynamics *d, const double *x, const double *v) {
  hk_constraints *c = d->constraints;
  double size = hk_constraint_extent(c, x);
  bool free = c->equations > c->one_sided_count; /* of contact, beside equalities */
  hk_constraint_rate(c, v, c->residual, c->correction);
  for (size_t k = 0; k < c->equations; k++) {
    bool touches = c->one_sided[k] && hk_constraint_touches(c, k, size) &&
                   c->residual[k] <= hk_constraint_resting * (c->correction[k] + size);
    c->jumped |= touches != c->touches[k];
    c->touches[k] = touches;
    free &= !touches;
  }
  c->table.holonomic = free;
  hk_constraint_note_start(c);
}

hk_status hk_constraint_find_contacts(hk_dynamics *d, double t, const double *x, const double *v) {
  if (d->constraints->one_sided_count == 0) return HK_OK;
  hk_status status = hk_constraint_matrix_linearise(d, t, x, v);
  if (status == HK_OK) status = hk_constraint_value(d, t, x, v);
  if (status == HK_OK) status = hk_constraint_speed(d, t, x, v);
  if (status == HK_OK) find_contacts(d, x, v);
  return status;
}

/* The Rayleigh quotient u A u of the unit vector u in c->rhs. */
static double quotient(const hk_constraints *c, const hk_matrix *A) {
  double sum = 0;
  for (size_t r = 0; r < A->rows; r++)
    for (size_t e = A->row_start[r]; e < A->row_start[r + 1]; e++)
      sum += c->rhs[r] * A->value[e] * c->rhs[A->column[e]];
  return sum;
}

static void normalise(double *to, const double *from, size_t count) {
  double sum = 0;
  for (size_t k = 0; k < count; k++) sum += from[k] * from[k];
  for (size_t k = 0; k < count; k++) to[k] = from[k] / sqrt(sum);
}

/* Computes the eigenvector of the smallest eigenvalue in c->rhs, and its Rayleigh quotient. */
static hk_status weakest(hk_dynamics *d, double *smallest) {
  hk_constraints *c = d->constraints;
  uint64_t bits = 88172645463325252u; /* xorshift: a pseudo-random start vector avoids orthogonality by symmetry */
  for (size_t k = 0; k < c->equations; k++) {
    bits ^= bits << 13;
    bits ^= bits >> 7;
    bits ^= bits << 17;
    c->solution[k] = (double)(bits >> 11) * 0x1p-53 + 0.1;
  }
  normalise(c->rhs, c->solution, c->equations);
  hk_status status = hk_constraint_matrix_factorize_shifted(d, shift);
  for (int i = 0; i < INVERSE_ITERATIONS && status == HK_OK; i++) {
    status = hk_linear_system_solve(d, &c->linear, c->rhs, c->solution, NULL);
    normalise(c->rhs, c->solution, c->equations);
  }
  hk_matrix A = hk_constraint_matrix_assemble(c);
  *smallest = quotient(c, &A);
  return status;
}

/* Dependent equations cause a small eigenvalue of A, which is detected by inverse iteration on A + shift I. Equations
 * that follow from others are then left out, and hold because the others do. One-sided ones are excluded here, because
 * the set of those that act changes. */
static hk_status find_implied(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  hk_error before = *d->error;
  double smallest = 0;
  memset(c->implied, 0, c->equations * sizeof *c->implied);
  if (c->equations - c->one_sided_count < 2) return HK_OK;
  memcpy(c->rests, c->one_sided, c->equations * sizeof *c->rests);
  hk_constraint_matrix_rest(c);
  hk_status found = weakest(d, &smallest);
  if (found != HK_OK && found != HK_NOT_CONVERGED) return found;
  *d->error = before;
  if (found == HK_OK && smallest > dependent) return HK_OK;
  hk_matrix A = hk_constraint_matrix_assemble(c);
  return hk_independent_rows(&A, c->implied, d->error);
}

hk_status hk_constraints_review(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  double t = d->system.t, *x = d->state->X, *v = x + 3 * d->state->model.n;
  if (!c || c->equations == 0) return HK_OK;
  hk_status status = hk_constraint_matrix_linearise(d, t, x, v);
  if (status != HK_OK) return status;
  hk_constraint_matrix_forget_masses(d); /* a heavy weight on a light chain is no dependence */
  status = find_implied(d);
  if (status != HK_OK) return status;
  status = hk_rigid_groups_find(d);
  if (status != HK_OK) return status;
  memcpy(c->rests, c->implied, c->equations * sizeof *c->rests);
  return hk_constraint_find_contacts(d, t, x, v);
}

hk_status hk_constraints_topology(hk_dynamics *d) {
  hk_status status = hk_constraint_matrix_build(d);
  return status == HK_OK ? hk_constraints_review(d) : status;
}

bool hk_constraints_jumped(hk_dynamics *d) {
  bool jumped = d->constraints && d->constraints->jumped;
  if (jumped) d->constraints->jumped = false;
  return jumped;
}

/* ---- the tangent space ---- */

static void find_forbidden(hk_constraints *c, const double *vector) {
  memset(c->rhs, 0, c->equations * sizeof *c->rhs);
  for (size_t b = 0; b < c->blocks; b++)
    c->rhs[c->list.pair[b][0]] -= hk_constraint_dot(c->J[b], vector + 3 * (size_t)c->list.pair[b][1]);
}

hk_status hk_constraints_project_velocity(hk_system *s, double *vector) {
  hk_dynamics *d = (hk_dynamics *)(void *)s;
  hk_constraints *c = d->constraints;
  if (!c || c->equations == 0) return HK_OK;
  for (size_t k = 0; k < c->equations; k++) c->rests[k] = c->one_sided[k] ? !c->touches[k] : c->implied[k];
  hk_status status = hk_constraint_matrix_linearise(d, s->t, s->X, s->X + 3 * s->n);
  if (status == HK_OK) status = hk_constraint_matrix_factorize(d);
  if (status != HK_OK) return status;
  find_forbidden(c, vector);
  status = hk_constraint_matrix_solve(d);
  if (status == HK_OK) hk_constraint_matrix_move(c, vector);
  return status;
}

/* ---- accelerations ---- */

static hk_status find_path_accelerations(hk_dynamics *d, double t) {
  hk_constraints *c = d->constraints;
  hk_status status = HK_OK;
  for (size_t k = 0; k < d->pins->count && status == HK_OK; k++) {
    hk_pin_state *pin = &d->pins->item[k];
    if (pin->spec->kind == HK_PIN_PATH && !pin->released && c->path_used[k])
      status = pin->motion->bend(pin->motion, t, d->error);
  }
  return status;
}

static void note_acting(hk_dynamics *d, double t) {
  hk_constraints *c = d->constraints;
  size_t acting = 0;
  for (size_t k = 0; k < c->equations; k++) {
    acting += c->scale[k] > 0;
    c->pushes[k] = c->one_sided[k] && !c->rests[k] && c->solution[k] > 0;
  }
  memcpy(c->lambda, c->solution, c->equations * sizeof *c->lambda);
  if (c->one_sided_count) hk_release_note(c, t == d->system.t);
  d->constraints->table.equations = acting;
}

/* The particle of block b is scripted. */
static double along_path(const hk_dynamics *d, size_t b) {
  const hk_constraints *c = d->constraints;
  const hk_pin_state *pin = &d->pins->item[c->pin[b]];
  double a[3];
  hk_pin_motion_acceleration(pin->motion, pin->origin + 3 * (size_t)c->place[b], a);
  return hk_constraint_dot(c->J[b], a);
}

/* c->c = c + J a, where a excludes constraint forces. */
static hk_status find_free_acceleration(hk_dynamics *d, double t, const double *x, const double *v, const double *a) {
  hk_constraints *c = d->constraints;
  hk_status status = hk_constraint_curvature(d, t, x, v);
  for (size_t b = 0; b < c->blocks; b++) {
    uint32_t i = c->list.pair[b][1];
    c->c[c->list.pair[b][0]] +=
        d->state->pin[i] == HK_PIN_PATH ? along_path(d, b) : hk_constraint_dot(c->J[b], a + 3 * (size_t)i);
  }
  return status;
}

static hk_status accelerate(hk_dynamics *d, double t, const double *x, const double *v, double *a, double *power) {
  hk_constraints *c = d->constraints;
  hk_status status = d->pins->has_paths ? find_path_accelerations(d, t) : HK_OK;
  if (status == HK_OK) status = hk_constraint_matrix_linearise(d, t, x, v);
  if (status == HK_OK) status = find_free_acceleration(d, t, x, v, a);
  if (status == HK_OK) status = hk_constraint_speed(d, t, x, v);
  if (status != HK_OK) return status;
  for (size_t k = 0; k < c->equations; k++) c->allowed[k] = c->touches[k];
  memset(c->held, 0, c->equations * sizeof *c->held);
  status = c->releases.weighing ? hk_release_solve(d) : hk_active_set_solve(d, c->c, false);
  if (status != HK_OK) return status;
  hk_constraint_matrix_move(c, a);
  if (!c->releases.weighing) note_acting(d, t);
  *power += hk_constraint_power(d, v);
  return HK_OK;
}

bool hk_constraint_sampled(const hk_dynamics *d) {
  return d->plugins->kind[HK_CONSTRAINT].item[0]->calls % SAMPLE == 0;
}

void hk_constraint_account(hk_dynamics *d, double begin, bool whole) {
  const hk_constraints *c = d->constraints;
  double seconds = hk_constraint_sampled(d) ? hk_clock() - begin : 0;
  bool sampled = whole && hk_constraint_sampled(d);
  for (size_t k = 0; k < d->plugins->kind[HK_CONSTRAINT].count; k++) {
    hk_instance *instance = d->plugins->kind[HK_CONSTRAINT].item[k];
    instance->seconds += seconds * (double)(c->equation_first[k + 1] - c->equation_first[k]) / (double)c->equations;
    instance->sampled += sampled;
    instance->calls += whole;
  }
}

hk_status hk_constraints_accelerate(hk_dynamics *d, double t, const double *x, const double *v, double *a,
                                    double *power) {
  if (d->constraints->equations == 0) return HK_OK;
  double begin = hk_constraint_sampled(d) ? hk_clock() : 0;
  hk_status status = accelerate(d, t, x, v, a, power);
  hk_constraint_account(d, begin, true);
  return status;
}
