/* See safe_move.h. */
#include "plugins/common/implicit/safe_move.h"

#include <float.h>
#include <string.h>

static const double sufficient = 1e-4, rounding = 64 * DBL_EPSILON;

hk_status hk_safe_part(hk_system *s, double t, const double *X, const double *dx, double *scratch, double *part) {
  for (size_t e = 0; e < 3 * s->n; e++) scratch[e] = X[e] + dx[e];
  *part = 1;
  hk_status status = s->contact->update(s, t, X, scratch);
  if (status == HK_OK) *part = s->contact->step_limit(s, t, X, dx);
  return status;
}

/* The safe fraction of the line from s->X to the positions of the stage, with the pins of its time imposed. */
static hk_status part_of_start(hk_system *s, const hk_stage *stage, double *dx, double *scratch, double *part) {
  s->impose(s, stage->t, stage->X, stage->X + 3 * s->n);
  for (size_t e = 0; e < 3 * s->n; e++) dx[e] = stage->X[e] - s->X[e];
  return hk_safe_part(s, stage->t, s->X, dx, scratch, part);
}

hk_status hk_safe_start(hk_system *s, const hk_stage *stage, double *dx, double *scratch, bool *safe) {
  size_t m = 3 * s->n;
  double *X = stage->X, *v = X + m, part = 1;
  for (size_t e = 0; e < m; e++) X[e] = stage->base[e] + stage->g * v[e];
  hk_status status = part_of_start(s, stage, dx, scratch, &part);
  *safe = part >= 1;
  if (status != HK_OK || *safe) return status;
  for (size_t e = 0; e < m; e++) {
    v[e] = (s->X[e] - stage->base[e]) / stage->g;
    X[e] = s->X[e];
  }
  status = part_of_start(s, stage, dx, scratch, &part);
  *safe = part >= 1;
  return status;
}

hk_status hk_safe_end(hk_system *s, double t, const double *stage, const double *X, double *dx, double *scratch) {
  double part = 1;
  for (size_t e = 0; e < 3 * s->n; e++) dx[e] = X[e] - stage[e];
  hk_status status = hk_safe_part(s, t, stage, dx, scratch, &part);
  if (status != HK_OK || part >= 1) return status;
  return s->host->fail(s->host, HK_NOT_CONVERGED,
                       "the step to t = %.17g s ends behind a contact that its stage keeps clear of: it is too long",
                       t);
}

bool hk_stage_minimises(const hk_system *s) {
  bool all = s->contact;
  for (size_t k = 0; k < s->split->forces; k++) all &= !s->split->takes[k] || s->split->force[k].gradient;
  return all && hk_system_equations(s) == 0;
}

hk_status hk_stage_potential(hk_system *s, const hk_stage *stage, double *value) {
  const double *v = stage->X + 3 * s->n, *base = stage->base + 3 * s->n;
  double inertia = 0, energy = 0;
  hk_status (*potential)(hk_system *, double, const double *, double *) =
      s->contact ? s->contact->potential : s->linear->potential;
  hk_status status = potential(s, stage->t, stage->X, &energy);
  *value = INFINITY;
  if (status != HK_OK) return status == HK_NOT_FINITE ? HK_OK : status;
  for (size_t i = 0; i < s->n; i++)
    for (size_t e = 3 * i; e < 3 * i + 3; e++) inertia += 0.5 * s->model->mass[i] * (v[e] - base[e]) * (v[e] - base[e]);
  *value = inertia + energy;
  return HK_OK;
}

bool hk_descent_falls(const hk_descent *d, double value, double alpha, bool level) {
  if (value <= d->start + sufficient * alpha * d->slope) return true;
  return level && isfinite(value) && value - d->start <= rounding * (fabs(value) + fabs(d->start));
}

/* Exchanges the velocities of the stage for others, and moves its positions with them. */
static void exchange(const hk_system *s, const hk_stage *stage, double *other) {
  double *x = stage->X, *v = x + 3 * s->n;
  for (size_t e = 0; e < 3 * s->n; e++) {
    double kept = v[e];
    v[e] = other[e];
    other[e] = kept;
    x[e] = stage->base[e] + stage->g * v[e];
  }
}

hk_status hk_stage_above_rest(hk_system *s, const hk_stage *stage, double power, double *rest, bool *above) {
  double here = 0, there = 0;
  const double *v = stage->X + 3 * s->n;
  memcpy(rest, v, 3 * s->n * sizeof *rest);
  s->filter(s, rest); /* what is free */
  for (size_t e = 0; e < 3 * s->n; e++) rest[e] = v[e] - rest[e];
  hk_status status = hk_stage_potential(s, stage, &here);
  if (status != HK_OK) return status;
  exchange(s, stage, rest);
  status = hk_stage_potential(s, stage, &there);
  exchange(s, stage, rest);
  *above = here > there + fmax(0, stage->g * power) + rounding * (fabs(here) + fabs(there));
  return status;
}
