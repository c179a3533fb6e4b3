/* The derivative of the accelerations at a point of a step: by the blocks of the forces whose Jacobian is exact, and by
 * central differences along the change for the others; by a parameter, by differences between two runs. Transposed, by
 * products of the forces' own where they have them. */
#include "core/engine/contract/contract.h"
#include "core/numerics/implicit/implicit.h"
#include "core/numerics/sensitivity/force_slopes.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

void hk_sensitivity_divide(const hk_sensitivity *s, double *a) {
  const double *by_mass = s->dynamics->state->model.inverse_mass;
  for (size_t e = 0; e < 3 * s->n; e++) a[e] *= by_mass[e / 3];
  if (s->dynamics->pins->has_slides) hk_pins_filter(s->dynamics->pins, a);
}

static const hk_force_tables *tables_at(const hk_dynamics *d, size_t k) {
  return hk_force_of(d->plugins->kind[HK_FORCE].item[k]->plugin);
}

/* Which forces evaluations and Jacobians include: those with an exact Jacobian, or the others. */
static void take_only(hk_sensitivity *s, bool exact) {
  hk_dynamics *d = s->dynamics;
  for (size_t k = 0; k < d->split.forces; k++) d->takes[k] = s->exact[k] == exact;
}

/* Whether the force gives its changes along directions, or its product with its transposed Jacobian is that with its
 * Jacobian. */
static bool goes_along(const hk_sensitivity *s, size_t k) {
  return s->exact[k] && tables_at(s->dynamics, k)->implicit.along;
}

static bool multiplies(const hk_sensitivity *s, size_t k) {
  const hk_force_tables *f = tables_at(s->dynamics, k);
  return s->exact[k] && !f->implicit.along && f->implicit.transposed && f->own.flags & HK_SYMMETRIC_JACOBIAN;
}

/* Of the forces with exact Jacobians, but for those that multiply themselves where these are left `out`. *any: there
 * are some that are not constant. */
static hk_status blocks(hk_sensitivity *s, const hk_stage_point *p, bool out, hk_matrix *K, hk_matrix *D, bool *any) {
  hk_dynamics *d = s->dynamics;
  hk_status status = HK_OK;
  take_only(s, true);
  *any = !out;
  for (size_t k = 0; k < d->split.forces; k++) {
    d->takes[k] = d->takes[k] && !(out && (multiplies(s, k) || goes_along(s, k)));
    *any |= d->takes[k] && tables_at(d, k)->own.flags & (HK_DEPENDS_ON_X | HK_DEPENDS_ON_V);
  }
  if (*any) status = hk_jacobian_assemble(&d->system, p->t, p->X, 0, K, D);
  hk_dynamics_take_all(d);
  return status;
}

/* a -= K dx + D dv, in N, of count changes: each block is fetched once for all of them. */
static void add_blocks(const hk_sensitivity *s, const hk_matrix *K, const hk_matrix *D, size_t count, size_t apart,
                       const double *dX, double *a) {
  size_t v = 3 * s->n;
  for (size_t i = 0; i < s->n; i++)
    for (size_t e = K->row_start[i]; e < K->row_start[i + 1]; e++) {
      const double *k = K->value + 9 * e, *d = D->value + 9 * e, *x = dX + 3 * (size_t)K->column[e];
      double *to = a + 3 * i;
      for (size_t j = 0; j < count; j++, x += apart, to += apart) {
        const double *u = x + v;
        for (size_t p = 0; p < 3; p++)
          to[p] -= (k[3 * p] * x[0] + k[3 * p + 1] * x[1] + k[3 * p + 2] * x[2]) +
                   (d[3 * p] * u[0] + d[3 * p + 1] * u[1] + d[3 * p + 2] * u[2]);
      }
    }
}

/* into = (dF/dx, dF/dv)^T u of force k, added. */
static hk_status transposed_of(hk_sensitivity *s, const hk_stage_point *p, size_t k, const double *u,
                               const hk_transposed *into) {
  hk_dynamics *d = s->dynamics;
  hk_instance *one = d->plugins->kind[HK_FORCE].item[k];
  const hk_view view = hk_force_view_at(d, k, p->t, p->X, s->n);
  const hk_instance *outer = hk_enter(one);
  hk_status status = tables_at(d, k)->implicit.transposed(one->self, &view, u, into);
  return hk_leave_with(one, outer, "transposed", status);
}

/* a += (dF/dx) dx + (dF/dv) dv of the forces that multiply themselves, in N. */
static hk_status multiply(hk_sensitivity *s, const hk_stage_point *p, const double *dX, double *a) {
  hk_dynamics *d = s->dynamics;
  size_t v = 3 * s->n;
  double *by = s->scratch + 3 * v;
  hk_status status = hk_dynamics_set_time(d, p->t);
  for (int half = 0; half < 2; half++) {
    unsigned flag = half ? HK_DEPENDS_ON_V : HK_DEPENDS_ON_X;
    memset(by, 0, 2 * v * sizeof *by);
    for (size_t k = 0; k < d->split.forces && status == HK_OK; k++)
      if (multiplies(s, k) && d->force_acts[k] && tables_at(d, k)->own.flags & flag)
        status = transposed_of(s, p, k, dX + (half ? v : 0), &(hk_transposed){by, by + v, NULL, NULL});
    for (size_t e = 0; e < v; e++) a[e] += by[half ? v + e : e];
  }
  hk_riders_gather(&d->state->model, a);
  return status;
}

/* Of so many changes at a time. */
enum { FEW_CHANGES = 12 };

/* a += the changes of the forces that give them, in N. */
static hk_status add_along(hk_sensitivity *s, const hk_stage_point *p, size_t count, size_t apart, const double *dX,
                           const hk_force_changes *by, double *a) {
  hk_dynamics *d = s->dynamics;
  hk_tangent along[FEW_CHANGES];
  hk_status status = hk_dynamics_set_time(d, p->t);
  for (size_t k = 0; k < d->split.forces && status == HK_OK; k++) {
    hk_instance *one = d->plugins->kind[HK_FORCE].item[k];
    if (!goes_along(s, k) || !d->force_acts[k]) continue;
    for (size_t j = 0; j < count; j++) {
      const double *x = dX + j * apart;
      along[j] = (hk_tangent){x, x + 3 * s->n, by && by[j].force ? by[j].force[k] : NULL, by ? by[j].mass : NULL,
                              a + j * apart};
    }
    const hk_view view = hk_force_view_at(d, k, p->t, p->X, s->n);
    const hk_instance *outer = hk_enter(one);
    status = tables_at(d, k)->implicit.along(one->self, &view, along, count);
    status = hk_leave_with(one, outer, "along", status);
  }
  return status;
}

/* a -= dm/dp a, in N, of the acceleration at the point. */
static void add_masses(const hk_sensitivity *s, const hk_stage_point *p, const hk_force_changes *by, double *a) {
  for (size_t e = 0; by && by->mass && e < 3 * s->n; e++) a[e] -= by->mass[e / 3] * p->a[e];
}

/* The largest distance of a coordinate from the first particle's, or the largest speed. */
static double size_of(const double *x, size_t count, bool places) {
  double most = 0;
  for (size_t e = 0; e < count; e++) most = fmax(most, fabs(x[e] - (places ? x[e % 3] : 0)));
  return most;
}

/* How far along dX differences are taken: the part eps^(1/3) of the scene's extent and of its speeds. */
static double reach(const double *X, const double *dX, size_t n) {
  double part = INFINITY, least = pow(DBL_EPSILON, 1.0 / 3);
  for (int half = 0; half < 2; half++) {
    double size = size_of(X + 3 * n * (size_t)half, 3 * n, half == 0);
    double change = size_of(dX + 3 * n * (size_t)half, 3 * n, false);
    if (change > 0) part = fmin(part, least * (size > 0 ? size : 1) / change);
  }
  return part;
}

static hk_status add_differences(hk_sensitivity *s, const hk_stage_point *p, const double *dX, double *a) {
  size_t v = 3 * s->n;
  double part = reach(p->X, dX, s->n), *X = s->scratch, *there = X + 2 * v;
  hk_status status = HK_OK;
  if (!(part < INFINITY)) return HK_OK; /* nothing changes */
  take_only(s, false);
  for (int side = -1; side <= 1 && status == HK_OK; side += 2) {
    for (size_t e = 0; e < 2 * v; e++) X[e] = p->X[e] + side * part * dX[e];
    status = hk_sensitivity_evaluate(s->dynamics, p->t, X, there);
    for (size_t e = 0; e < v && status == HK_OK; e++) a[e] += side * there[e] / (2 * part);
  }
  hk_dynamics_take_all(s->dynamics);
  return status;
}

/* Of more changes than FEW_CHANGES, blocks that are made once are cheaper than a product for each, which takes about as
 * long as the force, a third of its blocks or less. */
hk_status hk_sensitivity_products(hk_sensitivity *s, const hk_stage_point *p, size_t count, size_t apart,
                                  const double *dX, const hk_force_changes *by, double *a) {
  const hk_model *model = &s->dynamics->state->model;
  hk_matrix K, D;
  bool few = count <= FEW_CHANGES || by, any;
  hk_status status = blocks(s, p, few, &K, &D, &any);
  for (size_t j = 0; j < count; j++) memset(a + j * apart, 0, 3 * s->n * sizeof *a);
  if (any && status == HK_OK) add_blocks(s, &K, &D, count, apart, dX, a);
  for (size_t j = 0; j < count && few && status == HK_OK; j += FEW_CHANGES)
    status = add_along(s, p, count - j < FEW_CHANGES ? count - j : FEW_CHANGES, apart, dX + j * apart,
                       by ? by + j : NULL, a + j * apart);
  for (size_t j = 0; j < count && status == HK_OK; j++) {
    const double *change = dX + j * apart;
    double *to = a + j * apart;
    if (few) status = multiply(s, p, change, to);
    add_masses(s, p, by ? by + j : NULL, to);
    hk_sensitivity_divide(s, to);
    hk_riders_follow(model, to);
    if (!s->all_exact && status == HK_OK) status = add_differences(s, p, change, to);
  }
  return status;
}

/* ---- as a dense matrix ---- */

static void scatter(const hk_sensitivity *s, const hk_matrix *M, size_t first, double *A) {
  size_t v = 3 * s->n;
  for (size_t i = 0; i < s->n; i++)
    for (size_t e = M->row_start[i]; e < M->row_start[i + 1]; e++)
      for (size_t p = 0; p < 9; p++)
        A[(3 * i + p / 3) * 2 * v + first + 3 * (size_t)M->column[e] + p % 3] -= M->value[9 * e + p];
}

/* What `divide` makes of column e, and what forces without blocks add to it. */
static hk_status finish_column(hk_sensitivity *s, const hk_stage_point *p, size_t e, double *column, double *A) {
  size_t v = 3 * s->n;
  double *unit = column + v;
  for (size_t i = 0; i < v; i++) column[i] = A[i * 2 * v + e];
  hk_sensitivity_divide(s, column);
  unit[e] = 1;
  hk_status status = s->all_exact ? HK_OK : add_differences(s, p, unit, column);
  unit[e] = 0;
  for (size_t i = 0; i < v; i++) A[i * 2 * v + e] = column[i];
  return status;
}

hk_status hk_sensitivity_jacobian(hk_sensitivity *s, const hk_stage_point *p, double *A) {
  hk_matrix K, D;
  size_t v = 3 * s->n;
  double *column = calloc(3 * v + 1, sizeof *column);
  if (!column) return hk_error_set(s->dynamics->error, HK_NO_MEMORY, "no memory for the Jacobian of accelerations");
  memset(A, 0, 2 * v * v * sizeof *A);
  bool any;
  hk_status status = blocks(s, p, false, &K, &D, &any);
  if (status == HK_OK) {
    scatter(s, &K, 0, A);
    scatter(s, &D, v, A);
  }
  for (size_t e = 0; e < 2 * v && status == HK_OK; e++) status = finish_column(s, p, e, column, A);
  free(column);
  return status;
}

/* ---- transposed ---- */

/* Which forces have no product of their own, and are not constant; whether there are any. */
static bool take_only_blocks(hk_dynamics *d, const bool *without) {
  bool any = false;
  for (size_t k = 0; k < d->split.forces; k++) {
    const hk_force_tables *f = tables_at(d, k);
    d->takes[k] =
        !(without && without[k]) && !f->implicit.transposed && f->own.flags & (HK_DEPENDS_ON_X | HK_DEPENDS_ON_V);
    any |= d->takes[k];
  }
  return any;
}

static hk_status transposed_blocks(hk_sensitivity *s, const hk_stage_point *p, const double *force, double *dX,
                                   const bool *without) {
  hk_matrix K, D;
  size_t v = 3 * s->n;
  bool any = take_only_blocks(s->dynamics, without);
  hk_status status = any ? hk_jacobian_assemble(&s->dynamics->system, p->t, p->X, 0, &K, &D) : HK_OK;
  hk_dynamics_take_all(s->dynamics);
  for (size_t i = 0; any && i < s->n && status == HK_OK; i++)
    for (size_t e = K.row_start[i]; e < K.row_start[i + 1]; e++)
      for (size_t q = 0; q < 9; q++) {
        size_t at = 3 * (size_t)K.column[e] + q % 3;
        dX[at] -= K.value[9 * e + q] * force[3 * i + q / 3];
        dX[v + at] -= D.value[9 * e + q] * force[3 * i + q / 3];
      }
  return status;
}

static hk_status transposed_by_force(hk_sensitivity *s, const hk_stage_point *p, const double *force, double *dX,
                                     hk_force_slopes *slopes, const bool *without) {
  hk_dynamics *d = s->dynamics;
  hk_status status = hk_dynamics_set_time(d, p->t);
  for (size_t k = 0; k < d->split.forces && status == HK_OK; k++) {
    if (!tables_at(d, k)->implicit.transposed || !d->force_acts[k] || (without && without[k])) continue;
    hk_transposed into = {dX, dX + 3 * s->n, NULL, NULL};
    if (slopes && slopes->covers[k]) into.parameter = (double *const *)slopes->force[k], into.mass = slopes->mass;
    status = transposed_of(s, p, k, force, &into);
  }
  return status;
}

hk_status hk_sensitivity_transposed(hk_sensitivity *s, const hk_stage_point *p, const double *u, double *dX,
                                    hk_force_slopes *slopes, const bool *without) {
  const hk_model *model = &s->dynamics->state->model;
  const double *by_mass = model->inverse_mass;
  size_t v = 3 * s->n;
  double *force = s->scratch;
  memset(dX, 0, 2 * v * sizeof *dX);
  memcpy(force, u, v * sizeof *u);
  hk_riders_gather(model, force);
  for (size_t i = 0; slopes && i < s->n; i++) /* a = F/m */
    for (size_t e = 3 * i; e < 3 * i + 3; e++) slopes->mass[i] -= by_mass[i] * force[e] * p->a[e];
  hk_sensitivity_divide(s, force);
  hk_status status = transposed_blocks(s, p, force, dX, without);
  hk_riders_follow(model, force);
  if (status == HK_OK) status = transposed_by_force(s, p, force, dX, slopes, without);
  hk_riders_gather(model, dX);
  hk_riders_gather(model, dX + v);
  return status;
}

/* ---- by a parameter ---- */

/* A pin's path is imposed on the place that an evaluation is given, and so are riders, but for rounding. */
static hk_status refuse_moved_path(const hk_varied *by, const double *more, const double *less, size_t n) {
  const uint8_t *pin = by->more->state->model.pin;
  bool moved = false;
  for (size_t e = 0; e < 6 * n; e++) moved |= more[e] != less[e] && pin[e / 3 % n] != HK_PIN_RIDES;
  if (!moved) return HK_OK;
  return hk_error_set(
      by->more->error, HK_FAILED,
      "a parameter changes the path of a pin, which is not differentiated: let a force draw the particle along it");
}

static void leave_out(hk_dynamics *d, const bool *without) {
  for (size_t k = 0; without && k < d->split.forces; k++) d->takes[k] = !without[k];
}

hk_status hk_sensitivity_by_parameter(hk_sensitivity *s, const hk_stage_point *p, const hk_varied *by,
                                      const bool *without, double *a) {
  size_t v = 3 * s->n;
  double *X = s->scratch, *Y = X + 2 * v, *less = Y + 2 * v;
  memcpy(X, p->X, 2 * v * sizeof *X); /* an evaluation imposes pins */
  memcpy(Y, p->X, 2 * v * sizeof *Y);
  leave_out(by->more, without);
  leave_out(by->less, without);
  hk_status status = hk_sensitivity_evaluate(by->more, p->t, X, a);
  if (status == HK_OK) status = hk_sensitivity_evaluate(by->less, p->t, Y, less);
  hk_dynamics_take_all(by->more);
  hk_dynamics_take_all(by->less);
  if (status == HK_OK) status = refuse_moved_path(by, X, Y, s->n);
  for (size_t e = 0; e < v && status == HK_OK; e++) a[e] = (a[e] - less[e]) / (2 * by->by);
  if (status == HK_OK) return HK_OK;
  const char *why = *by->more->error->text ? by->more->error->text : by->less->error->text;
  return hk_error_set(s->dynamics->error, status, "%s", why);
}

void hk_sensitivity_start(const hk_varied *by, size_t n, double *dX) {
  for (size_t e = 0; e < 6 * n; e++) dX[e] = (by->more->state->X[e] - by->less->state->X[e]) / (2 * by->by);
}
