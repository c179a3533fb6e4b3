/* Tangents: the derivative of each step, one after the other, for all parameters at once; and changes through a step,
 * which segments carry, too. */
#include "core/numerics/sensitivity/force_slopes.h"
#include "core/numerics/sensitivity/implicit_stage.h"
#include "core/numerics/sensitivity/linearised/linearised.h"
#include "core/numerics/sensitivity/projection.h"

#include <stdlib.h>
#include <string.h>

/* ---- what a parameter changes ---- */

static bool *unmoved_by(const hk_changes_plan *p, size_t j) { return p->unmoved + j * p->forces; }

/* What does not change is not compared: its difference is 0, but for rounding. */
static hk_status find_unmoved(hk_changes_plan *p, const hk_dynamics *d, const hk_varied *by) {
  hk_force_slopes forces;
  p->forces = d->split.forces;
  p->unmoved = calloc(p->count * (p->forces + 1) + 1, sizeof *p->unmoved);
  if (!p->unmoved) return HK_NO_MEMORY;
  hk_status status = hk_force_slopes_open(&forces, d, NULL);
  p->none = p->unmoved + p->count * p->forces;
  for (size_t j = 0; j < p->count && status == HK_OK; j++)
    p->none[j] = hk_force_slopes_unmoved(&forces, &by[j], unmoved_by(p, j));
  hk_force_slopes_close(&forces, d);
  return status;
}

/* What the forces with `along` take along with the change of the state. */
static hk_status find_changes(hk_changes_plan *p, const hk_sensitivity *s, const hk_varied *by) {
  hk_force_slopes forces;
  hk_status status = hk_force_slopes_open(&forces, s->dynamics, s->exact);
  for (size_t j = 0; j < p->count && status == HK_OK; j++) {
    bool *unmoved = unmoved_by(p, j);
    if (p->none[j] || !hk_force_slopes_fit(&forces, s->dynamics, &by[j])) continue;
    status = hk_force_changes_open(&p->changes[j], &forces, s->dynamics, &by[j]);
    p->none[j] = !hk_varied_moves_pins(&by[j]);
    for (size_t k = 0; k < p->forces; k++) {
      unmoved[k] |= forces.covers[k];
      p->none[j] &= unmoved[k];
    }
  }
  hk_force_slopes_close(&forces, s->dynamics);
  return status;
}

/* Linear steps compare matrices between scenes, whose rounding is that of the forces compared: what a stiff force's
 * number makes of both is larger than what it makes of their sum. */
hk_status hk_changes_plan_open(hk_changes_plan *p, const hk_sensitivity *s, const hk_varied *by, size_t count) {
  *p = (hk_changes_plan){.count = count, .changes = calloc(count + 1, sizeof *p->changes)};
  p->still = calloc(9 * s->n + 1, sizeof *p->still);
  p->along = p->still ? p->still + 6 * s->n : NULL;
  hk_status status = p->changes && p->still ? find_unmoved(p, s->dynamics, by) : HK_NO_MEMORY;
  return status == HK_OK && !s->linearised ? find_changes(p, s, by) : status;
}

hk_status hk_changes_plan_slope(const hk_changes_plan *p, hk_sensitivity *s, const hk_stage_point *point,
                                const hk_varied *by, size_t j, double *own) {
  size_t v = 3 * s->n;
  hk_status status = HK_OK;
  memset(own, 0, v * sizeof *own);
  if (!p->none[j]) status = hk_sensitivity_by_parameter(s, point, by, unmoved_by(p, j), own);
  if (!p->changes[j].memory || status != HK_OK) return status;
  status = hk_sensitivity_products(s, point, 1, 0, p->still, &p->changes[j], p->along);
  for (size_t e = 0; e < v; e++) own[e] += p->along[e];
  return status;
}

void hk_changes_plan_close(hk_changes_plan *p, const hk_sensitivity *s) {
  for (size_t j = 0; p->changes && j < p->count; j++) hk_force_changes_close(&p->changes[j], s->dynamics);
  free(p->changes);
  free(p->unmoved);
  free(p->still);
}

/* ---- through a step ---- */

static hk_status carry_stage(hk_sensitivity *s, const hk_taken_step *step, size_t k, hk_carried_changes *c) {
  size_t v = 3 * s->n;
  bool evaluates = hk_sensitivity_evaluates(s, step, k);
  for (size_t j = 0; j < c->count; j++) {
    double *a[HK_MOST_STAGES], *dZ = c->dZ + j * c->apart;
    for (size_t i = 0; i < s->stages; i++) a[i] = c->a[i] + j * c->apart;
    if (evaluates)
      hk_sensitivity_stage(s, step, k, dZ, a, c->stage + j * c->apart);
    else
      memcpy(a[k], dZ + 2 * v, v * sizeof *dZ);
  }
  if (!evaluates) return HK_OK;
  hk_status status = c->accelerations(c->context, k);
  if (status != HK_OK || !hk_implicit_stage_is(hk_sensitivity_method(s, step), k)) return status;
  status = hk_implicit_stage_linearise(s, step, k, false);
  for (size_t j = 0; j < c->count && status == HK_OK; j++) status = hk_implicit_stage_pass(s, c->a[k] + j * c->apart);
  return status;
}

static hk_status carry_projected(hk_sensitivity *s, const hk_taken_step *step, hk_carried_changes *c) {
  size_t v = 3 * s->n, last = s->method->count - 1;
  hk_status status = carry_stage(s, step, 0, c);
  if (status == HK_OK) status = hk_projection_drift(s, step, c->count, c->apart, c->a[0], c->by, c->dZ, c->stage);
  if (status == HK_OK && last > 0) status = c->accelerations(c->context, last);
  for (size_t j = 0; j < c->count && status == HK_OK && last > 0; j++) {
    double *a = c->a[last] + j * c->apart, *dZ = c->dZ + j * c->apart;
    for (size_t e = 0; e < v; e++) dZ[v + e] += step->h * s->method->v_end[last] * a[e];
    memcpy(dZ + 2 * v, a, v * sizeof *a);
  }
  return status == HK_OK ? hk_projection_settle(s, step, c->count, c->apart, c->by, c->dZ) : status;
}

hk_status hk_carried_changes_step(hk_sensitivity *s, const hk_taken_step *step, hk_carried_changes *c) {
  hk_status status = HK_OK;
  if (s->projection) return carry_projected(s, step, c);
  for (size_t k = 0; k < hk_sensitivity_method(s, step)->count && status == HK_OK; k++)
    status = carry_stage(s, step, k, c);
  for (size_t j = 0; j < c->count && status == HK_OK; j++) {
    double *a[HK_MOST_STAGES];
    for (size_t i = 0; i < s->stages; i++) a[i] = c->a[i] + j * c->apart;
    hk_sensitivity_arrive(s, step, a, c->dZ + j * c->apart);
  }
  return status;
}

/* ---- through the steps ---- */

typedef struct tangents {
  hk_sensitivity *s;
  const hk_varied *by;
  hk_carried *Z;
  hk_carried_changes of; /* every parameter */
  double *own;           /* 3n, da/dp */
  hk_changes_plan plan;
} tangents;

/* The changes of the accelerations of stage k at the point that `stage` changes. */
static hk_status accelerations_of(void *context, size_t k) {
  tangents *w = context;
  hk_sensitivity *s = w->s;
  size_t v = 3 * s->n;
  hk_status status =
      hk_sensitivity_products(s, &s->point[k], w->of.count, w->of.apart, w->of.stage, w->plan.changes, w->of.a[k]);
  for (size_t j = 0; j < w->of.count && status == HK_OK; j++) {
    if (w->plan.none[j]) continue;
    status = hk_sensitivity_by_parameter(s, &s->point[k], &w->by[j], unmoved_by(&w->plan, j), w->own);
    for (size_t e = 0; e < v; e++) w->of.a[k][j * w->of.apart + e] += w->own[e];
  }
  return status;
}

static hk_status linear(tangents *w, const hk_taken_step *step) {
  hk_sensitivity *s = w->s;
  for (size_t j = 0; j < w->of.count; j++)
    hk_linearised_place(s, step, w->of.dZ + j * w->of.apart, w->of.stage + j * w->of.apart);
  hk_status status = accelerations_of(w, 0);
  for (size_t j = 0; j < w->of.count && status == HK_OK; j++) {
    size_t at = j * w->of.apart;
    status = hk_linearised_tangent(s, step, &w->by[j], w->of.stage + at, w->of.a[0] + at, w->of.dZ + at);
  }
  return status;
}

static hk_status step_of(tangents *w, size_t number) {
  hk_sensitivity *s = w->s;
  const hk_taken_step *step = &s->step[number];
  hk_status status = hk_sensitivity_repeat(s, number, w->Z);
  if (step->linear) return status == HK_OK ? linear(w, step) : status;
  return status == HK_OK ? hk_carried_changes_step(s, step, &w->of) : status;
}

static hk_status all_steps(tangents *w, hk_sensitivity_watch *watch, void *context) {
  hk_sensitivity *s = w->s;
  memcpy(w->Z, s->kept, w->of.apart * sizeof *w->Z);
  for (size_t j = 0; j < w->of.count; j++) hk_sensitivity_start(&w->by[j], s->n, w->of.dZ + j * w->of.apart);
  hk_status status = watch && s->steps ? watch(context, s->step[0].t, w->Z, w->of.dZ) : HK_OK;
  for (size_t k = 0; k < s->steps && status == HK_OK; k++) {
    status = step_of(w, k);
    double t = k + 1 < s->steps ? s->step[k + 1].t : s->loop->state->t;
    if (status == HK_OK && watch) status = watch(context, t, w->Z, w->of.dZ);
  }
  return status;
}

hk_status hk_sensitivity_tangents(hk_sensitivity *s, const hk_varied *by, size_t count, hk_sensitivity_watch *watch,
                                  void *context, hk_error *error) {
  tangents w = {.s = s, .by = by, .of = {.count = count, .apart = s->wide, .accelerations = accelerations_of}};
  size_t all = s->wide * count;
  w.of.context = &w;
  double *memory = calloc(s->wide + (2 + s->stages) * all + 3 * s->n, sizeof *memory);
  if (!memory || hk_changes_plan_open(&w.plan, s, by, count) != HK_OK) {
    free(memory);
    hk_changes_plan_close(&w.plan, s);
    return hk_error_set(error, HK_NO_MEMORY, "no memory for %zu tangents", count);
  }
  w.Z = memory;
  w.of.dZ = w.Z + s->wide;
  w.of.stage = w.of.dZ + all;
  for (size_t k = 0; k < s->stages; k++) w.of.a[k] = w.of.stage + (k + 1) * all;
  w.own = w.of.stage + (s->stages + 1) * all;
  hk_sensitivity_untape(s);
  hk_projection_slopes *by_constraints = NULL;
  hk_status status = s->projection ? hk_projection_vary(s, by, count, &by_constraints, error) : HK_OK;
  w.of.by = by_constraints;
  if (status == HK_OK) status = all_steps(&w, watch, context);
  free(by_constraints);
  hk_changes_plan_close(&w.plan, s);
  free(memory);
  if (status != HK_OK && error->status == HK_OK) hk_error_set(error, status, "%s", s->dynamics->error->text);
  return status;
}
