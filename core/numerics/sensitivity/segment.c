/* The steps between two knots as a map of its own: from any state, not that of the run, with its derivatives by that
 * state and by the values of functions of time at the knots. What transcription makes its equations of (Bock and Plitt
 * 1984). */
#include "core/numerics/sensitivity/force_slopes.h"
#include "core/numerics/sensitivity/implicit_stage.h"
#include "core/numerics/sensitivity/projection.h"

#include <stdlib.h>
#include <string.h>

typedef struct segment {
  hk_sensitivity *s;
  const hk_varied *by;
  size_t controls, columns,
      apart;         /* 6n of the state, then two of every function of time; hk_sensitivity.wide numbers each */
  double begin, end; /* s, of the knots */
  double *dZ, *stage, *a[HK_MOST_STAGES], *own;
  hk_changes_plan plan;
} segment;

static void accelerations_of(const segment *w, size_t column, double *a[HK_MOST_STAGES]) {
  for (size_t i = 0; i < w->s->stages; i++) a[i] = w->a[i] + column * w->apart;
}

/* What the values at both knots do at the time of stage k. */
static hk_status add_controls(segment *w, size_t k) {
  const hk_stage_point *p = &w->s->point[k];
  double part = (p->t - w->begin) / (w->end - w->begin);
  size_t v = 3 * w->s->n;
  hk_status status = HK_OK;
  for (size_t j = 0; j < w->controls && status == HK_OK; j++) {
    double *first = w->a[k] + (2 * v + 2 * j) * w->apart, *second = first + w->apart;
    status = hk_changes_plan_slope(&w->plan, w->s, p, &w->by[j], j, w->own);
    for (size_t e = 0; e < v; e++) {
      first[e] += (1 - part) * w->own[e];
      second[e] += part * w->own[e];
    }
  }
  return status;
}

/* The changes of the accelerations of stage k at the point that `stage` changes. */
static hk_status changes_of(segment *w, size_t k) {
  hk_status status = hk_sensitivity_products(w->s, &w->s->point[k], w->columns, w->apart, w->stage, NULL, w->a[k]);
  return status == HK_OK ? add_controls(w, k) : status;
}

static hk_status stage_of(segment *w, const hk_taken_step *step, size_t k) {
  hk_sensitivity *s = w->s;
  size_t v = 3 * s->n;
  bool evaluates = hk_sensitivity_evaluates(s, step, k);
  for (size_t j = 0; j < w->columns; j++) {
    double *a[HK_MOST_STAGES], *dZ = w->dZ + j * w->apart;
    accelerations_of(w, j, a);
    if (!evaluates) memcpy(a[k], dZ + 2 * v, v * sizeof *dZ);
    hk_sensitivity_stage(s, step, k, dZ, a, w->stage + j * w->apart);
  }
  if (!evaluates) return HK_OK;
  hk_status status = changes_of(w, k);
  if (status != HK_OK || !hk_implicit_stage_is(hk_sensitivity_method(s, step), k)) return status;
  status = hk_implicit_stage_linearise(s, step, k, false);
  for (size_t j = 0; j < w->columns && status == HK_OK; j++) status = hk_implicit_stage_pass(s, w->a[k] + j * w->apart);
  return status;
}

/* The state at the first knot is put onto the constraints, off which unknown positions may be: so the segment is a map
 * of all numbers, and does not change where they change across the constraints. */
static hk_status place(segment *w, const hk_taken_step *step, hk_carried *Z) {
  hk_sensitivity *s = w->s;
  size_t v = 3 * s->n;
  hk_status status = hk_projection_place(s, step, Z);
  for (size_t j = 0; j < w->columns; j++) {
    double *dv = w->dZ + j * w->apart + v;
    memcpy(w->stage + j * w->apart + 2 * v, dv, v * sizeof *dv);
    memset(dv, 0, v * sizeof *dv);
  }
  if (status == HK_OK && w->columns)
    status = hk_projection_drift(s, step, w->columns, w->apart, w->a[0], NULL, w->dZ, w->stage); /* a[0] is 0 yet */
  for (size_t j = 0; j < w->columns; j++)
    memcpy(w->dZ + j * w->apart + v, w->stage + j * w->apart + 2 * v, v * sizeof *w->dZ);
  if (status == HK_OK && w->columns) status = hk_projection_settle(s, step, w->columns, w->apart, NULL, w->dZ);
  return status;
}

/* A step with constraints. */
static hk_status projected(segment *w, const hk_taken_step *step) {
  hk_sensitivity *s = w->s;
  size_t v = 3 * s->n, last = s->method->count - 1;
  hk_status status = HK_OK;
  if (hk_sensitivity_evaluates(s, step, 0))
    status = stage_of(w, step, 0);
  else
    for (size_t j = 0; j < w->columns; j++)
      memcpy(w->a[0] + j * w->apart, w->dZ + j * w->apart + 2 * v, v * sizeof *w->dZ);
  if (status == HK_OK) status = hk_projection_drift(s, step, w->columns, w->apart, w->a[0], NULL, w->dZ, w->stage);
  if (status == HK_OK && last > 0) status = changes_of(w, last);
  for (size_t j = 0; j < w->columns && status == HK_OK && last > 0; j++) {
    double *a = w->a[last] + j * w->apart, *dZ = w->dZ + j * w->apart;
    for (size_t e = 0; e < v; e++) dZ[v + e] += step->h * s->method->v_end[last] * a[e];
    memcpy(dZ + 2 * v, a, v * sizeof *a);
  }
  return status == HK_OK ? hk_projection_settle(s, step, w->columns, w->apart, NULL, w->dZ) : status;
}

static hk_status step_of(segment *w, const hk_taken_step *step, hk_carried *Z) {
  hk_sensitivity *s = w->s;
  hk_status status = hk_sensitivity_step(s, step, Z);
  if (s->projection) return status == HK_OK && w->columns ? projected(w, step) : status;
  for (size_t k = 0; k < hk_sensitivity_method(s, step)->count && status == HK_OK && w->columns; k++)
    status = stage_of(w, step, k);
  for (size_t j = 0; j < w->columns && status == HK_OK; j++) {
    double *a[HK_MOST_STAGES];
    accelerations_of(w, j, a);
    hk_sensitivity_arrive(s, step, a, w->dZ + j * w->apart);
  }
  return status;
}

static hk_status all_steps(segment *w, size_t first, size_t last, hk_carried *Z) {
  hk_status status = w->s->projection ? place(w, &w->s->step[first], Z) : HK_OK;
  for (size_t i = first; i < last && status == HK_OK; i++) {
    hk_taken_step step = w->s->step[i];
    step.fresh = step.fresh || i == first; /* nothing is carried over from another state */
    status = step_of(w, &step, Z);
  }
  return status;
}

hk_status hk_sensitivity_segment(hk_sensitivity *s, size_t first, size_t last, double *X, const hk_varied *by,
                                 size_t controls, double *J, hk_error *error) {
  size_t v = 3 * s->n, size = s->wide, columns = J ? 2 * v + 2 * controls : 0;
  segment w = {.s = s, .by = by, .controls = controls, .columns = columns, .apart = size};
  if (s->linearised)
    return hk_error_set(error, HK_FAILED,
                        "a linear step goes on from the linearisation before, which transcription has no unknowns for: "
                        "take --way shooting, or another method, with --integrator");
  double *memory = calloc(size + (2 + s->stages) * columns * size + v + 1, sizeof *memory);
  if (!memory || hk_changes_plan_open(&w.plan, s, by, columns ? controls : 0) != HK_OK) {
    hk_changes_plan_close(&w.plan, s);
    free(memory);
    return hk_error_set(error, HK_NO_MEMORY, "no memory for the derivatives of %zu steps", last - first);
  }
  double *Z = memory;
  w.dZ = Z + size;
  w.stage = w.dZ + columns * size;
  for (size_t k = 0; k < s->stages; k++) w.a[k] = w.stage + (k + 1) * columns * size;
  w.own = w.stage + (s->stages + 1) * columns * size;
  w.begin = s->step[first].t;
  w.end = last > first ? s->step[last - 1].t + s->step[last - 1].h : w.begin;
  memcpy(Z, X, 2 * v * sizeof *X);
  for (size_t j = 0; j < 2 * v && columns; j++) w.dZ[j * size + j] = 1;
  hk_sensitivity_untape(s);
  hk_status status = all_steps(&w, first, last, Z);
  memcpy(X, Z, 2 * v * sizeof *X);
  for (size_t j = 0; j < columns; j++) memcpy(J + j * 2 * v, w.dZ + j * size, 2 * v * sizeof *J);
  hk_changes_plan_close(&w.plan, s);
  free(memory);
  if (status != HK_OK && error->status == HK_OK) hk_error_set(error, status, "%s", s->dynamics->error->text);
  return status;
}
