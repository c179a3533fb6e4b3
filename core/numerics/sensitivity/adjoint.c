/* The adjoint: the transposed derivative of each step, from the last one to the first. */
#include "core/numerics/sensitivity/sensitivity.h"

#include <stdlib.h>
#include <string.h>

typedef struct adjoint {
  hk_sensitivity *s;
  const hk_varied *by;
  size_t count;
  hk_carried *L;             /* the adjoint of the state */
  hk_carried *segment;       /* the states of a segment */
  double *u[HK_MOST_STAGES]; /* 3n, the adjoint of a stage's acceleration */
  double *dX;                /* 6n, that of its point */
  double *own;               /* 3n, da/dp */
  double *slope;
} adjoint;

/* What the end of a step asks of the accelerations; L becomes what it asks of the state at the begin. */
static void depart(const adjoint *w, const hk_taken_step *step) {
  const hk_stages_facet *m = w->s->method;
  double h = step->h, *L = w->L;
  size_t v = 3 * w->s->n;
  for (size_t k = 0; k < m->count; k++)
    for (size_t e = 0; e < v; e++) w->u[k][e] = h * h * m->x_end[k] * L[e] + h * m->v_end[k] * L[v + e];
  for (size_t e = 0; e < v; e++) w->u[m->count - 1][e] += L[2 * v + e];
  for (size_t e = 0; e < v; e++) L[v + e] += h * L[e];
  memset(L + 2 * v, 0, v * sizeof *L);
}

/* What a function of time has at t is linear in the values at the knots beside. */
void hk_knots_note(const hk_knots *knots, double t, double slope) {
  size_t last = knots->count - 1;
  double at = (t - knots->begin) / (knots->end - knots->begin) * (double)last;
  if (!(at > 0)) at = 0;
  size_t k = at < (double)last ? (size_t)at : last - 1;
  double part = fmin(at - (double)k, 1);
  knots->slope[k] += (1 - part) * slope;
  knots->slope[k + 1] += part * slope;
}

static hk_status note_parameters(adjoint *w, size_t k) {
  const hk_stage_point *p = &w->s->point[k];
  hk_status status = HK_OK;
  for (size_t j = 0; j < w->count && status == HK_OK; j++) {
    double slope = 0;
    status = hk_sensitivity_by_parameter(w->s, p, &w->by[j], w->own);
    for (size_t e = 0; e < 3 * w->s->n; e++) slope += w->u[k][e] * w->own[e];
    w->slope[j] += slope;
    if (w->by[j].knots) hk_knots_note(w->by[j].knots, p->t, slope);
  }
  return status;
}

/* What stage k asks of the state and of the stages before. */
static hk_status stage_of(adjoint *w, const hk_taken_step *step, size_t k) {
  hk_sensitivity *s = w->s;
  const hk_stages_facet *m = s->method;
  const double h = step->h;
  size_t v = 3 * s->n;
  double *L = w->L, *dX = w->dX;
  if (!hk_sensitivity_evaluates(s, step, k)) {
    memcpy(L + 2 * v, w->u[k], v * sizeof *L);
    return HK_OK;
  }
  hk_status status = hk_sensitivity_transposed(s, &s->point[k], w->u[k], dX);
  for (size_t e = 0; e < v; e++) {
    L[e] += dX[e];
    L[v + e] += m->c[k] * h * dX[e] + dX[v + e];
  }
  for (size_t j = 0; j < k; j++)
    for (size_t e = 0; e < v; e++) w->u[j][e] += h * h * m->x[k][j] * dX[e] + h * m->v[k][j] * dX[v + e];
  return status == HK_OK ? note_parameters(w, k) : status;
}

/* The steps begin to end - 1, the last one first. */
static hk_status segment_of(adjoint *w, size_t begin, size_t end) {
  hk_sensitivity *s = w->s;
  size_t size = 9 * s->n;
  hk_status status = HK_OK;
  memcpy(w->segment, s->kept + begin / s->stride * size, size * sizeof *w->segment);
  for (size_t i = begin; i + 1 < end && status == HK_OK; i++) {
    hk_carried *next = w->segment + (i + 1 - begin) * size;
    memcpy(next, next - size, size * sizeof *next);
    status = hk_sensitivity_step(s, &s->step[i], next);
  }
  for (size_t i = end; i-- > begin && status == HK_OK;) {
    hk_carried *after = w->segment + (i - begin) * size;
    status = hk_sensitivity_step(s, &s->step[i], after);
    if (s->source && status == HK_OK) status = s->source(s->source_context, s->step[i].t + s->step[i].h, after, w->L);
    depart(w, &s->step[i]);
    for (size_t k = s->method->count; k-- > 0 && status == HK_OK;) status = stage_of(w, &s->step[i], k);
  }
  return status;
}

static hk_status all_steps(adjoint *w, double *X) {
  hk_sensitivity *s = w->s;
  hk_status status = HK_OK;
  memcpy(w->L, X, 6 * s->n * sizeof *X);
  memset(w->slope, 0, w->count * sizeof *w->slope);
  for (size_t j = 0; j < w->count; j++)
    if (w->by[j].knots) memset(w->by[j].knots->slope, 0, w->by[j].knots->count * sizeof(double));
  for (size_t end = s->steps; end > 0 && status == HK_OK;) {
    size_t begin = (end - 1) / s->stride * s->stride;
    status = segment_of(w, begin, end);
    end = begin;
  }
  if (s->source && status == HK_OK) status = s->source(s->source_context, s->steps ? s->step[0].t : 0, s->start, w->L);
  memcpy(X, w->L, 6 * s->n * sizeof *X);
  for (size_t j = 0; j < w->count && status == HK_OK; j++) {
    hk_sensitivity_start(&w->by[j], s->n, w->dX);
    for (size_t e = 0; e < 6 * s->n; e++) w->slope[j] += X[e] * w->dX[e];
  }
  return status;
}

hk_status hk_sensitivity_adjoint(hk_sensitivity *s, double *X, const hk_varied *by, size_t count, double *slope,
                                 hk_error *error) {
  size_t v = 3 * s->n;
  adjoint w = {.s = s, .by = by, .count = count, .slope = slope};
  if (!s->all_exact)
    return hk_error_set(error, HK_FAILED,
                        "force '%s' states no exact Jacobian, which the derivative backwards needs: take it forwards, "
                        "by parameters",
                        s->inexact);
  double *memory = calloc((6 + s->method->count + 3 * s->stride) * v, sizeof *memory);
  if (!memory) return hk_error_set(error, HK_NO_MEMORY, "no memory for an adjoint of %zu steps", s->steps);
  w.L = memory;
  w.dX = memory + 3 * v;
  w.own = memory + 5 * v;
  for (size_t k = 0; k < s->method->count; k++) w.u[k] = memory + (6 + k) * v;
  w.segment = memory + (6 + s->method->count) * v;
  hk_status status = all_steps(&w, X);
  free(memory);
  if (status != HK_OK && !*error->text) hk_error_set(error, status, "%s", s->dynamics->error->text);
  return status;
}
