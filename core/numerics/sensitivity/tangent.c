/* Tangents: the derivative of each step, one after the other, for all parameters at once. */
#include "core/numerics/sensitivity/force_slopes.h"
#include "core/numerics/sensitivity/implicit_stage.h"
#include "core/numerics/sensitivity/linearised/linearised.h"
#include "core/numerics/sensitivity/projection.h"

#include <stdlib.h>
#include <string.h>

typedef struct tangents {
  hk_sensitivity *s;
  const hk_varied *by;
  size_t count, apart;       /* of parameters; numbers of one */
  hk_carried *Z, *dZ;        /* of the state, and of every parameter */
  double *stage;             /* of every parameter: the change of the stage's x and v, unused, */
  double *a[HK_MOST_STAGES]; /* of every parameter, of which the first 3n are the change of the acceleration */
  double *own;               /* 3n, da/dp */
  size_t forces;
  bool *unmoved, *none; /* of every parameter: the forces that it does not change; whether it changes none */
  hk_projection_slopes *by_constraints;
} tangents;

/* The changes of the accelerations of stage k at the point that `stage` changes. */
static hk_status accelerations_of(tangents *w, size_t k) {
  hk_sensitivity *s = w->s;
  size_t v = 3 * s->n;
  hk_status status = hk_sensitivity_products(s, &s->point[k], w->count, w->apart, w->stage, w->a[k]);
  for (size_t j = 0; j < w->count && status == HK_OK; j++) {
    if (w->none[j]) continue;
    status = hk_sensitivity_by_parameter(s, &s->point[k], &w->by[j], w->unmoved + j * w->forces, w->own);
    for (size_t e = 0; e < v; e++) w->a[k][j * w->apart + e] += w->own[e];
  }
  return status;
}

static hk_status stage_of(tangents *w, const hk_taken_step *step, size_t k) {
  hk_sensitivity *s = w->s;
  size_t v = 3 * s->n;
  for (size_t j = 0; j < w->count; j++) {
    double *a[HK_MOST_STAGES], *dZ = w->dZ + j * w->apart;
    for (size_t i = 0; i < s->stages; i++) a[i] = w->a[i] + j * w->apart;
    if (!hk_sensitivity_evaluates(s, step, k)) memcpy(a[k], dZ + 2 * v, v * sizeof *dZ);
    hk_sensitivity_stage(s, step, k, dZ, a, w->stage + j * w->apart);
  }
  if (!hk_sensitivity_evaluates(s, step, k)) return HK_OK;
  hk_status status = accelerations_of(w, k);
  if (status != HK_OK || !hk_implicit_stage_is(hk_sensitivity_method(s, step), k)) return status;
  status = hk_implicit_stage_linearise(s, step, k, false);
  for (size_t j = 0; j < w->count && status == HK_OK; j++) status = hk_implicit_stage_pass(s, w->a[k] + j * w->apart);
  return status;
}

/* A step with constraints. */
static hk_status projected(tangents *w, const hk_taken_step *step) {
  hk_sensitivity *s = w->s;
  size_t v = 3 * s->n, last = s->method->count - 1;
  hk_status status = HK_OK;
  if (hk_sensitivity_evaluates(s, step, 0))
    status = stage_of(w, step, 0);
  else
    for (size_t j = 0; j < w->count; j++)
      memcpy(w->a[0] + j * w->apart, w->dZ + j * w->apart + 2 * v, v * sizeof *w->dZ);
  if (status == HK_OK)
    status = hk_projection_drift(s, step, w->count, w->apart, w->a[0], w->by_constraints, w->dZ, w->stage);
  if (status == HK_OK && last > 0) status = accelerations_of(w, last);
  for (size_t j = 0; j < w->count && status == HK_OK && last > 0; j++) {
    double *a = w->a[last] + j * w->apart, *dZ = w->dZ + j * w->apart;
    for (size_t e = 0; e < v; e++) dZ[v + e] += step->h * s->method->v_end[last] * a[e];
    memcpy(dZ + 2 * v, a, v * sizeof *a);
  }
  return status == HK_OK ? hk_projection_settle(s, step, w->count, w->apart, w->by_constraints, w->dZ) : status;
}

static hk_status linear(tangents *w, const hk_taken_step *step) {
  hk_sensitivity *s = w->s;
  for (size_t j = 0; j < w->count; j++) hk_linearised_place(s, step, w->dZ + j * w->apart, w->stage + j * w->apart);
  hk_status status = accelerations_of(w, 0);
  for (size_t j = 0; j < w->count && status == HK_OK; j++) {
    size_t at = j * w->apart;
    status = hk_linearised_tangent(s, step, &w->by[j], w->stage + at, w->a[0] + at, w->dZ + at);
  }
  return status;
}

static hk_status step_of(tangents *w, const hk_taken_step *step) {
  hk_sensitivity *s = w->s;
  hk_status status = hk_sensitivity_step(s, step, w->Z);
  if (s->projection) return status == HK_OK ? projected(w, step) : status;
  if (step->linear) return status == HK_OK ? linear(w, step) : status;
  for (size_t k = 0; k < hk_sensitivity_method(s, step)->count && status == HK_OK; k++) status = stage_of(w, step, k);
  for (size_t j = 0; j < w->count && status == HK_OK; j++) {
    double *a[HK_MOST_STAGES];
    for (size_t i = 0; i < s->stages; i++) a[i] = w->a[i] + j * w->apart;
    hk_sensitivity_arrive(s, step, a, w->dZ + j * w->apart);
  }
  return status;
}

static hk_status all_steps(tangents *w, hk_sensitivity_watch *watch, void *context) {
  hk_sensitivity *s = w->s;
  memcpy(w->Z, s->kept, w->apart * sizeof *w->Z);
  for (size_t j = 0; j < w->count; j++) hk_sensitivity_start(&w->by[j], s->n, w->dZ + j * w->apart);
  hk_status status = watch && s->steps ? watch(context, s->step[0].t, w->Z, w->dZ) : HK_OK;
  for (size_t k = 0; k < s->steps && status == HK_OK; k++) {
    status = step_of(w, &s->step[k]);
    double t = k + 1 < s->steps ? s->step[k + 1].t : s->loop->state->t;
    if (status == HK_OK && watch) status = watch(context, t, w->Z, w->dZ);
  }
  return status;
}

/* What does not change is not compared: its difference is 0, but for rounding. */
static hk_status find_unmoved(tangents *w) {
  hk_dynamics *d = w->s->dynamics;
  hk_force_slopes forces;
  w->forces = d->split.forces;
  w->unmoved = calloc(w->count * (w->forces + 1) + 1, sizeof *w->unmoved);
  hk_status status = w->unmoved ? hk_force_slopes_open(&forces, d) : HK_NO_MEMORY;
  if (!w->unmoved) return status;
  w->none = w->unmoved + w->count * w->forces;
  for (size_t j = 0; j < w->count && status == HK_OK; j++)
    w->none[j] = hk_force_slopes_unmoved(&forces, &w->by[j], w->unmoved + j * w->forces);
  hk_force_slopes_close(&forces, d);
  return status;
}

hk_status hk_sensitivity_tangents(hk_sensitivity *s, const hk_varied *by, size_t count, hk_sensitivity_watch *watch,
                                  void *context, hk_error *error) {
  tangents w = {.s = s, .by = by, .count = count, .apart = s->wide};
  size_t all = w.apart * count;
  double *memory = calloc(w.apart + (2 + s->stages) * all + 3 * s->n, sizeof *memory);
  if (!memory || find_unmoved(&w) != HK_OK) {
    free(memory);
    free(w.unmoved);
    return hk_error_set(error, HK_NO_MEMORY, "no memory for %zu tangents", count);
  }
  w.Z = memory;
  w.dZ = w.Z + w.apart;
  w.stage = w.dZ + all;
  for (size_t k = 0; k < s->stages; k++) w.a[k] = w.stage + (k + 1) * all;
  w.own = w.stage + (s->stages + 1) * all;
  hk_sensitivity_untape(s);
  hk_status status = s->projection ? hk_projection_vary(s, by, count, &w.by_constraints, error) : HK_OK;
  if (status == HK_OK) status = all_steps(&w, watch, context);
  free(w.by_constraints);
  free(w.unmoved);
  free(memory);
  if (status != HK_OK && error->status == HK_OK) hk_error_set(error, status, "%s", s->dynamics->error->text);
  return status;
}
