/* The scene's solver factorizes A where it solves such matrices. One for symmetric matrices gets A without its
 * unsymmetric terms, and one for definite matrices that without what is not definite: these are preconditioners, and
 * flexible GMRES (Saad 1993, SIAM J. Sci. Comput. 14) on A itself, or its transpose, takes a direction or two where the
 * factors are those of A. */
#include "core/numerics/sensitivity/implicit_stage.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum { DIRECTIONS = 20, RESTARTS = 10, ITERATIONS = 50, HALVINGS = 30 };

/* Residuals of a linear system in parts of its right-hand side: wanted, and enough where rounding allows no better. */
static const double wanted = 1e-14, enough = 1e-10;

struct hk_implicit_stage {
  hk_matrix A; /* whose values are `value` */
  double *value;
  size_t room;
  bool transposed;
  double *V, *Z;        /* DIRECTIONS + 1 and DIRECTIONS vectors of 3n */
  double *R, *da, *old; /* 3n; X of 6n behind them */
};

bool hk_implicit_stage_is(const hk_stages_facet *m, size_t k) { return m->v[k][k] != 0; }

hk_implicit_stage *hk_implicit_stage_create(size_t n) {
  hk_implicit_stage *w = calloc(1, sizeof *w);
  size_t v = 3 * n;
  if (w) w->V = malloc(((2 * DIRECTIONS + 6) * v + 1) * sizeof *w->V);
  if (!w || !w->V) {
    free(w);
    return NULL;
  }
  w->Z = w->V + (DIRECTIONS + 1) * v;
  w->R = w->Z + DIRECTIONS * v;
  w->da = w->R + v;
  w->old = w->da + v;
  return w;
}

void hk_implicit_stage_free(hk_implicit_stage *w) {
  if (!w) return;
  free(w->value);
  free(w->V);
  free(w);
}

/* ---- the matrix ---- */

static void product(const hk_implicit_stage *w, const double *x, double *y) {
  const hk_matrix *A = &w->A;
  memset(y, 0, 3 * A->rows * sizeof *y);
  for (size_t i = 0; i < A->rows; i++)
    for (size_t e = A->row_start[i]; e < A->row_start[i + 1]; e++)
      for (size_t p = 0; p < 9; p++) {
        size_t row = 3 * i + p / 3, column = 3 * (size_t)A->column[e] + p % 3;
        if (w->transposed)
          y[column] += w->value[9 * e + p] * x[row];
        else
          y[row] += w->value[9 * e + p] * x[column];
      }
}

static hk_status combine(hk_sensitivity *s, const hk_stage_point *p, double by_v, double by_x, unsigned want,
                         hk_matrix *A) {
  hk_system *system = &s->dynamics->system;
  hk_matrix K, D;
  hk_status status = system->linear->jacobian(system, p->t, p->X, want, &K, &D);
  return status == HK_OK ? system->linear->combine(system, 1, by_v, by_x, A) : status;
}

static hk_status keep(hk_sensitivity *s, hk_implicit_stage *w, const hk_matrix *A) {
  size_t count = 9 * A->row_start[A->rows];
  if (count > w->room) {
    free(w->value);
    w->value = malloc(count * sizeof *w->value);
    w->room = w->value ? count : 0;
    if (!w->value) return hk_error_set(s->dynamics->error, HK_NO_MEMORY, "no memory for the matrix of a stage");
  }
  memcpy(w->value, A->value, count * sizeof *w->value);
  w->A = *A;
  return HK_OK;
}

/* Where the block of row j and column i stands. */
static size_t mirror(const hk_matrix *A, size_t i, size_t j) {
  size_t first = A->row_start[j], last = A->row_start[j + 1];
  while (first < last) {
    size_t middle = first + (last - first) / 2;
    if (A->column[middle] < i)
      first = middle + 1;
    else
      last = middle;
  }
  return first;
}

static void transpose(const hk_implicit_stage *w, hk_matrix *A) {
  for (size_t i = 0; i < A->rows; i++)
    for (size_t e = A->row_start[i]; e < A->row_start[i + 1]; e++) {
      size_t at = mirror(A, i, A->column[e]);
      for (size_t p = 0; p < 9; p++) A->value[9 * at + p / 3 + p % 3 * 3] = w->value[9 * e + p];
    }
}

/* Factors for A, of which the exact values are kept; `last` is that of the last combination. */
static hk_status factorize(hk_sensitivity *s, hk_implicit_stage *w, const hk_stage_point *p, double by_v, double by_x,
                           hk_matrix *last) {
  hk_system *system = &s->dynamics->system;
  unsigned flags;
  hk_status status = system->linear->solver_flags(system, &flags);
  if (status != HK_OK) return status;
  if (flags & HK_SOLVES_UNSYMMETRIC) {
    if (w->transposed && !last->symmetric) transpose(w, last);
    return system->linear->factorize(system, last);
  }
  if (!last->symmetric) status = combine(s, p, by_v, by_x, HK_WANT_SYMMETRIC, last);
  if (status == HK_OK) status = system->linear->factorize(system, last);
  if (status != HK_NOT_CONVERGED) return status;
  status = combine(s, p, by_v, by_x, HK_WANT_SYMMETRIC | HK_WANT_DEFINITE, last);
  return status == HK_OK ? system->linear->factorize(system, last) : status;
}

static hk_status linearise_at(hk_sensitivity *s, const hk_stage_point *p, double by_v, double by_x, bool transposed) {
  hk_implicit_stage *w = s->implicit;
  hk_matrix A;
  w->transposed = transposed;
  hk_status status = combine(s, p, by_v, by_x, 0, &A);
  if (status == HK_OK) status = keep(s, w, &A);
  return status == HK_OK ? factorize(s, w, p, by_v, by_x, &A) : status;
}

hk_status hk_implicit_stage_linearise(hk_sensitivity *s, const hk_taken_step *step, size_t k, bool transposed) {
  const hk_stages_facet *m = hk_sensitivity_method(s, step);
  return linearise_at(s, &s->point[k], step->h * m->v[k][k], step->h * step->h * m->x[k][k], transposed);
}

/* ---- its solution ---- */

static double dot(const double *a, const double *b, size_t count) {
  double sum = 0;
  for (size_t e = 0; e < count; e++) sum += a[e] * b[e];
  return sum;
}

/* The rotations of the least squares problem, and its right-hand side. */
typedef struct projected {
  double H[DIRECTIONS + 1][DIRECTIONS], c[DIRECTIONS], s[DIRECTIONS], g[DIRECTIONS + 1];
} projected;

/* The next direction, orthogonal to those before; whether there is none. */
static bool orthogonalise(const hk_implicit_stage *w, size_t j, size_t v, projected *q) {
  double *next = w->V + (j + 1) * v;
  for (int pass = 0; pass < 2; pass++)
    for (size_t i = 0; i <= j; i++) {
      double part = dot(next, w->V + i * v, v);
      q->H[i][j] = (pass ? q->H[i][j] : 0) + part;
      for (size_t e = 0; e < v; e++) next[e] -= part * w->V[i * v + e];
    }
  double size = q->H[j + 1][j] = sqrt(dot(next, next, v));
  for (size_t e = 0; e < v && size > 0; e++) next[e] /= size;
  return !(size > 0);
}

static void rotate(projected *q, size_t j) {
  for (size_t i = 0; i < j; i++) {
    double a = q->H[i][j], b = q->H[i + 1][j];
    q->H[i][j] = q->c[i] * a + q->s[i] * b;
    q->H[i + 1][j] = q->c[i] * b - q->s[i] * a;
  }
  double a = q->H[j][j], b = q->H[j + 1][j], r = sqrt(a * a + b * b);
  q->c[j] = r > 0 ? a / r : 1;
  q->s[j] = r > 0 ? b / r : 0;
  q->H[j][j] = r;
  q->g[j + 1] = -q->s[j] * q->g[j];
  q->g[j] *= q->c[j];
}

static void add_directions(const hk_implicit_stage *w, const projected *q, size_t count, size_t v, double *x) {
  double y[DIRECTIONS];
  for (size_t i = count; i-- > 0;) {
    y[i] = q->g[i];
    for (size_t j = i + 1; j < count; j++) y[i] -= q->H[i][j] * y[j];
    y[i] /= q->H[i][i];
    for (size_t e = 0; e < v; e++) x[e] += y[i] * w->Z[i * v + e];
  }
}

/* x += what DIRECTIONS directions find of A x = b. */
static hk_status restart(hk_sensitivity *s, const double *b, double *x, double limit, double *size) {
  hk_implicit_stage *w = s->implicit;
  hk_system *system = &s->dynamics->system;
  size_t v = 3 * s->n, count = 0;
  projected q;
  product(w, x, w->V);
  for (size_t e = 0; e < v; e++) w->V[e] = b[e] - w->V[e];
  *size = q.g[0] = sqrt(dot(w->V, w->V, v));
  if (!(*size > limit)) return isnan(*size) ? HK_NOT_FINITE : HK_OK;
  for (size_t e = 0; e < v; e++) w->V[e] /= *size;
  for (bool last = false; count < DIRECTIONS && !last; count++) {
    double *z = w->Z + count * v;
    hk_solve_info info = {.tolerance = 1e-8};
    hk_status status = system->linear->solve(system, w->V + count * v, z, &info);
    if (status != HK_OK) return status;
    product(w, z, w->V + (count + 1) * v);
    last = orthogonalise(w, count, v, &q);
    rotate(&q, count);
    last |= fabs(q.g[count + 1]) <= limit;
  }
  add_directions(w, &q, count, v, x);
  return HK_OK;
}

/* Solves A x = b, or the transposed system. */
static hk_status solve(hk_sensitivity *s, const double *b, double *x) {
  size_t v = 3 * s->n;
  double size = 0, before = INFINITY, of = sqrt(dot(b, b, v));
  hk_status status = HK_OK;
  memset(x, 0, v * sizeof *x);
  for (int i = 0; i < RESTARTS && status == HK_OK; i++) {
    status = restart(s, b, x, wanted * of, &size);
    if (!(size > wanted * of) || !(size < 0.5 * before)) break;
    before = size;
  }
  if (status == HK_OK) s->dynamics->system.filter(&s->dynamics->system, x);
  if (status != HK_OK || size <= enough * of) return status;
  return hk_error_set(s->dynamics->error, HK_NOT_CONVERGED,
                      "the linear system of a step's derivative is solved to %.2g of its right-hand side only: take a "
                      "shorter step (--dt), or a direct solver (--solver)",
                      size / of);
}

static void by_mass(const hk_sensitivity *s, double *u) {
  for (size_t e = 0; e < 3 * s->n; e++) u[e] *= s->dynamics->state->model.mass[e / 3];
}

hk_status hk_implicit_stage_pass(hk_sensitivity *s, double *u) {
  hk_implicit_stage *w = s->implicit;
  if (!w->transposed) by_mass(s, u);
  s->dynamics->system.filter(&s->dynamics->system, u);
  hk_status status = solve(s, u, w->da);
  memcpy(u, w->da, 3 * s->n * sizeof *u);
  if (w->transposed) by_mass(s, u);
  return status;
}

/* ---- a stage's equation, by Newton's method ---- */

typedef struct newton {
  hk_sensitivity *s;
  const hk_stage_point *p;
  const double *fixed; /* 6n: the point without its own terms */
  double by_v, by_x, *a;
} newton;

/* R = a(X) - a, m/s^2, at the point that a leads to, and its size. */
static hk_status residual(const newton *q, double *size) {
  hk_implicit_stage *w = q->s->implicit;
  size_t v = 3 * q->s->n;
  double *X = q->p->X;
  for (size_t e = 0; e < v; e++) {
    X[e] = q->fixed[e] + q->by_x * q->a[e];
    X[v + e] = q->fixed[v + e] + q->by_v * q->a[e];
  }
  hk_status status = hk_sensitivity_evaluate(q->s->dynamics, q->p->t, X, w->R);
  for (size_t e = 0; e < v && status == HK_OK; e++) w->R[e] -= q->a[e];
  *size = status == HK_OK ? sqrt(dot(w->R, w->R, v)) : INFINITY;
  return status == HK_NOT_FINITE ? HK_OK : status;
}

/* Goes along da until the residual falls; where `once`, da is so small that it may be rounding. */
static hk_status descend(const newton *q, bool once, double *size, bool *fell) {
  hk_implicit_stage *w = q->s->implicit;
  size_t v = 3 * q->s->n;
  double part = 1, before = *size;
  memcpy(w->old, q->a, v * sizeof *q->a);
  for (int i = 0; i < HALVINGS; i++, part /= 2) {
    for (size_t e = 0; e < v; e++) q->a[e] = w->old[e] + part * w->da[e];
    hk_status status = residual(q, size);
    if (status != HK_OK) return status;
    if ((*fell = *size < before) || once) return HK_OK;
  }
  memcpy(q->a, w->old, v * sizeof *q->a);
  return residual(q, size);
}

/* Whether a change of the acceleration by da is that of rounding in the numbers of X. */
static bool is_small(const newton *q, double part) {
  size_t v = 3 * q->s->n;
  double change = 0, speed = 0, place = 0;
  for (size_t e = 0; e < v; e++) {
    change = fmax(change, fabs(q->s->implicit->da[e]));
    place = fmax(place, fabs(q->p->X[e]));
    speed = fmax(speed, fabs(q->p->X[v + e]));
  }
  return q->by_v * change <= part * (speed + place * q->by_v / q->by_x);
}

static hk_status iterate(const newton *q) {
  double size;
  bool fell = true;
  hk_status status = residual(q, &size);
  for (int i = 0; i < ITERATIONS && status == HK_OK; i++) {
    if (!isfinite(size)) break;
    status = linearise_at(q->s, q->p, q->by_v, q->by_x, false);
    if (status == HK_OK) status = hk_implicit_stage_pass(q->s, q->s->implicit->R);
    if (status != HK_OK) return status;
    bool rounding = is_small(q, 4 * DBL_EPSILON), close = is_small(q, 1e-10);
    status = descend(q, close, &size, &fell);
    if (rounding || (close && !fell)) return status;
    if (!fell) break;
  }
  if (status != HK_OK) return status;
  return hk_error_set(q->s->dynamics->error, HK_NOT_CONVERGED,
                      "Newton's method does not solve the step to t = %g s again up to rounding: take a shorter step "
                      "(--dt)",
                      q->p->t);
}

hk_status hk_implicit_stage_settle(hk_sensitivity *s, const hk_taken_step *step, size_t k, double *X, double *a) {
  const hk_stages_facet *m = hk_sensitivity_method(s, step);
  size_t v = 3 * s->n;
  double *fixed = s->implicit->old + v;
  memcpy(fixed, X, 2 * v * sizeof *X);
  newton q = {s, &s->point[k], fixed, step->h * m->v[k][k], step->h * step->h * m->x[k][k], a};
  return iterate(&q);
}
