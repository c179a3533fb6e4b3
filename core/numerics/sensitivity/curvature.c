/* The second derivatives of a weighted sum of the numbers at a segment's end, beside the first ones. A step is linear
 * in the accelerations of its stages, so that all curvature is theirs: with the adjoint u of a stage's acceleration a
 * and the tangents V of its point by all columns, it is the sum over stages of V' (u.a)'' V (Griewank and Walther,
 * Evaluating Derivatives, 2008, chapter 5: a tangent of the adjoint). One sweep forwards and one backwards, whatever
 * the number of columns; (u.a)'' by differences: of u' da/dX along each number where Jacobians are exact, of u.a along
 * each pair of numbers where they are not, along those alone that move. */
#include "core/engine/contract/contract.h"
#include "core/numerics/sensitivity/bend.h"
#include "core/numerics/sensitivity/implicit_stage.h"

#include <stdlib.h>
#include <string.h>

/* ---- forwards ---- */

static hk_status slopes_at(hk_bend_pass *w, size_t k, const hk_bend_point *kept) {
  hk_sensitivity *s = w->s;
  const hk_stage_point *p = &s->point[k];
  size_t v = w->v, columns = w->columns;
  memcpy(kept->X, p->X, 2 * v * sizeof *kept->X);
  hk_status status = !w->values ? hk_sensitivity_jacobian(s, p, kept->A) : hk_bend_survey(w, p, kept);
  for (size_t j = 0; j < w->controls && status == HK_OK; j++)
    status = hk_changes_plan_slope(&w->plan, s, p, &w->by[j], j, kept->B + j * v);
  double *a = w->a[k], part = hk_bend_part(w, p->t);
  memset(a, 0, v * columns * sizeof *a);
  for (size_t i = 0; i < v; i++) {
    for (size_t e = 0; e < 2 * v; e++)
      hk_bend_add_rows(w, a + i * columns, kept->A[i * 2 * v + e], kept->V + e * columns, 1);
    for (size_t j = 0; j < w->controls; j++) {
      a[i * columns + 2 * v + 2 * j] += (1 - part) * kept->B[j * v + i];
      a[i * columns + 2 * v + 2 * j + 1] += part * kept->B[j * v + i];
    }
  }
  return status;
}

static hk_status stage_of(hk_bend_pass *w, const hk_taken_step *step, size_t k, const hk_bend_point *kept) {
  const hk_stages_facet *m = w->s->method;
  size_t v = w->v, block = v * w->columns;
  double h = step->h, *dx = w->dZ, *dv = dx + block, *V = kept->V;
  if (!hk_sensitivity_evaluates(w->s, step, k)) {
    memcpy(w->a[k], dv + block, block * sizeof *dx);
    return HK_OK;
  }
  memcpy(V, dx, 2 * block * sizeof *V);
  hk_bend_add_rows(w, V, m->c[k] * h, dv, v);
  for (size_t j = 0; j < k; j++) {
    hk_bend_add_rows(w, V, h * h * m->x[k][j], w->a[j], v);
    hk_bend_add_rows(w, V + block, h * m->v[k][j], w->a[j], v);
  }
  return slopes_at(w, k, kept);
}

static hk_status forwards(hk_bend_pass *w, const hk_taken_step *step, hk_carried *Z, const hk_bend_point *kept) {
  const hk_stages_facet *m = w->s->method;
  size_t v = w->v, block = v * w->columns;
  hk_status status = hk_sensitivity_step(w->s, step, Z);
  for (size_t k = 0; k < m->count && status == HK_OK; k++) status = stage_of(w, step, k, &kept[k]);
  hk_bend_add_rows(w, w->dZ, step->h, w->dZ + block, v);
  for (size_t k = 0; k < m->count; k++) {
    hk_bend_add_rows(w, w->dZ, step->h * step->h * m->x_end[k], w->a[k], v);
    hk_bend_add_rows(w, w->dZ + block, step->h * m->v_end[k], w->a[k], v);
  }
  memcpy(w->dZ + 2 * block, w->a[m->count - 1], block * sizeof *w->dZ);
  return status;
}

/* ---- backwards ---- */

static hk_status back_stage(hk_bend_pass *w, const hk_taken_step *step, size_t k, const hk_bend_point *kept) {
  const hk_stages_facet *m = w->s->method;
  size_t v = w->v;
  double h = step->h, *L = w->L, *dX = w->dX;
  if (!hk_sensitivity_evaluates(w->s, step, k)) {
    memcpy(L + 2 * v, w->u[k], v * sizeof *L);
    return HK_OK;
  }
  hk_status status = hk_bend_add(w, kept, step->t + m->c[k] * h, w->u[k]);
  memset(dX, 0, 2 * v * sizeof *dX);
  for (size_t i = 0; i < v; i++)
    for (size_t e = 0; e < 2 * v; e++) dX[e] += kept->A[i * 2 * v + e] * w->u[k][i];
  for (size_t e = 0; e < v; e++) {
    L[e] += dX[e];
    L[v + e] += m->c[k] * h * dX[e] + dX[v + e];
  }
  for (size_t j = 0; j < k; j++)
    for (size_t e = 0; e < v; e++) w->u[j][e] += h * h * m->x[k][j] * dX[e] + h * m->v[k][j] * dX[v + e];
  return status;
}

static hk_status backwards(hk_bend_pass *w, const hk_taken_step *step, const hk_bend_point *kept) {
  const hk_stages_facet *m = w->s->method;
  size_t v = w->v;
  double h = step->h, *L = w->L;
  hk_status status = HK_OK;
  for (size_t k = 0; k < m->count; k++)
    for (size_t e = 0; e < v; e++) w->u[k][e] = h * h * m->x_end[k] * L[e] + h * m->v_end[k] * L[v + e];
  for (size_t e = 0; e < v; e++) w->u[m->count - 1][e] += L[2 * v + e];
  for (size_t e = 0; e < v; e++) L[v + e] += h * L[e];
  memset(L + 2 * v, 0, v * sizeof *L);
  for (size_t k = m->count; k-- > 0 && status == HK_OK;) status = back_stage(w, step, k, &kept[k]);
  return status;
}

static hk_status both_ways(hk_bend_pass *w, size_t first, size_t last, hk_carried *Z) {
  hk_sensitivity *s = w->s;
  size_t stages = s->method->count;
  hk_status status = HK_OK;
  for (size_t i = first; i < last && status == HK_OK; i++) {
    hk_taken_step step = s->step[i];
    step.fresh = step.fresh || i == first; /* nothing is carried over from another state */
    status = forwards(w, &step, Z, w->kept + (i - first) * stages);
  }
  for (size_t i = last; i-- > first && status == HK_OK;) {
    hk_taken_step step = s->step[i];
    step.fresh = step.fresh || i == first;
    status = backwards(w, &step, w->kept + (i - first) * stages);
  }
  return status;
}

static double *take(double **at, size_t count) {
  double *taken = *at;
  *at += count;
  return taken;
}

static bool reserve(hk_bend_pass *w, size_t steps) {
  size_t v = w->v, stages = w->s->method->count, points = steps * stages, columns = w->columns, block = v * columns;
  size_t beside = !w->values ? 0 : v + 4 * v * v;
  size_t each = 2 * v + 2 * block + 2 * v * v + w->controls * v + beside;
  w->memory =
      calloc(points * each + 3 * block + stages * (block + v) + 4 * v * v + 2 * block + 20 * v + 1, sizeof(double));
  w->kept = calloc(points + 1, sizeof *w->kept);
  if (!w->memory || !w->kept) return false;
  double *at = w->memory;
  for (size_t k = 0; k < points; k++) {
    double *a = take(&at, beside);
    w->kept[k] = (hk_bend_point){
        take(&at, 2 * v), take(&at, 2 * block), take(&at, 2 * v * v), take(&at, w->controls * v), a, a + v};
  }
  w->dZ = take(&at, 3 * block);
  for (size_t k = 0; k < stages; k++) w->a[k] = take(&at, block), w->u[k] = take(&at, v);
  w->G = take(&at, 4 * v * v);
  w->GV = take(&at, 2 * block);
  w->L = take(&at, 3 * v);
  w->dX = take(&at, 2 * v);
  w->cross = take(&at, 2 * v);
  w->X = take(&at, 2 * v);
  w->one = take(&at, 2 * v);
  w->two = take(&at, 6 * v); /* and behind them a control's, and which rows move */
  return true;
}

/* Jacobians that are not exact have no second derivatives. Those without a product of their own may be differences of
 * forces themselves, as that of `field`, an evaluation for each of 6 numbers and two sides: for one or two particles
 * values for all pairs are fewer, and less off. */
static bool takes_values(const hk_sensitivity *s) {
  const hk_instances *forces = &s->dynamics->plugins->kind[HK_FORCE];
  if (!s->all_exact) return true;
  for (size_t k = 0; k < forces->count && s->n <= 2; k++) {
    const hk_force_tables *f = hk_force_of(forces->item[k]->plugin);
    if (!f->implicit.transposed && f->own.flags & (HK_DEPENDS_ON_X | HK_DEPENDS_ON_V)) return true;
  }
  return false;
}

hk_status hk_sensitivity_curvature(hk_sensitivity *s, size_t first, size_t last, double *X, const hk_varied *by,
                                   size_t controls, const bool *moves, const double *weight, double *J, double *H,
                                   hk_error *error) {
  size_t v = 3 * s->n, columns = 2 * v + 2 * controls;
  hk_bend_pass w = {.s = s, .by = by, .v = v, .controls = controls, .columns = columns, .moves = moves, .H = H};
  if (s->implicit || s->projection)
    return hk_error_set(error, HK_FAILED,
                        "second derivatives are those of explicit steps without constraints alone: choose an "
                        "explicit method, with --integrator, or --way shooting");
  w.values = takes_values(s);
  hk_carried *Z = calloc(3 * v + 1, sizeof *Z);
  hk_status status = Z && reserve(&w, last - first) ? HK_OK : HK_NO_MEMORY;
  if (status == HK_OK) status = hk_changes_plan_open(&w.plan, s, by, controls);
  if (status != HK_OK) {
    hk_error_set(error, status, "no memory for the second derivatives of %zu steps", last - first);
  } else {
    w.begin = s->step[first].t;
    w.end = s->step[last - 1].t + s->step[last - 1].h;
    memcpy(Z, X, 2 * v * sizeof *X);
    for (size_t e = 0; e < 2 * v; e++) w.dZ[e * columns + e] = 1;
    memcpy(w.L, weight, 2 * v * sizeof *weight);
    memset(H, 0, columns * columns * sizeof *H);
    hk_sensitivity_untape(s);
    status = both_ways(&w, first, last, Z);
    memcpy(X, Z, 2 * v * sizeof *X);
    for (size_t c = 0; c < columns; c++) {
      for (size_t e = 0; e < 2 * v; e++) J[c * 2 * v + e] = w.dZ[e * columns + c];
      for (size_t b = 0; b < c; b++) H[c * columns + b] = H[b * columns + c];
    }
  }
  hk_changes_plan_close(&w.plan, s);
  free(w.memory);
  free(w.kept);
  free(Z);
  if (status != HK_OK && error->status == HK_OK) hk_error_set(error, status, "%s", s->dynamics->error->text);
  return status;
}
