/* The adjoint: the transposed derivative of each step, from the last one to the first. */
#include "core/numerics/sensitivity/force_slopes.h"
#include "core/numerics/sensitivity/implicit_stage.h"
#include "core/numerics/sensitivity/linearised/linearised.h"
#include "core/numerics/sensitivity/projection.h"

#include <stdlib.h>
#include <string.h>

typedef struct adjoint {
  hk_sensitivity *s;
  const hk_varied *by;
  size_t count;
  hk_carried *L, *Z;         /* the adjoint of the state; a state */
  hk_carried *segment;       /* the states after the steps of a segment; NULL: nobody asks for them */
  hk_force_slopes by_forces; /* by what forces are, for the parameters that `chained` has */
  bool *chained, any;        /* one per parameter, and whether it is true of any */
  bool compares;             /* some force is not covered: it is compared between runs */
  double *u[HK_MOST_STAGES]; /* 3n, the adjoint of a stage's acceleration */
  double *dX;                /* 6n, that of its point */
  double *own;               /* 3n, da/dp; 3n more of linear steps */
  double *slope;
  hk_projection_slopes *by_constraints;
  double *kept; /* da/dp of all points: those of `s->shared`, or to become these; NULL: not kept */
  bool known;   /* they are there */
} adjoint;

/* What the end of a step asks of the accelerations; L becomes what it asks of the state at the begin. */
static void depart(const adjoint *w, const hk_taken_step *step) {
  const hk_stages_facet *m = hk_sensitivity_method(w->s, step);
  double h = step->h, *L = w->L;
  size_t v = 3 * w->s->n;
  for (size_t k = 0; k < m->count; k++)
    for (size_t e = 0; e < v; e++) w->u[k][e] = h * h * m->x_end[k] * L[e] + h * m->v_end[k] * L[v + e];
  for (size_t e = 0; e < v; e++) w->u[m->count - 1][e] += L[2 * v + e];
  for (size_t e = 0; e < v; e++) L[v + e] += (1 - m->back) * h * L[e];
  memset(L + 2 * v, 0, v * sizeof *L);
}

/* Of x* and v* that of the states at both begins. */
static void pass_on(const adjoint *w, const hk_taken_step *step) {
  double back = hk_sensitivity_method(w->s, step)->back, *L = w->L, *before = L + 9 * w->s->n;
  for (size_t e = 0; e < 6 * w->s->n && w->s->wide > 9 * w->s->n; e++) {
    double at = L[e];
    L[e] = (1 + back) * at + before[e];
    before[e] = -back * at;
  }
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

static hk_status note_parameters(adjoint *w, const hk_taken_step *step, size_t k) {
  const hk_stage_point *p = &w->s->point[k];
  size_t v = 3 * w->s->n, at = ((size_t)(step - w->s->step) * w->s->stages + k) * w->count;
  hk_status status = HK_OK;
  for (size_t j = 0; j < w->count && status == HK_OK; j++) {
    double slope = 0, *own = w->kept ? w->kept + (at + j) * v : w->own;
    if (w->chained[j] && !w->compares && !hk_varied_moves_pins(&w->by[j])) continue;
    if (!w->known)
      status = hk_sensitivity_by_parameter(w->s, p, &w->by[j], w->chained[j] ? w->by_forces.covers : NULL, own);
    for (size_t e = 0; e < v; e++) slope += w->u[k][e] * own[e];
    w->slope[j] += slope;
    if (w->by[j].knots) hk_knots_note(w->by[j].knots, p->t, slope);
  }
  return status;
}

/* What stage k asks of the state and of the stages before. */
static hk_status stage_of(adjoint *w, const hk_taken_step *step, size_t k) {
  hk_sensitivity *s = w->s;
  const hk_stages_facet *m = hk_sensitivity_method(s, step);
  const double h = step->h;
  size_t v = 3 * s->n;
  double *L = w->L, *dX = w->dX;
  if (!hk_sensitivity_evaluates(s, step, k)) {
    memcpy(L + 2 * v, w->u[k], v * sizeof *L);
    return HK_OK;
  }
  hk_status status = HK_OK;
  if (hk_implicit_stage_is(m, k)) {
    status = hk_implicit_stage_linearise(s, step, k, true);
    if (status == HK_OK) status = hk_implicit_stage_pass(s, w->u[k]);
    if (status != HK_OK) return status;
  }
  status = hk_sensitivity_transposed(s, &s->point[k], w->u[k], dX, w->any ? &w->by_forces : NULL, NULL);
  for (size_t e = 0; e < v; e++) {
    L[e] += dX[e];
    L[v + e] += (m->c[k] - m->back) * h * dX[e] + dX[v + e];
  }
  for (size_t j = 0; j < k; j++)
    for (size_t e = 0; e < v; e++) w->u[j][e] += h * h * m->x[k][j] * dX[e] + h * m->v[k][j] * dX[v + e];
  return status == HK_OK ? note_parameters(w, step, k) : status;
}

/* A step with constraints. */
static hk_status projected(adjoint *w, const hk_taken_step *step) {
  hk_sensitivity *s = w->s;
  size_t v = 3 * s->n, last = s->method->count - 1;
  double *L = w->L, *end = L + 2 * v, *dX = w->dX;
  hk_status status = hk_projection_unsettle(s, step, L);
  for (size_t e = 0; e < v && last > 0; e++) w->u[last][e] = end[e] + step->h * s->method->v_end[last] * L[v + e];
  memset(end, 0, v * sizeof *end);
  if (last > 0 && status == HK_OK)
    status = hk_sensitivity_transposed(s, &s->point[last], w->u[last], dX, w->any ? &w->by_forces : NULL, NULL);
  if (last > 0 && status == HK_OK) status = note_parameters(w, step, last);
  for (size_t e = 0; e < v && last > 0; e++) {
    L[e] += dX[e];
    L[v + e] += 2 * dX[v + e]; /* the point's v is 2 v_m - v */
  }
  if (status == HK_OK) status = hk_projection_return(s, step, L, w->u[0]);
  for (size_t e = 0; e < v && last > 0; e++) L[v + e] -= dX[v + e];
  return status == HK_OK ? stage_of(w, step, 0) : status;
}

/* The matrices of a linear step, by parameters that the chain rule does not find. */
static hk_status note_matrices(adjoint *w, const hk_taken_step *step) {
  const hk_linear_point p = hk_linearised_at(w->s, step);
  size_t v = 3 * w->s->n, at = ((size_t)(step - w->s->step) * w->s->stages + 1) * w->count;
  hk_status status = HK_OK;
  for (size_t j = 0; j < w->count && status == HK_OK; j++) {
    double *c = w->kept ? w->kept + (at + j) * v : w->own, *d = w->kept ? c + w->count * v : w->own + v;
    if (w->chained[j] && !w->compares) continue;
    if (!w->known) {
      memset(c, 0, v * sizeof *c);
      memset(d, 0, v * sizeof *d);
      status = hk_linearised_by_parameter(w->s, &p, &w->by[j], w->chained[j] ? w->by_forces.covers : NULL, c, d);
    }
    double slope = hk_linearised_slope(w->s, &p, c, d);
    w->slope[j] += slope;
    if (w->by[j].knots) hk_knots_note(w->by[j].knots, p.t, slope);
  }
  return status;
}

static hk_status linear(adjoint *w, const hk_taken_step *step) {
  hk_sensitivity *s = w->s;
  hk_force_slopes *slopes = w->any ? &w->by_forces : NULL;
  hk_status status = hk_linearised_return(s, step, w->L, w->u[0]);
  if (status == HK_OK) status = hk_sensitivity_transposed(s, &s->point[0], w->u[0], w->dX, slopes, NULL);
  if (status == HK_OK) status = note_parameters(w, step, 0);
  if (status == HK_OK) status = hk_linearised_bend(s, step, w->dX, slopes);
  if (status == HK_OK) status = note_matrices(w, step);
  hk_linearised_depart(s, step, w->dX, w->L);
  return status;
}

static hk_status step_of(adjoint *w, const hk_taken_step *step) {
  hk_status status = HK_OK;
  if (step->linear) return linear(w, step);
  if (w->s->projection) return projected(w, step);
  depart(w, step);
  for (size_t k = hk_sensitivity_method(w->s, step)->count; k-- > 0 && status == HK_OK;) status = stage_of(w, step, k);
  pass_on(w, step);
  return status;
}

/* The points of the steps begin to end - 1, and the states after them where they are asked for. */
static hk_status have_segment(adjoint *w, size_t begin, size_t end) {
  hk_sensitivity *s = w->s;
  size_t size = s->wide;
  hk_status status = HK_OK;
  if (!w->segment && s->first == begin && s->taped == end - begin) return HK_OK;
  memcpy(w->Z, s->kept + begin / s->stride * size, size * sizeof *w->Z);
  if (!w->segment) return hk_sensitivity_record(s, begin, end, w->Z);
  s->first = begin;
  s->taped = 0;
  for (size_t i = begin; i < end && status == HK_OK; i++) {
    hk_sensitivity_rewind(s, i);
    status = hk_sensitivity_step(s, &s->step[i], w->Z);
    memcpy(w->segment + (i - begin) * 6 * s->n, w->Z, 6 * s->n * sizeof *w->Z);
    s->taped += status == HK_OK;
  }
  return status;
}

/* The steps begin to end - 1, the last one first. */
static hk_status segment_of(adjoint *w, size_t begin, size_t end) {
  hk_sensitivity *s = w->s;
  hk_status status = have_segment(w, begin, end);
  for (size_t i = end; i-- > begin && status == HK_OK;) {
    const double *after = w->segment ? w->segment + (i - begin) * 6 * s->n : NULL;
    hk_sensitivity_rewind(s, i);
    if (after) status = s->source(s->source_context, s->step[i].t + s->step[i].h, after, w->L);
    hk_riders_gather(&s->dynamics->state->model, w->L);
    hk_riders_gather(&s->dynamics->state->model, w->L + 3 * s->n);
    if (status == HK_OK) status = step_of(w, &s->step[i]);
  }
  return status;
}

/* By what forces and masses are, whatever steps. */
static hk_status prepare_slopes(adjoint *w) {
  hk_dynamics *d = w->s->dynamics;
  hk_status status = hk_force_slopes_open(&w->by_forces, d, NULL);
  w->chained = calloc(w->count + 1, sizeof *w->chained);
  if (status != HK_OK || !w->chained)
    return hk_error_set(d->error, HK_NO_MEMORY, "no memory for derivatives of forces");
  w->compares = !w->by_forces.all;
  for (size_t j = 0; j < w->count; j++) w->any |= w->chained[j] = hk_force_slopes_fit(&w->by_forces, d, &w->by[j]);
  return HK_OK;
}

/* Finds da/dp of an adjoint before, or room to keep them for one to come; without that they are found each time. */
static void share(adjoint *w) {
  hk_sensitivity *s = w->s;
  uint64_t chained = 0;
  if (w->count > 64) return;
  for (size_t j = 0; j < w->count; j++) chained |= (uint64_t)w->chained[j] << j;
  double points = (double)s->steps * (double)s->stages;
  double numbers = points * (double)w->count * 3 * (double)s->n;
  if (s->shared && s->shared_of == w->by && s->shared_count == w->count && s->shared_chained == chained) {
    w->kept = s->shared;
    w->known = true;
    return;
  }
  free(s->shared);
  s->shared = NULL;
  s->shared_chained = chained;
  if (s->stride >= s->steps && numbers * sizeof(double) <= HK_SHARED_MOST)
    w->kept = malloc(((size_t)numbers + 1) * sizeof *w->kept);
}

static void keep_shared(adjoint *w, bool whole) {
  if (w->known || !w->kept) return;
  if (!whole) {
    free(w->kept);
    return;
  }
  w->s->shared = w->kept;
  w->s->shared_of = w->by;
  w->s->shared_count = w->count;
}

static hk_status all_steps(adjoint *w, double *X) {
  hk_sensitivity *s = w->s;
  hk_status status = prepare_slopes(w);
  if (status == HK_OK) share(w);
  memcpy(w->L, X, 6 * s->n * sizeof *X);
  memset(w->slope, 0, w->count * sizeof *w->slope);
  for (size_t j = 0; j < w->count; j++)
    if (w->by[j].knots) memset(w->by[j].knots->slope, 0, w->by[j].knots->count * sizeof(double));
  for (size_t end = s->steps; end > 0 && status == HK_OK;) {
    size_t begin = (end - 1) / s->stride * s->stride;
    status = segment_of(w, begin, end);
    end = begin;
  }
  keep_shared(w, status == HK_OK);
  if (s->source && status == HK_OK) status = s->source(s->source_context, s->steps ? s->step[0].t : 0, s->start, w->L);
  memcpy(X, w->L, 6 * s->n * sizeof *X);
  for (size_t j = 0; j < w->count && status == HK_OK; j++) {
    hk_sensitivity_start(&w->by[j], s->n, w->dX);
    for (size_t e = 0; e < 6 * s->n; e++) w->slope[j] += X[e] * w->dX[e];
    if (s->projection) w->slope[j] += hk_projection_slope(s, &w->by_constraints[j]);
    if (w->chained[j]) w->slope[j] += hk_force_slopes_by(&w->by_forces, s->dynamics, &w->by[j]);
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
  double *memory = calloc(2 * s->wide + (4 + s->stages + (s->source ? 2 * s->stride : 0)) * v, sizeof *memory);
  if (!memory) return hk_error_set(error, HK_NO_MEMORY, "no memory for an adjoint of %zu steps", s->steps);
  w.L = memory;
  w.Z = memory + s->wide;
  w.dX = w.Z + s->wide;
  w.own = w.dX + 2 * v;
  for (size_t k = 0; k < s->stages; k++) w.u[k] = w.own + (2 + k) * v;
  w.segment = s->source ? w.own + (2 + s->stages) * v : NULL;
  hk_status status = HK_OK;
  if (s->projection) status = hk_projection_vary(s, by, count, &w.by_constraints, error);
  if (s->projection) hk_projection_begin(s);
  if (status == HK_OK) status = all_steps(&w, X);
  free(w.by_constraints);
  hk_force_slopes_close(&w.by_forces, s->dynamics);
  free(w.chained);
  free(memory);
  hk_sensitivity_untape(s);
  if (status != HK_OK && !*error->text) hk_error_set(error, status, "%s", s->dynamics->error->text);
  return status;
}
