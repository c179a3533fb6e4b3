/* See cone_program.h. The program is solved by its dual with R = 1e-7 of D's diagonal added to D: the least of f(y) =
 * y.D y/2 + sum of |P(-u)|^2/(2 R) with u = u_0 + D y and P the projection on an impact's cone; there D y = D z with z
 * = P(-u)/R. f is convex and piecewise nearly quadratic, so that Newton's iteration, (R + P' D) dy = -(R y - P), with a
 * search for the least f along dy finds it from anywhere (Todorov 2014, Convex and analytically-invertible dynamics
 * with contacts and constraints, ICRA, section III). */
#include "plugins/common/cones/cone_program.h"

#include <math.h>
#include <string.h>

enum { ROUNDS = 60, SLIDES = 6 /* programs */, SEARCHES = 40 };

/* R over D's diagonal, one after the other: a soft program is solved from anywhere in some rounds, the next from there.
 */
static const double regular[] = {1e-3, 1e-5, 1e-7};

/* Of the largest R z, what a program leaves; of the largest u_0, what the sequence does. */
static const double least_change = 1e-6;

typedef struct work {
  const hk_cone_program *p;
  double regular;
  double *y, *u, *du, *P, *rhs, *shifted; /* size */
} work;

static double size_of(double a, double b) { return sqrt(a * a + b * b); }

static size_t unknowns(const hk_cone_program *p, size_t k) { return p->mu[k] > 0 ? 3 : 1; }

static double R_of(const work *w, size_t k) { return w->regular * w->p->D[w->p->first[k] * (w->p->size + 1)]; }

bool hk_eliminate(double *A, double *rhs, size_t n) {
  for (size_t j = 0; j < n; j++) {
    size_t best = j;
    for (size_t r = j + 1; r < n; r++)
      if (fabs(A[r * n + j]) > fabs(A[best * n + j])) best = r;
    if (!(fabs(A[best * n + j]) > 0)) return false;
    for (size_t c = j; c < n && best != j; c++) {
      double kept = A[j * n + c];
      A[j * n + c] = A[best * n + c];
      A[best * n + c] = kept;
    }
    double kept = rhs[j];
    rhs[j] = rhs[best];
    rhs[best] = kept;
    for (size_t r = j + 1; r < n; r++) {
      double part = A[r * n + j] / A[j * n + j];
      if (part == 0) continue;
      for (size_t c = j + 1; c < n; c++) A[r * n + c] -= part * A[j * n + c];
      rhs[r] -= part * rhs[j];
    }
  }
  for (size_t j = n; j-- > 0;) {
    for (size_t c = j + 1; c < n; c++) rhs[j] -= A[j * n + c] * rhs[c];
    rhs[j] /= A[j * n + j];
  }
  return true;
}

/* ---- the projection on a cone ---- */

void hk_cone_project(const double *u, size_t unknowns, double mu, double P[3], double *J) {
  double w[3] = {-u[0], 0, 0}, across = 0;
  if (J) memset(J, 0, 9 * sizeof *J);
  for (size_t c = 1; c < unknowns; c++) w[c] = -u[c], across = size_of(across, w[c]);
  bool inside = unknowns == 1 ? w[0] > 0 : across <= mu * w[0], outside = unknowns == 1 || mu * across <= -w[0];
  for (size_t c = 0; c < unknowns; c++) {
    P[c] = inside ? w[c] : 0;
    if (J && inside) J[4 * c] = 1;
  }
  if (inside || outside) return;
  double d[2] = {w[1] / across, w[2] / across}, e[3] = {1, mu * d[0], mu * d[1]}, scale = 1 / (1 + mu * mu);
  P[0] = (w[0] + mu * across) * scale;
  for (int c = 1; c < 3; c++) P[c] = P[0] * e[c];
  for (int a = 0; a < 3 && J; a++)
    for (int b = 0; b < 3; b++) {
      J[3 * a + b] = e[a] * e[b] * scale;
      if (a > 0 && b > 0) J[3 * a + b] += mu * P[0] / across * ((a == b) - d[a - 1] * d[b - 1]);
    }
}

static void project_all(const work *w, const double *u) {
  for (size_t k = 0; k < w->p->count; k++)
    hk_cone_project(u + w->p->first[k], unknowns(w->p, k), w->p->mu[k], w->P + w->p->first[k], NULL);
}

/* ---- Newton's iteration ---- */

static void multiply(const hk_cone_program *p, const double *y, double *out) {
  for (size_t i = 0; i < p->size; i++) {
    double sum = 0;
    for (size_t j = 0; j < p->size; j++) sum += p->D[i * p->size + j] * y[j];
    out[i] = sum;
  }
}

static void set_rows(const work *w) {
  const hk_cone_program *p = w->p;
  memset(p->matrix, 0, p->size * p->size * sizeof *p->matrix);
  for (size_t k = 0; k < p->count; k++) {
    double J[9], R = R_of(w, k);
    size_t i = p->first[k], m = unknowns(p, k);
    hk_cone_project(w->u + i, m, p->mu[k], w->P + i, J);
    for (size_t a = 0; a < m; a++) {
      double *row = p->matrix + (i + a) * p->size;
      for (size_t b = 0; b < m; b++)
        for (size_t j = 0; j < p->size && J[3 * a + b] != 0; j++) row[j] += J[3 * a + b] * p->D[(i + b) * p->size + j];
      row[i + a] += R;
      w->rhs[i + a] = w->P[i + a] - R * w->y[i + a];
    }
  }
}

/* The derivative of f at y + t dy, along dy. */
static double slope(const work *w, double t) {
  const hk_cone_program *p = w->p;
  double sum = 0;
  for (size_t i = 0; i < p->size; i++) w->shifted[i] = w->u[i] + t * w->du[i];
  project_all(w, w->shifted);
  for (size_t k = 0; k < p->count; k++)
    for (size_t i = p->first[k]; i < p->first[k] + unknowns(p, k); i++)
      sum += w->du[i] * (w->y[i] + t * w->rhs[i] - w->P[i] / R_of(w, k));
  return sum;
}

/* How far to go along dy: f is least there. */
static double length_of_step(const work *w) {
  double low = 0, high = 1, start = slope(w, 0);
  if (slope(w, 1) <= 1e-9 * fabs(start)) return 1;
  for (int k = 0; k < SEARCHES; k++) {
    double middle = (low + high) / 2;
    if (slope(w, middle) > 0)
      high = middle;
    else
      low = middle;
  }
  return (low + high) / 2;
}

/* The largest of what is left of u, over the largest R z. */
static double left_of(const work *w) {
  double most = 0, scale = 0;
  for (size_t k = 0; k < w->p->count; k++)
    for (size_t i = w->p->first[k]; i < w->p->first[k] + unknowns(w->p, k); i++) {
      scale = fmax(scale, fabs(w->P[i]));
      most = fmax(most, fabs(w->rhs[i]));
    }
  return scale > 0 ? most / scale : most;
}

static bool solve_program(const work *w, const double *u_0) {
  const hk_cone_program *p = w->p;
  for (int round = 0; round < ROUNDS; round++) {
    multiply(p, w->y, w->u);
    for (size_t i = 0; i < p->size; i++) w->u[i] += u_0[i];
    set_rows(w);
    if (left_of(w) <= least_change) return true;
    if (!hk_eliminate(p->matrix, w->rhs, p->size)) return false;
    multiply(p, w->rhs, w->du);
    double t = length_of_step(w);
    if (!isfinite(t)) return false;
    for (size_t i = 0; i < p->size; i++) w->y[i] += t * w->rhs[i];
  }
  return false;
}

/* ---- the sequence ---- */

static bool solve_harder(work *w, const double *u_0) {
  for (size_t k = 0; k < sizeof regular / sizeof *regular; k++) {
    w->regular = regular[k];
    if (!solve_program(w, u_0)) return false;
  }
  return true;
}

/* The next program's u_0, with mu |u_t| along n. Returns the largest change. */
static double slide_on(const work *w, double *u_0) {
  const hk_cone_program *p = w->p;
  double most = 0;
  multiply(p, w->y, w->u);
  for (size_t k = 0; k < p->count; k++) {
    size_t i = p->first[k];
    if (unknowns(p, k) == 1) continue;
    double next = p->u_0[i] + p->mu[k] * size_of(w->u[i + 1] + p->u_0[i + 1], w->u[i + 2] + p->u_0[i + 2]);
    most = fmax(most, fabs(next - u_0[i]));
    u_0[i] = next;
  }
  return most;
}

bool hk_cone_program_solve(const hk_cone_program *p) {
  size_t n = p->size;
  double *r = p->room, *u_0 = r + 6 * n, largest = 0;
  work w = {.p = p, .y = r, .u = r + n, .du = r + 2 * n, .P = r + 3 * n, .rhs = r + 4 * n, .shifted = r + 5 * n};
  memcpy(w.y, p->z, n * sizeof *w.y);
  memcpy(u_0, p->u_0, n * sizeof *u_0);
  for (size_t i = 0; i < n; i++) largest = fmax(largest, fabs(p->u_0[i]));
  bool solved = solve_harder(&w, u_0);
  for (int round = 0; round < SLIDES && solved && slide_on(&w, u_0) > least_change * largest; round++)
    solved = solve_harder(&w, u_0);
  for (size_t k = 0; k < p->count; k++)
    for (size_t i = p->first[k]; i < p->first[k] + unknowns(p, k); i++) p->z[i] = w.P[i] / R_of(&w, k);
  return solved;
}
