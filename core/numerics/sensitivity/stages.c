/* A step as the linear combinations of accelerations that its method states. */
#include "core/numerics/sensitivity/sensitivity.h"

#include <string.h>

const hk_stages_facet *hk_sensitivity_method(const hk_sensitivity *s, const hk_taken_step *step) {
  return (step->fresh || s->linearised) && s->method->start ? s->method->start : s->method;
}

bool hk_sensitivity_evaluates(const hk_sensitivity *s, const hk_taken_step *step, size_t k) {
  return k > 0 || step->fresh || !hk_sensitivity_method(s, step)->carries;
}

/* x* or v*: number e of what is carried. */
static inline double from(const hk_stages_facet *m, const hk_carried *Z, size_t v, size_t e) {
  return m->back == 0 ? Z[e] : Z[e] + m->back * (Z[e] - Z[3 * v + e]);
}

hk_status hk_sensitivity_evaluate(hk_dynamics *d, double t, double *X, double *a) {
  double power; /* scenes with channels are refused: the work is all that X has beside x and v */
  size_t v = 3 * d->system.n;
  hk_constraint_table *constraint = d->system.constraint;
  if (constraint) constraint->takes_constraints = false;
  hk_status status = hk_evaluate_accelerations(&d->system, t, X, X + v, NULL, a, &power);
  if (constraint) constraint->takes_constraints = true;
  return status;
}

void hk_sensitivity_stage(const hk_sensitivity *s, const hk_taken_step *step, size_t k, const hk_carried *Z,
                          double *const a[HK_MOST_STAGES], double *X) {
  const hk_stages_facet *m = hk_sensitivity_method(s, step);
  const double h = step->h, ch = (m->c[k] - m->back) * h;
  size_t v = 3 * s->n;
  for (size_t e = 0; e < v; e++) {
    X[v + e] = from(m, Z, v, v + e);
    X[e] = from(m, Z, v, e) + ch * X[v + e];
  }
  for (size_t j = 0; j < k; j++)
    for (size_t e = 0; e < v; e++) {
      X[e] += h * h * m->x[k][j] * a[j][e];
      X[v + e] += h * m->v[k][j] * a[j][e];
    }
}

void hk_sensitivity_arrive(const hk_sensitivity *s, const hk_taken_step *step, double *const a[HK_MOST_STAGES],
                           hk_carried *Z) {
  const hk_stages_facet *m = hk_sensitivity_method(s, step);
  const double h = step->h;
  size_t v = 3 * s->n;
  for (size_t e = 0; e < 2 * v && s->wide > 3 * v; e++) {
    double before = Z[e];
    Z[e] = from(m, Z, v, e);
    Z[3 * v + e] = before;
  }
  for (size_t e = 0; e < v; e++) Z[e] += (1 - m->back) * h * Z[v + e];
  for (size_t j = 0; j < m->count; j++)
    for (size_t e = 0; e < v; e++) {
      Z[e] += h * h * m->x_end[j] * a[j][e];
      Z[v + e] += h * m->v_end[j] * a[j][e];
    }
  memcpy(Z + 2 * v, a[m->count - 1], v * sizeof *Z);
}
