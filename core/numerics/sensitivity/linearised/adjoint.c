/* Adjoints through linear steps. */
#include "core/numerics/sensitivity/linearised/linearised.h"

#include "core/engine/contract/contract.h"

#include <float.h>
#include <string.h>

/* ---- the systems ---- */

static bool is_turned(const hk_matrix *A) { return !A->symmetric; }

/* In place: the pattern is symmetric. */
static void transpose(hk_matrix *A) {
  for (size_t i = 0; i < A->rows; i++)
    for (size_t e = A->row_start[i]; e < A->row_start[i + 1] && A->column[e] <= i; e++) {
      double *a = A->value + 9 * e, *b = A->value + 9 * hk_matrix_find(A, A->column[e], (uint32_t)i);
      for (size_t p = 0; p < 9; p++) {
        size_t q = p / 3 + p % 3 * 3;
        if (a == b && p >= q) continue;
        double number = a[p];
        a[p] = b[q];
        b[q] = number;
      }
    }
}

static hk_status factorize(hk_sensitivity *s, const hk_linear_point *p) {
  hk_matrix A;
  hk_status status = hk_linearised_matrix(s, p, p->projected ? HK_WANT_DEFINITE : 0, &A);
  if (status != HK_OK) return status;
  if (is_turned(&A)) transpose(&A);
  return s->dynamics->system.linear->factorize(&s->dynamics->system, &A);
}

/* z of B^T z = b - A^T y, b being the adjoint of dv. */
static hk_status solve_first(hk_sensitivity *s, const hk_linear_point *p, double *b) {
  double *left = s->linearised->w[1];
  hk_matrix A;
  hk_status status = hk_linearised_matrix(s, p, 0, &A); /* the factors stay */
  if (status != HK_OK) return status;
  if (is_turned(&A)) transpose(&A);
  hk_linearised_product(&A, s->linearised->y, left);
  for (size_t e = 0; e < 3 * s->n; e++) b[e] -= left[e];
  return hk_linearised_solve(s, b, s->linearised->z);
}

/* The adjoint of M r. */
static double of_forces(const hk_sensitivity *s, const hk_linear_point *p, size_t e) {
  return s->linearised->y[e] + (p->projected ? s->linearised->z[e] : 0);
}

hk_status hk_linearised_return(hk_sensitivity *s, const hk_taken_step *step, const hk_carried *L, double *u) {
  const hk_linear_point p = hk_linearised_at(s, step);
  const double *mass = s->dynamics->state->model.mass;
  double *b = s->linearised->w[0];
  size_t v = 3 * s->n;
  for (size_t e = 0; e < v; e++) b[e] = L[v + e] + p.g * L[e] + L[2 * v + e] / p.g;
  hk_status status = factorize(s, &p);
  if (status == HK_OK) status = hk_linearised_solve(s, b, s->linearised->y);
  if (status == HK_OK && p.projected) status = solve_first(s, &p, b);
  for (size_t e = 0; e < v; e++) u[e] = p.g * mass[e / 3] * of_forces(s, &p, e);
  return status;
}

/* ---- the gradients of bilinear forms ---- */

/* u.A w, of blocks with this `want`. */
typedef struct form {
  const double *u, *w;
  unsigned want;
} form;

static size_t forms_of(const hk_sensitivity *s, const hk_linear_point *p, form f[3]) {
  const hk_linearised *w = s->linearised;
  f[0] = (form){w->y, p->projected ? p->p : p->dv, w->want};
  f[1] = (form){w->y, p->q, w->want | HK_WANT_DEFINITE};
  f[2] = (form){w->z, p->p, w->want | HK_WANT_DEFINITE};
  return p->projected ? 3 : 1;
}

static const hk_force_tables *tables_at(const hk_dynamics *d, size_t k) {
  return hk_force_of(d->plugins->kind[HK_FORCE].item[k]->plugin);
}

/* Which forces are left to differences of products; whether there are any. */
static bool find_others(hk_sensitivity *s) {
  hk_dynamics *d = s->dynamics;
  bool any = false;
  for (size_t k = 0; k < d->split.forces; k++) {
    const hk_force_tables *f = tables_at(d, k);
    bool constant = !(f->own.flags & (HK_DEPENDS_ON_X | HK_DEPENDS_ON_V));
    s->linearised->states[k] = constant || f->implicit.bilinear;
    any |= !s->linearised->states[k];
  }
  return any;
}

static hk_status by_force(hk_sensitivity *s, const hk_linear_point *p, size_t k, const form *f, const double *minus_u,
                          const hk_transposed *into) {
  hk_dynamics *d = s->dynamics;
  hk_instance *one = d->plugins->kind[HK_FORCE].item[k];
  const hk_view view = hk_force_view_at(d, k, p->t, p->X, s->n);
  size_t v = 3 * s->n;
  double *of = s->linearised->by_between;
  const hk_bilinear bilinear = {.want = f->want,
                                .linearised = p->foretold ? p->between : NULL,
                                .reached = p->foretold ? p->between + v : NULL,
                                .by_x = p->g * p->g,
                                .by_v = p->g,
                                .u = minus_u,
                                .w = f->w,
                                .by_linearised = of,
                                .by_reached = of + v};
  const hk_instance *outer = hk_enter(one);
  hk_status status = tables_at(d, k)->implicit.bilinear(one->self, &view, &bilinear, into);
  return hk_leave_with(one, outer, "bilinear", status);
}

static hk_status add_stated(hk_sensitivity *s, const hk_linear_point *p, const form *f, double *dX,
                            hk_force_slopes *slopes) {
  hk_dynamics *d = s->dynamics;
  double *minus_u = s->linearised->w[0];
  hk_status status = hk_dynamics_set_time(d, p->t);
  for (size_t e = 0; e < 3 * s->n; e++) minus_u[e] = -f->u[e];
  for (size_t k = 0; k < d->split.forces && status == HK_OK; k++) {
    if (!tables_at(d, k)->implicit.bilinear || !d->force_acts[k]) continue;
    hk_transposed into = {dX, dX + 3 * s->n, NULL, NULL};
    if (slopes && slopes->covers[k]) into.parameter = (double *const *)slopes->force[k], into.mass = slopes->mass;
    status = by_force(s, p, k, f, minus_u, &into);
  }
  return status;
}

/* The blocks of the forces that are not left out, times w: as the step took them, or those of -dF/dx and -dF/dv. */
static hk_status multiply(hk_sensitivity *s, const hk_linear_point *p, const form *f, const bool *left_out, bool exact,
                          double *y) {
  hk_dynamics *d = s->dynamics;
  double *X = s->linearised->X, *more = s->linearised->w[5];
  size_t v = 3 * s->n;
  hk_matrix K, D;
  memcpy(X, p->X, 2 * v * sizeof *X);
  for (size_t k = 0; k < d->split.forces; k++) d->takes[k] = !left_out[k];
  d->linear.linearised = p->foretold && !exact ? p->between : NULL;
  d->linear.reached = p->foretold && !exact ? p->between + v : NULL;
  hk_status status = hk_jacobian_assemble(&d->system, p->t, X, exact ? 0 : f->want, &K, &D);
  d->linear.linearised = d->linear.reached = NULL;
  hk_dynamics_take_all(d);
  if (status != HK_OK) return status;
  hk_linearised_product(&K, f->w, y);
  hk_linearised_product(&D, f->w, more);
  for (size_t e = 0; e < v; e++) y[e] = p->g * p->g * y[e] + p->g * more[e];
  return HK_OK;
}

/* Whether these forces leave out something of their blocks in the step. */
static hk_status compare(hk_sensitivity *s, const hk_linear_point *p, const form *f, const bool *left_out,
                         bool *equal) {
  double *taken = s->linearised->w[3], *exact = s->linearised->w[4], off = 0, size = 0;
  hk_status status = multiply(s, p, f, left_out, false, taken);
  if (status == HK_OK) status = multiply(s, p, f, left_out, true, exact);
  for (size_t e = 0; e < 3 * s->n && status == HK_OK; e++) {
    off = isfinite(taken[e] - exact[e]) ? fmax(off, fabs(taken[e] - exact[e])) : INFINITY;
    size = fmax(size, fabs(exact[e]));
  }
  *equal = off <= 1e-12 * size;
  return status;
}

/* Names the first one that does so alone. */
static hk_status refuse_one(hk_sensitivity *s, const hk_linear_point *p, const form *f) {
  hk_dynamics *d = s->dynamics;
  bool equal = true, *others = s->linearised->others;
  size_t k = 0, last = d->split.forces;
  for (; k < last; k++) {
    memset(others, true, last * sizeof *others);
    others[k] = s->linearised->states[k];
    hk_status status = others[k] ? HK_OK : compare(s, p, f, others, &equal);
    if (status != HK_OK) return status;
    if (!equal) break;
  }
  return hk_error_set(d->error, HK_FAILED,
                      "force '%s' leaves a part of its Jacobian out of the linear step to t = %g s, and does not state "
                      "how the rest changes, which the derivative backwards needs: take it forwards, by parameters, or "
                      "another implicit method, with --integrator",
                      d->plugins->kind[HK_FORCE].item[k < last ? k : 0]->label, p->t);
}

/* Refuses forces that do so and do not state the gradient of what remains. */
static hk_status compare_others(hk_sensitivity *s, const hk_linear_point *p, const form *f) {
  bool equal = true;
  hk_status status = compare(s, p, f, s->linearised->states, &equal);
  return equal || status != HK_OK ? status : refuse_one(s, p, f);
}

/* Of the forces whose blocks are exact: d/de of (dF/dx, dF/dv)^T u at x + e g^2 w, v + e g w. */
static hk_status add_others(hk_sensitivity *s, const hk_linear_point *p, const form *f, double *dX,
                            hk_force_slopes *slopes) {
  const double *mass = s->dynamics->state->model.mass;
  double *X = s->linearised->X, *u = s->linearised->w[0], *none = s->linearised->w[1], *there = s->linearised->w[3];
  size_t v = 3 * s->n;
  double extent = 0, change = 0;
  for (size_t e = 0; e < v; e++) {
    extent = fmax(extent, fabs(p->X[e] - p->X[e % 3]));
    change = fmax(change, p->g * p->g * fabs(f->w[e]));
  }
  double part = pow(DBL_EPSILON, 1.0 / 3) / 8 * (extent > 0 ? extent : 1) / change;
  hk_status status = compare_others(s, p, f);
  memset(none, 0, v * sizeof *none); /* no part of masses by which forces become accelerations: M dv is no such */
  for (int side = -1; side <= 1 && status == HK_OK && part < INFINITY; side += 2) {
    for (size_t e = 0; e < v; e++) {
      X[e] = p->X[e] + side * part * p->g * p->g * f->w[e];
      X[v + e] = p->X[v + e] + side * part * p->g * f->w[e];
      u[e] = side / (2 * part) * mass[e / 3] * f->u[e];
    }
    const hk_stage_point point = {p->t, X, none};
    status = hk_sensitivity_transposed(s, &point, u, there, slopes, s->linearised->states);
    for (size_t e = 0; e < 2 * v; e++) dX[e] += there[e];
  }
  return status;
}

hk_status hk_linearised_bend(hk_sensitivity *s, const hk_taken_step *step, double *dX, hk_force_slopes *slopes) {
  const hk_linear_point p = hk_linearised_at(s, step);
  form f[3];
  size_t count = forms_of(s, &p, f), v = 3 * s->n;
  bool others = find_others(s);
  hk_status status = HK_OK;
  memset(s->linearised->by_between, 0, 2 * v * sizeof(double));
  for (size_t k = 0; k < count && status == HK_OK; k++) {
    status = add_stated(s, &p, &f[k], dX, slopes);
    if (status == HK_OK && others) status = add_others(s, &p, &f[k], dX, slopes);
    for (size_t e = 0; e < v && slopes; e++) slopes->mass[e / 3] -= f[k].u[e] * f[k].w[e];
  }
  for (size_t e = 0; e < v && slopes; e++) slopes->mass[e / 3] += of_forces(s, &p, e) * p.r[e];
  return status;
}

double hk_linearised_slope(const hk_sensitivity *s, const hk_linear_point *p, const double *c, const double *d) {
  double sum = 0;
  for (size_t e = 0; e < 3 * s->n; e++) {
    sum += s->linearised->y[e] * c[e];
    if (p->projected) sum += s->linearised->z[e] * d[e];
  }
  return sum;
}

/* ---- the begin ---- */

void hk_linearised_depart(hk_sensitivity *s, const hk_taken_step *step, const double *dX, hk_carried *L) {
  const hk_linear_point p = hk_linearised_at(s, step);
  const double *mass = s->dynamics->state->model.mass, *between = s->linearised->by_between;
  size_t v = 3 * s->n;
  for (size_t e = 0; e < v; e++) {
    double of_end = L[v + e] + p.g * L[e] + L[2 * v + e] / p.g, force = mass[e / 3] * of_forces(s, &p, e);
    double of_point = L[5 * v + e] + dX[e];
    double base_x = L[e] + of_point, base_v = force - L[2 * v + e] / p.g;
    L[e] = (1 + p.back) * base_x + L[3 * v + e] + (p.foretold ? between[v + e] : 0);
    L[v + e] = of_end + dX[v + e] - force + p.g * of_point + (1 + p.back) * base_v + L[4 * v + e];
    L[2 * v + e] = 0;
    L[3 * v + e] = -p.back * base_x;
    L[4 * v + e] = -p.back * base_v;
    L[5 * v + e] = p.foretold ? between[e] : 0;
  }
}
