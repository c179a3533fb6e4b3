/* A step by the stages of its method, as it is taken again. */
#include "core/numerics/sensitivity/implicit_stage.h"

#include <string.h>

bool hk_sensitivity_evaluates(const hk_sensitivity *s, const hk_taken_step *step, size_t k) {
  return k > 0 || !s->method->carries || step->fresh;
}

hk_status hk_sensitivity_evaluate(hk_dynamics *d, double t, double *X, double *a) {
  double power; /* scenes with channels are refused: the work is all that X has beside x and v */
  size_t v = 3 * d->system.n;
  return hk_evaluate_accelerations(&d->system, t, X, X + v, NULL, a, &power);
}

void hk_sensitivity_stage(const hk_sensitivity *s, const hk_taken_step *step, size_t k, const hk_carried *Z,
                          double *const a[HK_MOST_STAGES], double *X) {
  const hk_stages_facet *m = s->method;
  const double h = step->h, ch = m->c[k] * h;
  size_t v = 3 * s->n;
  for (size_t e = 0; e < v; e++) {
    X[e] = Z[e] + ch * Z[v + e];
    X[v + e] = Z[v + e];
  }
  for (size_t j = 0; j < k; j++)
    for (size_t e = 0; e < v; e++) {
      X[e] += h * h * m->x[k][j] * a[j][e];
      X[v + e] += h * m->v[k][j] * a[j][e];
    }
}

void hk_sensitivity_arrive(const hk_sensitivity *s, const hk_taken_step *step, double *const a[HK_MOST_STAGES],
                           hk_carried *Z) {
  const hk_stages_facet *m = s->method;
  const double h = step->h;
  size_t v = 3 * s->n;
  for (size_t e = 0; e < v; e++) Z[e] += h * Z[v + e];
  for (size_t j = 0; j < m->count; j++)
    for (size_t e = 0; e < v; e++) {
      Z[e] += h * h * m->x_end[j] * a[j][e];
      Z[v + e] += h * m->v_end[j] * a[j][e];
    }
  memcpy(Z + 2 * v, a[m->count - 1], v * sizeof *Z);
}

/* ---- the tape ---- */

static void put_points(hk_sensitivity *s, double *at) {
  for (size_t k = 0; k < s->method->count; k++) {
    s->point[k].X = at + 9 * s->n * k;
    s->point[k].a = s->point[k].X + 6 * s->n;
  }
}

void hk_sensitivity_untape(hk_sensitivity *s) { put_points(s, s->scratch + 15 * s->n); }

void hk_sensitivity_rewind(hk_sensitivity *s, size_t step) {
  put_points(s, s->tape + (step - s->first) * s->method->count * 9 * s->n);
  for (size_t k = 0; k < s->method->count; k++) s->point[k].t = s->step[step].t + s->method->c[k] * s->step[step].h;
}

hk_status hk_sensitivity_record(hk_sensitivity *s, size_t first, size_t last, hk_carried *Z) {
  hk_status status = HK_OK;
  s->first = first;
  s->taped = 0;
  for (size_t i = first; i < last && status == HK_OK; i++) {
    hk_sensitivity_rewind(s, i);
    status = hk_sensitivity_step(s, &s->step[i], Z);
    s->taped += status == HK_OK;
  }
  return status;
}

/* ---- a step ---- */

hk_status hk_sensitivity_step(hk_sensitivity *s, const hk_taken_step *step, hk_carried *Z) {
  double *a[HK_MOST_STAGES];
  size_t v = 3 * s->n;
  for (size_t k = 0; k < s->method->count; k++) {
    hk_stage_point *p = &s->point[k];
    p->t = step->t + s->method->c[k] * step->h;
    a[k] = hk_sensitivity_evaluates(s, step, k) ? p->a : Z + 2 * v; /* which is overwritten when all is added */
    if (a[k] != p->a) continue;
    hk_sensitivity_stage(s, step, k, Z, a, p->X);
    bool implicit = hk_implicit_stage_is(s->method, k);
    if (implicit) memcpy(p->a, k > 0 ? a[k - 1] : Z + 2 * v, v * sizeof *Z); /* a guess */
    hk_status status = implicit ? hk_implicit_stage_settle(s, step, k, p->X, p->a)
                                : hk_sensitivity_evaluate(s->dynamics, p->t, p->X, p->a);
    if (status != HK_OK) return status;
  }
  hk_sensitivity_arrive(s, step, a, Z);
  return hk_dynamics_impose(s->dynamics, step->t + step->h, Z, Z + v);
}
