/* Steps taken again, with their points on the tape. */
#include "core/numerics/sensitivity/implicit_stage.h"
#include "core/numerics/sensitivity/linearised/linearised.h"
#include "core/numerics/sensitivity/projection.h"

#include <stdlib.h>
#include <string.h>

static void put_points(hk_sensitivity *s, double *at) {
  for (size_t k = 0; k < s->stages; k++) {
    s->point[k].X = at + 9 * s->n * k;
    s->point[k].a = s->point[k].X + 6 * s->n;
  }
  hk_projection_put(s, at + 9 * s->n * s->stages);
}

void hk_sensitivity_untape(hk_sensitivity *s) { put_points(s, s->scratch + 15 * s->n); }

void hk_sensitivity_rewind(hk_sensitivity *s, size_t step) {
  const hk_taken_step *taken = &s->step[step];
  const hk_stages_facet *m = hk_sensitivity_method(s, taken);
  put_points(s, s->tape + (step - s->first) * s->each);
  for (size_t k = 0; k < m->count; k++) s->point[k].t = taken->t + m->c[k] * taken->h;
  if (taken->linear) s->point[0].t = taken->t + taken->h;
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
  const hk_stages_facet *m = hk_sensitivity_method(s, step);
  double *a[HK_MOST_STAGES];
  size_t v = 3 * s->n;
  if (s->projection) return hk_projection_step(s, step, Z);
  if (step->linear) return hk_linearised_step(s, step, Z);
  for (size_t k = 0; k < m->count; k++) {
    hk_stage_point *p = &s->point[k];
    p->t = step->t + m->c[k] * step->h;
    a[k] = hk_sensitivity_evaluates(s, step, k) ? p->a : Z + 2 * v; /* which is overwritten when all is added */
    if (a[k] != p->a) continue;
    hk_sensitivity_stage(s, step, k, Z, a, p->X);
    bool implicit = hk_implicit_stage_is(m, k);
    if (implicit) memcpy(p->a, k > 0 ? a[k - 1] : Z + 2 * v, v * sizeof *Z); /* a guess */
    hk_status status = implicit ? hk_implicit_stage_settle(s, step, k, p->X, p->a)
                                : hk_sensitivity_evaluate(s->dynamics, p->t, p->X, p->a);
    if (status != HK_OK) return status;
  }
  hk_sensitivity_arrive(s, step, a, Z);
  return hk_dynamics_impose(s->dynamics, step->t + step->h, Z, Z + v);
}

/* Linear steps leave their factors as well, and steps with constraints more than their points. */
static bool is_taped(const hk_sensitivity *s, size_t step) {
  return !s->projection && !s->linearised && step >= s->first && step - s->first < s->taped;
}

hk_status hk_sensitivity_repeat(hk_sensitivity *s, size_t step, hk_carried *Z) {
  const hk_taken_step *taken = &s->step[step];
  double *a[HK_MOST_STAGES];
  if (!is_taped(s, step)) {
    hk_sensitivity_untape(s);
    return hk_sensitivity_step(s, taken, Z);
  }
  hk_sensitivity_rewind(s, step);
  for (size_t k = 0; k < s->stages; k++) a[k] = hk_sensitivity_evaluates(s, taken, k) ? s->point[k].a : Z + 6 * s->n;
  hk_sensitivity_arrive(s, taken, a, Z);
  return hk_dynamics_impose(s->dynamics, taken->t + taken->h, Z, Z + 3 * s->n);
}

hk_status hk_sensitivity_replay(hk_sensitivity *s, hk_dynamics *beside, double *X) {
  hk_dynamics *own = s->dynamics;
  hk_implicit_stage *of_own = s->implicit; /* whose factors are those of its own solver */
  hk_carried *Z = calloc(s->wide + 1, sizeof *Z);
  bool *projected = calloc(s->steps + 1, sizeof *projected); /* which they are in its own scene */
  if (of_own) s->implicit = hk_implicit_stage_create(s->n);
  hk_status status = Z && projected && (!of_own || s->implicit) ? HK_OK : HK_NO_MEMORY;
  for (size_t k = 0; k < s->steps && projected; k++) projected[k] = s->step[k].projected;
  if (status == HK_OK) memcpy(Z, beside->state->X, 6 * s->n * sizeof *Z);
  s->dynamics = beside;
  hk_sensitivity_untape(s);
  for (size_t k = 0; k < s->steps && status == HK_OK; k++) status = hk_sensitivity_step(s, &s->step[k], Z);
  for (size_t k = 0; k < s->steps && projected; k++) s->step[k].projected = projected[k];
  s->dynamics = own;
  if (of_own) hk_implicit_stage_free(s->implicit);
  s->implicit = of_own;
  if (status == HK_OK) memcpy(X, Z, 6 * s->n * sizeof *X);
  free(projected);
  free(Z);
  return status;
}
