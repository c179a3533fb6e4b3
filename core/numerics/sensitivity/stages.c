/* A step as the linear combinations of accelerations that its method states, and changes that are carried through it.
 */
#include "core/numerics/sensitivity/sensitivity.h"

#include <string.h>

const hk_stages_facet *hk_sensitivity_method(const hk_sensitivity *s, const hk_taken_step *step) {
  return (step->fresh || s->linearised) && s->method->start ? s->method->start : s->method;
}

bool hk_sensitivity_evaluates(const hk_sensitivity *s, const hk_taken_step *step, size_t k) {
  return k > 0 || step->fresh || !hk_sensitivity_method(s, step)->carries;
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

/* x* and v* of what is carried. */
static void from(const hk_stages_facet *m, const hk_carried *restrict Z, size_t v, double *restrict X) {
  const double back = m->back;
  const hk_carried *before = Z + 3 * v;
  if (back == 0)
    memcpy(X, Z, 2 * v * sizeof *X);
  else
    for (size_t e = 0; e < 2 * v; e++) X[e] = Z[e] + back * (Z[e] - before[e]);
}

/* What coefficients that are 0 add would be 0. */
static void add(double *restrict to, double part, const double *restrict a, size_t count) {
  for (size_t e = 0; e < count && part != 0; e++) to[e] += part * a[e];
}

void hk_sensitivity_stage(const hk_sensitivity *s, const hk_taken_step *step, size_t k, const hk_carried *Z,
                          double *const a[HK_MOST_STAGES], double *X) {
  const hk_stages_facet *m = hk_sensitivity_method(s, step);
  const double h = step->h, ch = (m->c[k] - m->back) * h;
  size_t v = 3 * s->n;
  from(m, Z, v, X);
  add(X, ch, X + v, v);
  for (size_t j = 0; j < k; j++) {
    add(X, h * h * m->x[k][j], a[j], v);
    add(X + v, h * m->v[k][j], a[j], v);
  }
}

void hk_sensitivity_arrive(const hk_sensitivity *s, const hk_taken_step *step, double *const a[HK_MOST_STAGES],
                           hk_carried *Z) {
  const hk_stages_facet *m = hk_sensitivity_method(s, step);
  const double h = step->h;
  size_t v = 3 * s->n;
  for (size_t e = 0; e < 2 * v && s->wide > 3 * v; e++) {
    double before = Z[e];
    if (m->back != 0) Z[e] += m->back * (before - Z[3 * v + e]);
    Z[3 * v + e] = before;
  }
  add(Z, (1 - m->back) * h, Z + v, v);
  for (size_t j = 0; j < m->count; j++) {
    add(Z, h * h * m->x_end[j], a[j], v);
    add(Z + v, h * m->v_end[j], a[j], v);
  }
  const double *last = a[m->count - 1];
  if (last != Z + 2 * v) memcpy(Z + 2 * v, last, v * sizeof *Z);
}
