/* The second derivatives of a weighted sum of the numbers at a segment's end, beside the first ones. A step is linear
 * in the accelerations of its stages, so that all curvature is theirs: with the adjoint u of a stage's acceleration a
 * and the tangents V of its point by all columns, it is the sum over stages of V' (u.a)'' V (Griewank and Walther,
 * Evaluating Derivatives, 2008, chapter 5: a tangent of the adjoint). One sweep forwards and one backwards, whatever
 * the number of columns; (u.a)'' by differences: of u' da/dX along each number where Jacobians are exact, of u.a along
 * each pair of numbers where they are not, along those alone that move. */
#include "core/numerics/sensitivity/sensitivity.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* A point of a stage, kept between the sweeps: 6n = 2v numbers of X, their derivatives V by all columns (rows), those
 * of the acceleration by X (v rows of 2v) and by the controls (v each). */
typedef struct point {
  double *X, *V, *A, *B;
} point;

typedef struct pass {
  hk_sensitivity *s;
  const hk_varied *by;
  size_t v, controls, columns; /* 3n; 2v of the state, then two of every control */
  double begin, end;           /* s, of the knots */
  const bool *moves;           /* 2v: which numbers of the state at the begin change at all; NULL: all */
  double *dZ, *a[HK_MOST_STAGES], *u[HK_MOST_STAGES]; /* rows of `columns`: 3v of the state, v a stage; v a stage */
  double *L, *dX;                                     /* 3v, 2v: adjoints */
  double *G, *GV, *cross;                             /* 4v^2; 2v x columns; 2v */
  double *X, *one, *two;                              /* 2v each */
  double *H;
  double *memory;
  point *kept;
} pass;

static double part_of(const pass *w, double t) { return (t - w->begin) / (w->end - w->begin); }

/* ---- forwards ---- */

static void add_rows(const pass *w, double *rows, double part, const double *other, size_t count) {
  for (size_t e = 0; e < count * w->columns && part != 0; e++) rows[e] += part * other[e];
}

static hk_status slopes_at(pass *w, size_t k, const point *kept) {
  hk_sensitivity *s = w->s;
  const hk_stage_point *p = &s->point[k];
  size_t v = w->v, columns = w->columns;
  memcpy(kept->X, p->X, 2 * v * sizeof *kept->X);
  hk_status status = hk_sensitivity_jacobian(s, p, kept->A);
  for (size_t j = 0; j < w->controls && status == HK_OK; j++)
    status = hk_sensitivity_by_parameter(s, p, &w->by[j], NULL, kept->B + j * v);
  double *a = w->a[k], part = part_of(w, p->t);
  memset(a, 0, v * columns * sizeof *a);
  for (size_t i = 0; i < v; i++) {
    for (size_t e = 0; e < 2 * v; e++) add_rows(w, a + i * columns, kept->A[i * 2 * v + e], kept->V + e * columns, 1);
    for (size_t j = 0; j < w->controls; j++) {
      a[i * columns + 2 * v + 2 * j] += (1 - part) * kept->B[j * v + i];
      a[i * columns + 2 * v + 2 * j + 1] += part * kept->B[j * v + i];
    }
  }
  return status;
}

static hk_status stage_of(pass *w, const hk_taken_step *step, size_t k, const point *kept) {
  const hk_stages_facet *m = w->s->method;
  size_t v = w->v, block = v * w->columns;
  double h = step->h, *dx = w->dZ, *dv = dx + block, *V = kept->V;
  if (!hk_sensitivity_evaluates(w->s, step, k)) {
    memcpy(w->a[k], dv + block, block * sizeof *dx);
    return HK_OK;
  }
  memcpy(V, dx, 2 * block * sizeof *V);
  add_rows(w, V, m->c[k] * h, dv, v);
  for (size_t j = 0; j < k; j++) {
    add_rows(w, V, h * h * m->x[k][j], w->a[j], v);
    add_rows(w, V + block, h * m->v[k][j], w->a[j], v);
  }
  return slopes_at(w, k, kept);
}

static hk_status forwards(pass *w, const hk_taken_step *step, hk_carried *Z, const point *kept) {
  const hk_stages_facet *m = w->s->method;
  size_t v = w->v, block = v * w->columns;
  hk_status status = hk_sensitivity_step(w->s, step, Z);
  for (size_t k = 0; k < m->count && status == HK_OK; k++) status = stage_of(w, step, k, &kept[k]);
  add_rows(w, w->dZ, step->h, w->dZ + block, v);
  for (size_t k = 0; k < m->count; k++) {
    add_rows(w, w->dZ, step->h * step->h * m->x_end[k], w->a[k], v);
    add_rows(w, w->dZ + block, step->h * m->v_end[k], w->a[k], v);
  }
  memcpy(w->dZ + 2 * block, w->a[m->count - 1], block * sizeof *w->dZ);
  return status;
}

/* ---- the curvature of a stage ---- */

static double size_of(const double *x, size_t count, bool places) {
  double most = 0;
  for (size_t e = 0; e < count; e++) most = fmax(most, fabs(x[e] - (places ? x[e % 3] : 0)));
  return most > 0 ? most : 1;
}

/* How far differences go by x and by v, of which rows of V any column that moves is not 0. */
static void reach_of(const pass *w, const point *kept, double part, double reach[2], bool *row) {
  size_t v = w->v;
  for (int half = 0; half < 2; half++) reach[half] = part * size_of(kept->X + v * (size_t)half, v, half == 0);
  for (size_t e = 0; e < 2 * v; e++) {
    row[e] = false;
    for (size_t c = 0; c < w->columns && !row[e]; c++)
      row[e] = (c >= 2 * v || !w->moves || w->moves[c]) && kept->V[e * w->columns + c] != 0;
  }
}

/* u' da/dX at w->X, of the scene or of one beside it. */
static hk_status product_at(pass *w, hk_dynamics *dynamics, double t, const double *u, double *to) {
  hk_dynamics *own = w->s->dynamics;
  const hk_stage_point there = {t, w->X, NULL};
  w->s->dynamics = dynamics;
  hk_status status = hk_sensitivity_transposed(w->s, &there, u, to, NULL);
  w->s->dynamics = own;
  return status;
}

/* A column of G by the difference of products along number e. */
static hk_status column_of(pass *w, double t, const double *u, size_t e, double by) {
  size_t two_v = 2 * w->v;
  double before = w->X[e];
  w->X[e] += by;
  double taken = w->X[e] - before;
  hk_status status = product_at(w, w->s->dynamics, t, u, w->two);
  w->X[e] = before;
  for (size_t i = 0; i < two_v; i++) w->G[i * two_v + e] = (w->two[i] - w->one[i]) / taken;
  return status;
}

/* Whether u' da/dv changes with v, by a bit, where all speeds do. */
static hk_status find_bent(pass *w, double t, const double *u, double by, bool *bent) {
  size_t v = w->v;
  uint32_t chance = 1;
  memcpy(w->cross, w->X + v, v * sizeof *w->X);
  for (size_t e = 0; e < v; e++) {
    chance = chance * 1664525 + 1013904223; /* Knuth 1981, vol. 2, 3.3.4 */
    w->X[v + e] += by * (0.5 + (chance >> 9) * 0x1p-24);
  }
  hk_status status = product_at(w, w->s->dynamics, t, u, w->two);
  memcpy(w->X + v, w->cross, v * sizeof *w->X);
  *bent = memcmp(w->two + v, w->one + v, v * sizeof *w->two) != 0;
  return status;
}

static hk_status by_products(pass *w, const point *kept, double t, const double *u, bool *row) {
  size_t v = w->v, two_v = 2 * v;
  double reach[2];
  bool bent = false;
  reach_of(w, kept, 0x1p-23, reach, row); /* eps^(1/2), and some more: one-sided */
  hk_status status = product_at(w, w->s->dynamics, t, u, w->one);
  for (size_t e = 0; e < v && status == HK_OK; e++)
    if (row[e]) status = column_of(w, t, u, e, reach[0]);
  if (status == HK_OK) status = find_bent(w, t, u, reach[1], &bent);
  for (size_t e = v; e < two_v && status == HK_OK && bent; e++)
    if (row[e]) status = column_of(w, t, u, e, reach[1]);
  for (size_t e = 0; e < v; e++) /* by x and v, of which the first kind is there */
    for (size_t i = v; i < two_v; i++)
      if (row[e]) w->G[e * two_v + i] = w->G[i * two_v + e];
  return status;
}

static hk_status value_at(pass *w, hk_dynamics *dynamics, double t, const double *u, double *value) {
  memcpy(w->two, w->X, 2 * w->v * sizeof *w->X); /* an evaluation imposes pins */
  hk_status status = hk_sensitivity_evaluate(dynamics, t, w->two, w->dX);
  *value = 0;
  for (size_t e = 0; e < w->v; e++) *value += u[e] * w->dX[e];
  return status;
}

/* u.a beside the point: numbers e and i larger by their reach times side. */
static hk_status value_beside(pass *w, hk_dynamics *dynamics, double t, const double *u, const size_t at[2],
                              const double by[2], double *value) {
  double before[2] = {w->X[at[0]], w->X[at[1]]};
  w->X[at[0]] += by[0];
  if (at[1] != at[0]) w->X[at[1]] += by[1];
  hk_status status = value_at(w, dynamics, t, u, value);
  w->X[at[0]] = before[0];
  w->X[at[1]] = before[1];
  return status;
}

/* u.a at X, and along every number that moves to both sides (w->one: the sum of both less twice that at X; w->cross:
 * the difference). */
static hk_status along_each(pass *w, double t, const double *u, const double reach[2], const bool *row, double *here) {
  hk_status status = value_at(w, w->s->dynamics, t, u, here);
  for (size_t e = 0; e < 2 * w->v && status == HK_OK; e++) {
    double value[2] = {0};
    for (int side = 0; side < 2 && status == HK_OK && row[e]; side++) {
      double by = (side ? 1 : -1) * reach[e >= w->v];
      status = value_beside(w, w->s->dynamics, t, u, (size_t[]){e, e}, (double[]){by, by}, &value[side]);
    }
    w->one[e] = row[e] ? value[0] - 2 * *here + value[1] : 0;
    w->cross[e] = row[e] ? value[1] - value[0] : 0;
  }
  return status;
}

static hk_status by_values(pass *w, const point *kept, double t, const double *u, bool *row, double reach[2]) {
  size_t two_v = 2 * w->v;
  double here;
  reach_of(w, kept, pow(DBL_EPSILON, 0.25) / 8, reach, row);
  hk_status status = along_each(w, t, u, reach, row, &here);
  for (size_t e = 0; e < two_v; e++)
    for (size_t i = 0; i <= e && status == HK_OK && row[e]; i++) {
      double by[2] = {reach[e >= w->v], reach[i >= w->v]}, sum = 0;
      bool flat =
          (w->one[e] == 0 && w->cross[e] == 0) || (w->one[i] == 0 && w->cross[i] == 0); /* nothing changes by it */
      if (!row[i] || flat) continue;
      for (int side = 0; side < 2 && i < e && status == HK_OK; side++) {
        double value, to[2] = {side ? by[0] : -by[0], side ? by[1] : -by[1]};
        status = value_beside(w, w->s->dynamics, t, u, (size_t[]){e, i}, to, &value);
        sum += value - here;
      }
      double bend = i == e ? w->one[e] : (sum - w->one[e] - w->one[i]) / 2;
      w->G[e * two_v + i] = w->G[i * two_v + e] = bend / (by[0] * by[1]);
    }
  return status;
}

/* w->dX: how u' da/dX changes with control j; w->cross has the differences of u.a along each number. */
static hk_status by_control(pass *w, size_t j, double t, const double *u, const bool *row, const double reach[2]) {
  const hk_varied *by = &w->by[j];
  size_t two_v = 2 * w->v;
  double *to = w->two + two_v;
  hk_status status = HK_OK;
  if (w->s->all_exact) {
    status = product_at(w, by->more, t, u, w->two);
    if (status == HK_OK) status = product_at(w, by->less, t, u, to);
    for (size_t e = 0; e < two_v; e++) to[e] = (w->two[e] - to[e]) / (2 * by->by);
    return status;
  }
  for (size_t e = 0; e < two_v && status == HK_OK; e++) {
    double value[2] = {0};
    for (int side = 0; side < 2 && status == HK_OK && row[e]; side++) {
      double far = (side ? 1 : -1) * reach[e >= w->v];
      status = value_beside(w, by->more, t, u, (size_t[]){e, e}, (double[]){far, far}, &value[side]);
    }
    to[e] = row[e] ? (value[1] - value[0] - w->cross[e]) / (2 * reach[e >= w->v] * by->by) : 0;
  }
  return status;
}

/* H += E' cross V and its transposed, for control j with the parts E of its values at both knots. */
static void add_cross(pass *w, size_t j, double part, const double *V, const bool *row) {
  size_t columns = w->columns, two_v = 2 * w->v, own = two_v + 2 * j;
  const double *cross = w->two + two_v;
  for (size_t e = 0; e < two_v; e++) {
    if (!row[e] || cross[e] == 0) continue;
    for (size_t c = 0; c < columns; c++) {
      double first = (1 - part) * cross[e] * V[e * columns + c], second = part * cross[e] * V[e * columns + c];
      w->H[own * columns + c] += first;
      w->H[c * columns + own] += first;
      w->H[(own + 1) * columns + c] += second;
      w->H[c * columns + own + 1] += second;
    }
  }
}

/* H += V' G V, its upper triangle */
static void add_bend(pass *w, const double *V, const bool *row) {
  size_t columns = w->columns, two_v = 2 * w->v;
  for (size_t e = 0; e < two_v; e++) {
    double *to = w->GV + e * columns;
    if (!row[e]) continue;
    memset(to, 0, columns * sizeof *to);
    for (size_t i = 0; i < two_v; i++)
      if (row[i]) add_rows(w, to, w->G[e * two_v + i], V + i * columns, 1);
  }
  for (size_t e = 0; e < two_v; e++)
    for (size_t c = 0; c < columns && row[e]; c++) {
      double part = V[e * columns + c], *to = w->H + c * columns;
      for (size_t b = c; b < columns && part != 0; b++) to[b] += part * w->GV[e * columns + b];
    }
}

static hk_status bend_of(pass *w, const point *kept, double t, const double *u) {
  size_t two_v = 2 * w->v;
  bool *row = (bool *)(w->two + 2 * two_v);
  double reach[2] = {0};
  memcpy(w->X, kept->X, two_v * sizeof *w->X);
  memset(w->G, 0, two_v * two_v * sizeof *w->G);
  hk_status status = w->s->all_exact ? by_products(w, kept, t, u, row) : by_values(w, kept, t, u, row, reach);
  if (status == HK_OK) add_bend(w, kept->V, row);
  for (size_t j = 0; j < w->controls && status == HK_OK; j++) {
    status = by_control(w, j, t, u, row, reach);
    if (status == HK_OK) add_cross(w, j, part_of(w, t), kept->V, row);
  }
  return status;
}

/* ---- backwards ---- */

static hk_status back_stage(pass *w, const hk_taken_step *step, size_t k, const point *kept) {
  const hk_stages_facet *m = w->s->method;
  size_t v = w->v;
  double h = step->h, *L = w->L, *dX = w->dX;
  if (!hk_sensitivity_evaluates(w->s, step, k)) {
    memcpy(L + 2 * v, w->u[k], v * sizeof *L);
    return HK_OK;
  }
  hk_status status = bend_of(w, kept, step->t + m->c[k] * h, w->u[k]);
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

static hk_status backwards(pass *w, const hk_taken_step *step, const point *kept) {
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

static hk_status both_ways(pass *w, size_t first, size_t last, hk_carried *Z) {
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

static bool reserve(pass *w, size_t steps) {
  size_t v = w->v, stages = w->s->method->count, points = steps * stages, columns = w->columns, block = v * columns;
  size_t each = 2 * v + 2 * block + 2 * v * v + w->controls * v;
  w->memory =
      calloc(points * each + 3 * block + stages * (block + v) + 4 * v * v + 2 * block + 20 * v + 1, sizeof(double));
  w->kept = calloc(points + 1, sizeof *w->kept);
  if (!w->memory || !w->kept) return false;
  double *at = w->memory;
  for (size_t k = 0; k < points; k++)
    w->kept[k] = (point){take(&at, 2 * v), take(&at, 2 * block), take(&at, 2 * v * v), take(&at, w->controls * v)};
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

hk_status hk_sensitivity_curvature(hk_sensitivity *s, size_t first, size_t last, double *X, const hk_varied *by,
                                   size_t controls, const bool *moves, const double *weight, double *J, double *H,
                                   hk_error *error) {
  size_t v = 3 * s->n, columns = 2 * v + 2 * controls;
  pass w = {.s = s, .by = by, .v = v, .controls = controls, .columns = columns, .moves = moves, .H = H};
  hk_carried *Z = calloc(3 * v + 1, sizeof *Z);
  hk_status status = Z && reserve(&w, last - first) ? HK_OK : HK_NO_MEMORY;
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
  free(w.memory);
  free(w.kept);
  free(Z);
  if (status != HK_OK && error->status == HK_OK) hk_error_set(error, status, "%s", s->dynamics->error->text);
  return status;
}
