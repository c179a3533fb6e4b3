/* The scene's solver factorizes A where it solves such matrices. One for symmetric matrices gets A without its
 * unsymmetric terms, and one for definite matrices that without what is not definite: these are preconditioners, and
 * flexible GMRES (Saad 1993, SIAM J. Sci. Comput. 14) on A itself, or its transpose, takes a direction or two where the
 * factors are those of A. */
#include "core/numerics/sensitivity/implicit_stage.h"
#include "core/numerics/matrix/matrix.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

enum { FEW = 6, DIRECTIONS = 20, RESTARTS = 10, ITERATIONS = 50, HALVINGS = 30 };

/* Residuals of a linear system in parts of its right-hand side: wanted, and enough where rounding allows no better. */
static const double wanted = 1e-14, enough = 1e-10;

/* What FEW directions have to leave of it by factors of an earlier matrix, which are made anew otherwise. */
static const double slow = 1e-9;
/* Residual of a step of Newton's method, by which the next one is as much smaller. */
static const double forcing = 1e-6;

/* What a step of Newton's method by factors of an earlier matrix may leave of the residual: a Jacobian and its solution
 * cost as much as several such steps. */
static const double worth = 0.1;

struct hk_implicit_stage {
  hk_matrix A; /* whose values are `value` */
  double *value;
  size_t room;
  bool transposed;
  /* What A is of, and what the factors are: of a matrix at another point for the same by_v and by_x, which serves as a
   * preconditioner as long as it pays. Of the matrix as it is or, by a solver of unsymmetric ones, transposed. */
  const hk_stage_point *at;
  double by_v, by_x, factor_v, factor_x;
  bool factor_transposed;
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
  for (size_t i = 0; i < A->rows; i++) {
    const double *u = x + 3 * i;
    double *own = y + 3 * i, sum[3] = {0, 0, 0};
    for (size_t e = A->row_start[i]; e < A->row_start[i + 1]; e++) {
      const double *a = w->value + 9 * e, *there = x + 3 * (size_t)A->column[e];
      double *to = y + 3 * (size_t)A->column[e];
      for (size_t p = 0; p < 3 && !w->transposed; p++)
        sum[p] += a[3 * p] * there[0] + a[3 * p + 1] * there[1] + a[3 * p + 2] * there[2];
      for (size_t p = 0; p < 3 && w->transposed; p++) to[p] += a[p] * u[0] + a[3 + p] * u[1] + a[6 + p] * u[2];
    }
    for (size_t p = 0; p < 3; p++) own[p] += sum[p];
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

/* The pattern is symmetric. */
static void transpose(const hk_implicit_stage *w, hk_matrix *A) {
  for (size_t i = 0; i < A->rows; i++)
    for (size_t e = A->row_start[i]; e < A->row_start[i + 1]; e++) {
      size_t at = hk_matrix_find(A, A->column[e], (uint32_t)i);
      for (size_t p = 0; p < 9; p++) A->value[9 * at + p / 3 + p % 3 * 3] = w->value[9 * e + p];
    }
}

/* Factors for A, of which the exact values are kept; `last` is that of the last combination. */
static hk_status factorize(hk_sensitivity *s, hk_implicit_stage *w, hk_matrix *last) {
  hk_system *system = &s->dynamics->system;
  const hk_stage_point *p = w->at;
  double by_v = w->by_v, by_x = w->by_x;
  unsigned flags;
  hk_status status = system->linear->solver_flags(system, &flags);
  w->factor_v = w->factor_x = 0;
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

static hk_status factorize_now(hk_sensitivity *s, hk_matrix *last) {
  hk_implicit_stage *w = s->implicit;
  hk_status status = factorize(s, w, last);
  if (status != HK_OK) return status;
  w->factor_v = w->by_v;
  w->factor_x = w->by_x;
  w->factor_transposed = w->transposed && !w->A.symmetric;
  return HK_OK;
}

/* Of steps whose lengths differ by rounding the factors are as good. */
static bool is_near(double a, double b) { return fabs(a - b) <= 1e-9 * fabs(b); }

static hk_status linearise_at(hk_sensitivity *s, const hk_stage_point *p, double by_v, double by_x, bool transposed) {
  hk_implicit_stage *w = s->implicit;
  hk_matrix A;
  hk_status status = combine(s, p, by_v, by_x, 0, &A);
  if (status == HK_OK) status = keep(s, w, &A);
  if (status != HK_OK) return status;
  w->transposed = transposed;
  w->at = p;
  w->by_v = by_v;
  w->by_x = by_x;
  bool turned = transposed && !A.symmetric;
  if (is_near(w->factor_v, by_v) && is_near(w->factor_x, by_x) && turned == w->factor_transposed) return HK_OK;
  return factorize_now(s, &A);
}

static hk_status factorize_again(hk_sensitivity *s) {
  hk_implicit_stage *w = s->implicit;
  hk_matrix A;
  hk_status status = combine(s, w->at, w->by_v, w->by_x, 0, &A);
  return status == HK_OK ? factorize_now(s, &A) : status;
}

hk_status hk_implicit_stage_linearise(hk_sensitivity *s, const hk_taken_step *step, size_t k, bool transposed) {
  const hk_stages_facet *m = hk_sensitivity_method(s, step);
  return linearise_at(s, &s->point[k], step->h * m->v[k][k], step->h * step->h * m->x[k][k], transposed);
}

/* ---- its solution ---- */

static double dot(const double *a, const double *b, size_t count) {
  double sum[3] = {0}; /* side by side: a sum of its own waits for each addition */
  for (size_t e = 0; e < count; e += 3)
    for (size_t c = 0; c < 3; c++) sum[c] += a[e + c] * b[e + c];
  return sum[0] + sum[1] + sum[2];
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

/* The first direction, that of the residual of x, and its size. */
static void begin(const hk_implicit_stage *w, const double *b, const double *x, size_t v, double *size) {
  product(w, x, w->V);
  for (size_t e = 0; e < v; e++) w->V[e] = b[e] - w->V[e];
  *size = sqrt(dot(w->V, w->V, v));
  for (size_t e = 0; e<v && * size> 0; e++) w->V[e] /= *size;
}

/* x += what so many directions find of A x = b, until the residual is that small. */
static hk_status add_part(hk_sensitivity *s, double size, double limit, size_t most, double *x) {
  hk_implicit_stage *w = s->implicit;
  hk_system *system = &s->dynamics->system;
  size_t v = 3 * s->n, count = 0;
  projected q;
  q.g[0] = size;
  for (bool last = false; count < most && !last; count++) {
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

/* Solves A x = b, or the transposed system, to a residual in parts of b. */
static hk_status solve(hk_sensitivity *s, const double *b, double part, double *x) {
  size_t v = 3 * s->n;
  double size = 0, before = INFINITY, of = sqrt(dot(b, b, v));
  hk_status status = HK_OK;
  memset(x, 0, v * sizeof *x);
  for (int i = 0; i <= RESTARTS && status == HK_OK; i++) {
    begin(s->implicit, b, x, v, &size);
    if (isnan(size)) return HK_NOT_FINITE;
    if (size <= part * of || (i > 2 && !(size < 0.5 * before))) break;
    if (i == 1 && size > fmax(slow, part) * of) status = factorize_again(s);
    if (status == HK_OK) status = add_part(s, size, part * of, i == 0 ? FEW : DIRECTIONS, x);
    before = size;
  }
  if (status == HK_OK) s->dynamics->system.filter(&s->dynamics->system, x);
  if (status != HK_OK || size <= fmax(part, enough) * of) return status;
  return hk_error_set(s->dynamics->error, HK_NOT_CONVERGED,
                      "the linear system of a step's derivative is solved to %.2g of its right-hand side only: take a "
                      "shorter step (--dt), or a direct solver (--solver)",
                      size / of);
}

static void by_mass(const hk_sensitivity *s, double *u) {
  for (size_t e = 0; e < 3 * s->n; e++) u[e] *= s->dynamics->state->model.mass[e / 3];
}

static hk_status pass_to(hk_sensitivity *s, double part, double *u) {
  hk_implicit_stage *w = s->implicit;
  if (!w->transposed) by_mass(s, u);
  s->dynamics->system.filter(&s->dynamics->system, u);
  hk_status status = solve(s, u, part, w->da);
  memcpy(u, w->da, 3 * s->n * sizeof *u);
  if (w->transposed) by_mass(s, u);
  return status;
}

hk_status hk_implicit_stage_pass(hk_sensitivity *s, double *u) { return pass_to(s, wanted, u); }

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

/* Goes along da, in `most` shorter parts at most, until the residual falls; where `once`, da is so small that it may be
 * rounding. */
static hk_status descend(const newton *q, int most, bool once, double *size, bool *fell) {
  hk_implicit_stage *w = q->s->implicit;
  size_t v = 3 * q->s->n;
  double part = 1, before = *size;
  memcpy(w->old, q->a, v * sizeof *q->a);
  for (int i = 0; i < most; i++, part /= 2) {
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

/* da by the factors that are there, of a matrix at an earlier point: without a Jacobian. */
static hk_status pass_by_factors(const newton *q) {
  hk_implicit_stage *w = q->s->implicit;
  hk_system *system = &q->s->dynamics->system;
  hk_solve_info info = {.tolerance = 1e-8};
  by_mass(q->s, w->R);
  system->filter(system, w->R);
  hk_status status = system->linear->solve(system, w->R, w->da, &info);
  system->filter(system, w->da);
  return status;
}

/* Whether factors of an earlier matrix are worth a step of Newton's method: the last one by them left a small part of
 * the residual, or there was none yet. */
static bool are_useful(const newton *q, double size, double before) {
  const hk_implicit_stage *w = q->s->implicit;
  bool of_these = is_near(w->factor_v, q->by_v) && is_near(w->factor_x, q->by_x) && !w->factor_transposed;
  return of_these && size <= worth * before;
}

static hk_status iterate(const newton *q) {
  double size, before = INFINITY;
  bool fell = true;
  hk_status status = residual(q, &size);
  for (int i = 0; i < ITERATIONS && status == HK_OK; i++) {
    if (!isfinite(size)) break;
    bool simply = are_useful(q, size, before);
    before = simply ? size : 0; /* and by a matrix of its own from then on */
    if (simply)
      status = pass_by_factors(q);
    else
      status = linearise_at(q->s, q->p, q->by_v, q->by_x, false);
    if (!simply && status == HK_OK) status = pass_to(q->s, forcing, q->s->implicit->R);
    if (status != HK_OK) return status;
    bool rounding = is_small(q, 4 * DBL_EPSILON), close = is_small(q, 1e-10);
    status = descend(q, simply ? 1 : HALVINGS, close, &size, &fell);
    if (rounding || (close && !fell)) return status;
    if (!fell && !simply) break;
    if (!fell) before = 0;
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
