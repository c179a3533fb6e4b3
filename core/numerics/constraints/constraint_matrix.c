/* A = S J W J^T S, with J = dg/dx, W the inverse masses with the forbidden directions of sliding pins projected away (0
 * for held particles), and S = diag(J W J^T)^-1/2, so that the units of an equation do not matter.
 *
 * Its pattern is that of constraint_pattern.c. An equation whose particles are all immovable (a bar between two pins)
 * has the row of the identity and multiplier 0, and so has one that rests.
 * Equations that follow from others are left out (constraint.c). Where A is still singular, which depends on the state
 * (a bar that is stretched between two pins), A + soft_shift I is factorized and the solution refined iteratively,
 * which converges to the multipliers of minimal norm (the proximal point iteration). */

#include "core/numerics/constraints/constraints.h"

#include <string.h>

/* A round of refinement reduces the error by the factor soft_shift / eigenvalue; rounding in the dependent directions
 * grows by 1 / soft_shift. */
static const double soft_shift = 1e-9, refined = 1e-14;
/* An equation has no movable direction when the free part of its J is shorter than 1e-10 of the whole. */
static const double no_direction = 1e-20;

enum { REFINEMENTS = 8 };

/* W J for one block. */
static void weigh(const hk_dynamics *d, uint32_t pin, uint32_t particle, const double J[3], double WJ[3]) {
  double w = d->state->inverse_mass[particle];
  memcpy(WJ, J, 3 * sizeof *WJ);
  if (d->state->pin[particle] == HK_PIN_LINE || d->state->pin[particle] == HK_PIN_PLANE)
    hk_pin_project(d->pins->item[pin].spec, WJ);
  for (int a = 0; a < 3; a++) WJ[a] *= w;
}

void hk_constraint_matrix_rest(hk_constraints *c) {
  for (size_t k = 0; k < c->equations; k++) c->scale[k] = c->rests[k] ? 0 : c->full[k];
}

/* own = the diagonal of J W J^T with `J` on the left */
static void find_own(hk_constraints *c, double (*J)[3]) {
  memset(c->own, 0, c->equations * sizeof *c->own);
  for (size_t b = 0; b < c->blocks; b++) c->own[c->list.pair[b][0]] += hk_constraint_dot(J[b], c->WJ[b]);
}

/* The same as if no pin held anything. */
static void find_whole(const hk_dynamics *d, double *whole) {
  const hk_constraints *c = d->constraints;
  memset(whole, 0, c->equations * sizeof *whole);
  for (size_t b = 0; b < c->blocks; b++)
    whole[c->list.pair[b][0]] += d->state->inverse_mass[c->list.pair[b][1]] * hk_constraint_dot(c->J[b], c->J[b]);
}

/* WJ and own where no particle slides, and with that no pin holds a part of a direction. */
static void weigh_all(const hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  memset(c->own, 0, c->equations * sizeof *c->own);
  for (size_t b = 0; b < c->blocks; b++) {
    double w = d->state->inverse_mass[c->list.pair[b][1]];
    for (int a = 0; a < 3; a++) c->WJ[b][a] = w * c->J[b][a];
    c->own[c->list.pair[b][0]] += hk_constraint_dot(c->J[b], c->WJ[b]);
  }
}

hk_status hk_constraint_matrix_linearise(hk_dynamics *d, double t, const double *x, const double *v) {
  hk_constraints *c = d->constraints;
  double *whole = d->pins->has_slides ? c->rhs : c->own;
  c->kept = false;
  hk_status status = hk_constraint_jacobian(d, t, x, v, c->J);
  if (status != HK_OK) return status;
  if (d->pins->has_slides) {
    for (size_t b = 0; b < c->blocks; b++) weigh(d, c->pin[b], c->list.pair[b][1], c->J[b], c->WJ[b]);
    find_own(c, c->J);
    find_whole(d, whole);
  } else
    weigh_all(d);
  for (size_t k = 0; k < c->equations; k++) c->full[k] = c->own[k] > no_direction * whole[k] ? 1 / sqrt(c->own[k]) : 0;
  hk_constraint_matrix_rest(c);
  return HK_OK;
}

void hk_constraint_matrix_forget_masses(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  for (size_t b = 0; b < c->blocks; b++) {
    uint32_t i = c->list.pair[b][1];
    for (int a = 0; a < 3 && d->state->inverse_mass[i] > 0; a++) c->WJ[b][a] *= d->state->mass[i];
  }
  find_own(c, c->J);
  for (size_t k = 0; k < c->equations; k++) c->full[k] = c->full[k] > 0 ? 1 / sqrt(c->own[k]) : 0;
  hk_constraint_matrix_rest(c);
}

/* S J W J^T S with `J` on the left */
static hk_matrix assemble(hk_constraints *c, double (*J)[3], bool symmetric) {
  const size_t *diagonal = c->matrix.slot;
  for (size_t k = 0; k < c->equations; k++)
    c->value[diagonal[k]] = c->scale[k] == 0 ? 1 : c->scale[k] * c->scale[k] * c->own[k];
  for (const hk_constraint_entry *at = c->entry, *end = at + c->entries; at < end; at++) {
    double sum = 0, other = 0;
    for (size_t e = at->first; e < at[1].first; e++) sum += hk_constraint_dot(J[c->term[e][0]], c->WJ[c->term[e][1]]);
    for (size_t e = at->first; !symmetric && e < at[1].first; e++)
      other += hk_constraint_dot(J[c->term[e][1]], c->WJ[c->term[e][0]]);
    const uint32_t *first = c->term[at->first];
    double scale = c->scale[c->list.pair[first[0]][0]] * c->scale[c->list.pair[first[1]][0]];
    sum *= scale, other = symmetric ? sum : scale * other;
    if (at->place == at->mirror)
      c->value[at->place] += sum + other;
    else
      c->value[at->place] = sum, c->value[at->mirror] = other;
  }
  return (hk_matrix){c->equations, 1, c->matrix.row_start, c->matrix.column, c->value, symmetric, c->matrix.number};
}

hk_matrix hk_constraint_matrix_assemble(hk_constraints *c) { return assemble(c, c->J, true); }

static void soften(hk_constraints *c, double by) {
  for (size_t k = 0; by > 0 && k < c->equations; k++) c->value[c->matrix.slot[k]] += by;
}

static hk_status cannot_solve(hk_dynamics *d) {
  size_t number = 0, worst = 0;
  for (size_t k = 0; k < d->constraints->equations; k++)
    if (!isfinite(d->constraints->full[k])) worst = k;
  const hk_instance *instance = hk_constraint_of(d, worst, &number);
  return hk_error_set(d->error, HK_NOT_CONVERGED,
                      "%s%sthe multipliers of the constraints cannot be found: %s equation %zu", instance->where,
                      *instance->where ? ": " : "", instance->label, number);
}

hk_status hk_constraint_matrix_factorize_shifted(hk_dynamics *d, double by) {
  hk_matrix A = hk_constraint_matrix_assemble(d->constraints);
  soften(d->constraints, by);
  d->constraints->soft = by;
  return hk_linear_system_factorize(d, &d->constraints->linear, &A);
}

/* Where equations are known to depend on each other, and with one-sided ones, which often do in contact (four feet on a
 * floor), the shifted matrix is used at once. */
hk_status hk_constraint_matrix_factorize(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  hk_error before = *d->error;
  hk_status status = HK_NOT_CONVERGED;
  for (int attempt = c->one_sided_count > 0 || c->dependent; attempt < 2 && status == HK_NOT_CONVERGED; attempt++) {
    *d->error = before; /* removes the solver's message, which names a matrix row */
    status = hk_constraint_matrix_factorize_shifted(d, attempt == 1 ? soft_shift : 0);
  }
  return status == HK_NOT_CONVERGED ? cannot_solve(d) : status;
}

static double largest(const double *of, size_t count) {
  double most = 0;
  for (size_t k = 0; k < count; k++)
    if (!(fabs(of[k]) <= most)) most = fabs(of[k]);
  return most;
}

/* residual = rhs - A solution, with A without its shift */
static void find_residual(hk_constraints *c) {
  for (size_t r = 0; r < c->equations; r++) {
    double sum = c->rhs[r] + c->soft * c->solution[r];
    for (size_t e = c->matrix.row_start[r]; e < c->matrix.row_start[r + 1]; e++)
      sum -= c->value[e] * c->solution[c->matrix.column[e]];
    c->residual[r] = sum;
  }
}

static hk_status refine(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  double enough = refined * largest(c->rhs, c->equations), last = INFINITY;
  hk_status status = HK_OK;
  for (int round = 0; round < REFINEMENTS && status == HK_OK; round++) {
    find_residual(c);
    double left = largest(c->residual, c->equations);
    if (!(left > enough) || left > 0.5 * last) return HK_OK;
    last = left;
    status = hk_linear_system_solve(d, &c->linear, c->residual, c->correction, NULL);
    for (size_t k = 0; k < c->equations && status == HK_OK; k++) c->solution[k] += c->correction[k];
  }
  return status;
}

void hk_constraint_matrix_push(const hk_constraints *c, const double *of, double by, double *vector) {
  for (size_t b = 0; b < c->blocks; b++) {
    double s = by * of[c->list.pair[b][0]], *at = vector + 3 * (size_t)c->list.pair[b][1];
    for (int a = 0; a < 3; a++) at[a] += s * c->WJ[b][a];
  }
  hk_riders_follow(c->model, vector);
}

void hk_constraint_matrix_move(const hk_constraints *c, double *vector) {
  hk_constraint_matrix_push(c, c->solution, 1, vector);
}

hk_status hk_constraint_matrix_solve(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  for (size_t k = 0; k < c->equations; k++) c->rhs[k] *= c->scale[k];
  hk_status status = hk_linear_system_solve(d, &c->linear, c->rhs, c->solution, NULL);
  if (status == HK_OK && c->soft > 0) status = refine(d);
  for (size_t k = 0; k < c->equations; k++) c->solution[k] *= c->scale[k];
  return status;
}

static hk_status open_mixed(hk_dynamics *d, hk_constraints *c) {
  if (c->mixed.any) return HK_OK;
  hk_status status = hk_solver_indefinite(d, &c->mixed.any, &c->unsymmetric);
  c->mixed.solver = c->mixed.any;
  return status;
}

hk_status hk_constraint_matrix_mix(hk_dynamics *d, double t, const double *x, const double *v) {
  hk_constraints *c = d->constraints;
  c->kept = false;
  hk_status status = open_mixed(d, c);
  if (status == HK_OK) status = hk_constraint_jacobian(d, t, x, v, c->J_end);
  if (status != HK_OK) return status;
  find_own(c, c->J_end);
  hk_matrix A = assemble(c, c->J_end, false);
  hk_error before = *d->error;
  status = hk_linear_system_factorize(d, &c->mixed, &A);
  if (status == HK_NOT_CONVERGED) *d->error = before; /* the solver names a row; the caller has the equation */
  return status;
}

hk_status hk_constraint_matrix_solve_mixed(hk_dynamics *d) {
  hk_constraints *c = d->constraints;
  for (size_t k = 0; k < c->equations; k++) c->rhs[k] *= c->scale[k];
  hk_status status = hk_linear_system_solve(d, &c->mixed, c->rhs, c->solution, NULL);
  for (size_t k = 0; k < c->equations; k++) c->solution[k] *= c->scale[k];
  return status;
}

hk_status hk_constraint_matrix_newton(hk_dynamics *d, double t, const double *x, const double *v) {
  hk_constraints *c = d->constraints;
  hk_status status = hk_constraint_matrix_mix(d, t, x, v);
  for (size_t k = 0; k < c->equations; k++) c->rhs[k] = -c->g[k];
  return status == HK_OK ? hk_constraint_matrix_solve_mixed(d) : status;
}
