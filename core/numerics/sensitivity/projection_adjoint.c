/* The transposed derivative of steps with constraints: of the velocities' projection and of the impulses' drift. */
#include "core/numerics/sensitivity/projection.h"

#include <string.h>

void hk_projection_begin(hk_sensitivity *s) {
  memset(s->projection->by_equation, 0, s->projection->equations * sizeof(double));
  memset(s->projection->by_mass, 0, s->n * sizeof(double));
}

/* to += `by` J^T of the equations' numbers */
static void add_gradients(const hk_constraints *c, double (*J)[3], const double *of, double by, double *to) {
  for (size_t b = 0; b < c->blocks; b++)
    for (size_t e = 0; e < 3; e++) to[3 * (size_t)c->list.pair[b][1] + e] += by * of[c->list.pair[b][0]] * J[b][e];
}

/* W J^T of an impulse is a part of something of which y is the adjoint. */
static void note_masses(hk_sensitivity *s, double (*J)[3], const double *impulse, const double *y) {
  const double *inverse = s->dynamics->state->model.inverse_mass;
  double *push = s->projection->push;
  memset(push, 0, 3 * s->n * sizeof *push);
  add_gradients(s->dynamics->constraints, J, impulse, 1, push);
  hk_sensitivity_divide(s, push);
  for (size_t e = 0; e < 3 * s->n; e++) s->projection->by_mass[e / 3] -= inverse[e / 3] * y[e] * push[e];
}

hk_status hk_projection_unsettle(hk_sensitivity *s, const hk_taken_step *step, hk_carried *L) {
  hk_projection *p = s->projection;
  hk_constraints *c = s->dynamics->constraints;
  size_t v = 3 * s->n;
  double t = step->t + step->h, *z = L + v, *q = p->work + 5 * v, *turned = q + v, *multipliers = p->work + 10 * v;
  hk_status status = hk_projection_stand(s, t, p->after);
  memcpy(q, z, v * sizeof *q);
  hk_sensitivity_divide(s, q);
  hk_projection_rates(c, c->J, q, c->rhs);
  if (status == HK_OK) status = hk_constraint_matrix_solve(s->dynamics);
  if (status != HK_OK) return status;
  memcpy(multipliers, c->solution, c->equations * sizeof *multipliers);
  add_gradients(c, c->J, multipliers, -1, z);
  note_masses(s, c->J, p->lambda, z);
  memcpy(q, z, v * sizeof *q);
  hk_sensitivity_divide(s, q);
  status = hk_constraint_bend_add(s->dynamics, &p->bend, t, p->after, p->lambda, q, L);
  memset(turned, 0, v * sizeof *turned);
  if (status == HK_OK) status = hk_constraint_bend_add(s->dynamics, &p->bend, t, p->after, multipliers, p->end, turned);
  for (size_t e = 0; e < v; e++) L[e] -= turned[e];
  return status;
}

hk_status hk_projection_return(hk_sensitivity *s, const hk_taken_step *step, hk_carried *L, double *u) {
  hk_projection *p = s->projection;
  hk_constraints *c = s->dynamics->constraints;
  size_t v = 3 * s->n;
  double h = step->h, *q = p->work + 5 * v, *bend = q + v;
  hk_status status = hk_projection_mix(s, step->t, p->from, step->t + h, p->after);
  if (status != HK_OK) return status;
  for (size_t e = 0; e < v; e++) q[e] = L[e] += L[v + e] / h;
  hk_sensitivity_divide(s, q);
  hk_projection_rates(c, c->J_end, q, c->rhs);
  status = hk_constraint_matrix_solve_mixed(s->dynamics);
  if (status != HK_OK) return status;
  add_gradients(c, c->J, c->solution, -1, L);
  for (size_t k = 0; k < c->equations; k++) p->by_equation[k] -= c->solution[k];
  note_masses(s, c->J_end, p->impulse, L);
  memcpy(q, L, v * sizeof *q);
  hk_sensitivity_divide(s, q);
  memset(bend, 0, v * sizeof *bend);
  status = hk_constraint_bend_add(s->dynamics, &p->bend, step->t, p->from, p->impulse, q, bend);
  for (size_t e = 0; e < v; e++) {
    L[e] -= L[v + e] / h;
    L[v + e] += h * L[e];
    L[e] += bend[e];
    u[e] = p->kick * h * L[v + e];
  }
  return status;
}

double hk_projection_slope(const hk_sensitivity *s, const hk_projection_slopes *by) {
  const hk_projection *p = s->projection;
  double sum = 0;
  for (size_t k = 0; k < p->equations; k++) sum += p->by_equation[k] * by->g[k];
  for (size_t i = 0; i < s->n; i++) sum += p->by_mass[i] * by->mass[i];
  return sum;
}
