/* Linear steps taken again, as the method took them, and how their matrices change. */
#include "core/numerics/sensitivity/linearised/linearised.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* ---- a record's ---- */

hk_status hk_linearised_refuse(const hk_loop *loop, hk_error *error) {
  const char *name = loop->integrator->plugin->name;
  unsigned flags;
  if (loop->state->model.riders)
    return hk_error_set(error, HK_FAILED,
                        "the linear steps of '%s' are not differentiated with particles that ride on others: choose "
                        "another method, with --integrator",
                        name);
  hk_status status = loop->dynamics->linear.solver_flags(&loop->dynamics->system, &flags);
  if (status != HK_OK) return hk_error_set(error, status, "%s", loop->dynamics->error->text);
  if (!(flags & HK_ITERATIVE)) return HK_OK;
  return hk_error_set(error, HK_FAILED,
                      "the linear steps of '%s' are not differentiated with an iterative solver, whose residual is a "
                      "part of them: choose a direct one, with --solver",
                      name);
}

static hk_status find_want(hk_sensitivity *s) {
  unsigned flags;
  hk_status status = s->dynamics->linear.solver_flags(&s->dynamics->system, &flags);
  s->linearised->want = flags & HK_SOLVES_UNSYMMETRIC ? 0 : HK_WANT_SYMMETRIC;
  return status;
}

hk_status hk_linearised_open(hk_sensitivity *s) {
  size_t v = 3 * s->n, forces = s->dynamics->split.forces;
  hk_linearised *w = s->linearised = calloc(1, sizeof *w);
  if (w) w->X = malloc((16 * v + 1) * sizeof *w->X);
  if (w) w->states = calloc(2 * forces + 1, sizeof *w->states);
  if (!w || !w->X || !w->states) return HK_NO_MEMORY;
  for (size_t k = 0; k < 8; k++) w->w[k] = w->X + (4 + k) * v;
  w->others = w->states + forces;
  w->y = w->X + 12 * v;
  w->z = w->y + v;
  w->by_between = w->z + v;
  return find_want(s);
}

void hk_linearised_close(hk_sensitivity *s) {
  hk_linearised *w = s->linearised;
  if (!w) return;
  free(w->X);
  free(w->states);
  free(w);
  s->linearised = NULL;
}

/* ---- the matrix ---- */

/* Of these dynamics, at a point with the positions `between` behind it: X, 12n, on which pins are imposed. */
static hk_status matrix_of(const hk_sensitivity *s, hk_dynamics *d, const hk_linear_point *p, unsigned want, double *X,
                           hk_matrix *A) {
  hk_matrix K, D;
  size_t v = 3 * s->n;
  d->linear.linearised = p->foretold ? X + 2 * v : NULL;
  d->linear.reached = p->foretold ? X + 3 * v : NULL;
  hk_status status = d->linear.jacobian(&d->system, p->t, X, want, &K, &D);
  d->linear.linearised = d->linear.reached = NULL;
  return status == HK_OK ? d->linear.combine(&d->system, 1, p->g, p->g * p->g, A) : status;
}

static void put_point(const hk_sensitivity *s, const hk_linear_point *p) {
  size_t v = 3 * s->n;
  memcpy(s->linearised->X, p->X, 2 * v * sizeof *p->X);
  memcpy(s->linearised->X + 2 * v, p->between, 2 * v * sizeof *p->X);
}

hk_status hk_linearised_matrix(hk_sensitivity *s, const hk_linear_point *p, unsigned more, hk_matrix *A) {
  put_point(s, p);
  return matrix_of(s, s->dynamics, p, s->linearised->want | more, s->linearised->X, A);
}

void hk_linearised_product(const hk_matrix *A, const double *x, double *y) {
  for (size_t i = 0; i < A->rows; i++) {
    double sum[3] = {0, 0, 0};
    for (size_t e = A->row_start[i]; e < A->row_start[i + 1]; e++) {
      const double *a = A->value + 9 * e, *u = x + 3 * (size_t)A->column[e];
      for (size_t p = 0; p < 3; p++) sum[p] += a[3 * p] * u[0] + a[3 * p + 1] * u[1] + a[3 * p + 2] * u[2];
    }
    memcpy(y + 3 * i, sum, sizeof sum);
  }
}

hk_status hk_linearised_solve(hk_sensitivity *s, double *b, double *x) {
  hk_system *system = &s->dynamics->system;
  hk_solve_info info = {0};
  system->filter(system, b);
  hk_status status = system->linear->solve(system, b, x, &info);
  system->filter(system, x);
  return status;
}

/* ---- a step ---- */

hk_linear_point hk_linearised_at(const hk_sensitivity *s, const hk_taken_step *step) {
  const hk_taken_step *before = step - 1; /* the first step is one of `start` */
  const hk_stage_point *point = s->point;
  size_t v = 3 * s->n;
  double q = step->h / before->h, back = q * q / (1 + 2 * q);
  return (hk_linear_point){.t = step->t + step->h,
                           .g = step->h * (1 + q) / (1 + 2 * q),
                           .back = back,
                           .foretold = before->linear,
                           .projected = step->projected,
                           .X = point[0].X,
                           .a = point[0].a,
                           .between = point[1].X,
                           .dv = point[1].a,
                           .p = point[2].X,
                           .q = point[2].X + v,
                           .r = point[2].a};
}

/* x^ and v, and r without its acceleration. */
static void place(const hk_sensitivity *s, const hk_linear_point *p, const hk_carried *Z) {
  size_t v = 3 * s->n;
  for (size_t e = 0; e < v; e++) {
    double turn = p->back * (Z[v + e] - Z[4 * v + e]);
    p->X[e] = Z[e] + p->back * (Z[e] - Z[3 * v + e]) + p->g * Z[v + e];
    p->X[v + e] = Z[v + e];
    p->r[e] = turn;
  }
  memcpy(p->between, Z + 5 * v, v * sizeof *Z);
  memcpy(p->between + v, Z, v * sizeof *Z);
}

/* By projected blocks, and once more for what they leave out. */
static hk_status solve_projected(hk_sensitivity *s, const hk_linear_point *p, double *b, double *left) {
  hk_system *system = &s->dynamics->system;
  hk_matrix A;
  size_t v = 3 * s->n;
  hk_status status = hk_linearised_matrix(s, p, HK_WANT_DEFINITE, &A);
  if (status == HK_OK) status = system->linear->factorize(system, &A);
  if (status == HK_OK) status = hk_linearised_solve(s, b, p->p);
  if (status == HK_OK) status = hk_linearised_matrix(s, p, 0, &A); /* the factors stay */
  if (status != HK_OK) return status;
  hk_linearised_product(&A, p->p, left);
  for (size_t e = 0; e < v; e++) left[e] = b[e] - left[e];
  status = hk_linearised_solve(s, left, p->q);
  for (size_t e = 0; e < v; e++) p->dv[e] = p->p[e] + p->q[e];
  return status;
}

static hk_status solve(hk_sensitivity *s, const hk_taken_step *step, const hk_linear_point *p) {
  hk_system *system = &s->dynamics->system;
  const double *mass = s->dynamics->state->model.mass;
  double *b = s->linearised->w[0];
  hk_matrix A;
  hk_status status = hk_linearised_matrix(s, p, 0, &A);
  for (size_t e = 0; e < 3 * s->n; e++) b[e] = mass[e / 3] * p->r[e];
  if (status == HK_OK) status = system->linear->factorize(system, &A);
  s->step[step - s->step].projected = status == HK_NOT_CONVERGED;
  if (status == HK_OK) return hk_linearised_solve(s, b, p->dv);
  if (status != HK_NOT_CONVERGED) return status;
  system->filter(system, b);
  return solve_projected(s, p, b, s->linearised->w[1]);
}

hk_status hk_linearised_step(hk_sensitivity *s, const hk_taken_step *step, hk_carried *Z) {
  size_t v = 3 * s->n;
  hk_linear_point p = hk_linearised_at(s, step);
  s->point[0].t = p.t;
  place(s, &p, Z);
  hk_status status = hk_sensitivity_evaluate(s->dynamics, p.t, p.X, p.a);
  for (size_t e = 0; e < v; e++) p.r[e] += Z[v + e] - p.X[v + e] + p.g * p.a[e]; /* of pins v is that of their path */
  if (status == HK_OK) status = solve(s, step, &p);
  for (size_t e = 0; e < v; e++) {
    double x = Z[e], u = Z[v + e], base = u + p.back * (u - Z[4 * v + e]), after = p.X[v + e] + p.dv[e];
    Z[e] = x + p.back * (x - Z[3 * v + e]) + p.g * after;
    Z[v + e] = after;
    Z[2 * v + e] = (after - base) / p.g;
    Z[3 * v + e] = x;
    Z[4 * v + e] = u;
    Z[5 * v + e] = p.X[e];
  }
  return status == HK_OK ? hk_dynamics_impose(s->dynamics, p.t, Z, Z + v) : status;
}

/* ---- how its matrices change ---- */

/* c -= by A dv, or by (A p + B q), and d -= by B p, of the matrices of these dynamics at X. */
static hk_status subtract(hk_sensitivity *s, hk_dynamics *d, const hk_linear_point *p, double by, double *X, double *c,
                          double *of_p) {
  double *y = s->linearised->w[2];
  size_t v = 3 * s->n;
  hk_matrix A;
  hk_status status = matrix_of(s, d, p, s->linearised->want, X, &A);
  if (status != HK_OK) return status;
  hk_linearised_product(&A, p->projected ? p->p : p->dv, y);
  for (size_t e = 0; e < v; e++) c[e] -= by * y[e];
  if (!p->projected) return HK_OK;
  status = matrix_of(s, d, p, s->linearised->want | HK_WANT_DEFINITE, X, &A);
  if (status != HK_OK) return status;
  hk_linearised_product(&A, p->q, y);
  for (size_t e = 0; e < v; e++) c[e] -= by * y[e];
  hk_linearised_product(&A, p->p, y);
  for (size_t e = 0; e < v; e++) of_p[e] -= by * y[e];
  return HK_OK;
}

/* X moves by so much of a change of the point and of `between`. */
static void move(const hk_sensitivity *s, double by, const double *dX, const double *between) {
  size_t v = 3 * s->n;
  double *X = s->linearised->X;
  for (size_t e = 0; e < 2 * v; e++) {
    X[e] += by * dX[e];
    X[2 * v + e] += by * between[e];
  }
}

/* Between both scenes, whose points are moved, too; dX NULL: not. */
static hk_status between_scenes(hk_sensitivity *s, const hk_linear_point *p, const hk_varied *by, const bool *without,
                                const double *dX, const double *between, double *c, double *d) {
  hk_dynamics *side[2] = {by->less, by->more};
  hk_status status = HK_OK;
  for (int k = 0; k < 2 && status == HK_OK; k++) {
    put_point(s, p);
    if (dX) move(s, k ? by->by : -by->by, dX, between);
    for (size_t f = 0; without && f < side[k]->split.forces; f++) side[k]->takes[f] = !without[f];
    status = subtract(s, side[k], p, (k ? 1 : -1) / (2 * by->by), s->linearised->X, c, d);
    hk_dynamics_take_all(side[k]);
    if (status != HK_OK) hk_error_set(s->dynamics->error, status, "%s", side[k]->error->text);
  }
  const double *more = by->more->state->model.mass, *less = by->less->state->model.mass;
  for (size_t e = 0; e < 3 * s->n; e++) {
    double change = (more[e / 3] - less[e / 3]) / (2 * by->by) * p->r[e];
    c[e] += change;
    if (p->projected) d[e] += change;
  }
  return status;
}

hk_status hk_linearised_by_parameter(hk_sensitivity *s, const hk_linear_point *p, const hk_varied *by,
                                     const bool *without, double *c, double *d) {
  return between_scenes(s, p, by, without, NULL, NULL, c, d);
}

/* How far along a change differences go: their error is the square of this part of the scene's extent over that of an
 * element, and eps over the part. */
static double reach(const hk_linear_point *p, const double *dX, const double *between, size_t v) {
  double extent = 0, change = 0, speed = 0, change_of_v = 0;
  for (size_t e = 0; e < v; e++) {
    extent = fmax(extent, fabs(p->X[e] - p->X[e % 3]));
    change = fmax(change, fabs(dX[e]));
    if (p->foretold) change = fmax(change, fmax(fabs(between[e]), fabs(between[v + e])));
    speed = fmax(speed, fabs(p->X[v + e]));
    change_of_v = fmax(change_of_v, fabs(dX[v + e]));
  }
  double part = pow(DBL_EPSILON, 1.0 / 3) / 8, of_x = (extent > 0 ? extent : 1) / change;
  return part * fmin(of_x, (speed > 0 ? speed : 1) / change_of_v);
}

/* By the parameter and along the change at once where the scenes' difference does not lead too far along it. */
hk_status hk_linearised_change(hk_sensitivity *s, const hk_linear_point *p, const hk_varied *by, const double *dX,
                               const double *between, double *c, double *d) {
  double part = reach(p, dX, between, 3 * s->n);
  if (by->by <= 8 * part) return between_scenes(s, p, by, NULL, dX, between, c, d);
  hk_status status = between_scenes(s, p, by, NULL, NULL, NULL, c, d);
  for (int side = -1; side <= 1 && status == HK_OK; side += 2) {
    put_point(s, p);
    move(s, side * part, dX, between);
    status = subtract(s, s->dynamics, p, side / (2 * part), s->linearised->X, c, d);
  }
  return status;
}
