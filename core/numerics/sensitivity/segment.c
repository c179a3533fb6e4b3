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
  size_t controls;
  double begin, end;     /* s, of the knots */
  hk_carried_changes of; /* 6n of the state, then two of every function of time */
  double *own;
  hk_changes_plan plan;
} segment;

/* What the values at both knots do at the time of stage k. */
static hk_status add_controls(segment *w, size_t k) {
  const hk_stage_point *p = &w->s->point[k];
  double part = (p->t - w->begin) / (w->end - w->begin);
  size_t v = 3 * w->s->n;
  hk_status status = HK_OK;
  for (size_t j = 0; j < w->controls && status == HK_OK; j++) {
    double *first = w->of.a[k] + (2 * v + 2 * j) * w->of.apart, *second = first + w->of.apart;
    status = hk_changes_plan_slope(&w->plan, w->s, p, &w->by[j], j, w->own);
    for (size_t e = 0; e < v; e++) {
      first[e] += (1 - part) * w->own[e];
      second[e] += part * w->own[e];
    }
  }
  return status;
}

/* The changes of the accelerations of stage k at the point that `stage` changes. */
static hk_status accelerations_of(void *context, size_t k) {
  segment *w = context;
  hk_status status =
      hk_sensitivity_products(w->s, &w->s->point[k], w->of.count, w->of.apart, w->of.stage, NULL, w->of.a[k]);
  return status == HK_OK ? add_controls(w, k) : status;
}

/* The state at the first knot is put onto the constraints, off which unknown positions may be: so the segment is a map
 * of all numbers, and does not change where they change across the constraints. */
static hk_status place(segment *w, const hk_taken_step *step, hk_carried *Z) {
  hk_sensitivity *s = w->s;
  size_t v = 3 * s->n;
  hk_status status = hk_projection_place(s, step, Z);
  for (size_t j = 0; j < w->of.count; j++) {
    double *dv = w->of.dZ + j * w->of.apart + v;
    memcpy(w->of.stage + j * w->of.apart + 2 * v, dv, v * sizeof *dv);
    memset(dv, 0, v * sizeof *dv);
  }
  if (status == HK_OK && w->of.count)
    status = hk_projection_drift(s, step, w->of.count, w->of.apart, w->of.a[0], NULL, w->of.dZ,
                                 w->of.stage); /* a[0] is 0 yet */
  for (size_t j = 0; j < w->of.count; j++)
    memcpy(w->of.dZ + j * w->of.apart + v, w->of.stage + j * w->of.apart + 2 * v, v * sizeof *w->of.dZ);
  if (status == HK_OK && w->of.count) status = hk_projection_settle(s, step, w->of.count, w->of.apart, NULL, w->of.dZ);
  return status;
}

static hk_status step_of(segment *w, const hk_taken_step *step, hk_carried *Z) {
  hk_status status = hk_sensitivity_step(w->s, step, Z);
  return status == HK_OK && w->of.count ? hk_carried_changes_step(w->s, step, &w->of) : status;
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
  segment w = {.s = s,
               .by = by,
               .controls = controls,
               .of = {.count = columns, .apart = size, .accelerations = accelerations_of}};
  w.of.context = &w;
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
  w.of.dZ = Z + size;
  w.of.stage = w.of.dZ + columns * size;
  for (size_t k = 0; k < s->stages; k++) w.of.a[k] = w.of.stage + (k + 1) * columns * size;
  w.own = w.of.stage + (s->stages + 1) * columns * size;
  w.begin = s->step[first].t;
  w.end = last > first ? s->step[last - 1].t + s->step[last - 1].h : w.begin;
  memcpy(Z, X, 2 * v * sizeof *X);
  for (size_t j = 0; j < 2 * v && columns; j++) w.of.dZ[j * size + j] = 1;
  hk_sensitivity_untape(s);
  hk_status status = all_steps(&w, first, last, Z);
  memcpy(X, Z, 2 * v * sizeof *X);
  for (size_t j = 0; j < columns; j++) memcpy(J + j * 2 * v, w.of.dZ + j * size, 2 * v * sizeof *J);
  hk_changes_plan_close(&w.plan, s);
  free(memory);
  if (status != HK_OK && error->status == HK_OK) hk_error_set(error, status, "%s", s->dynamics->error->text);
  return status;
}
