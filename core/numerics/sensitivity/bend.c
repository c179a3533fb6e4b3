/* The curvature of the accelerations of one stage: (u.a)'' by differences, of u' da/dX along each number where
 * Jacobians are exact, of a along each number and each pair where they are not, along those alone that move. */
#include "core/numerics/sensitivity/bend.h"

#include <float.h>
#include <string.h>

static double size_of(const double *x, size_t count, bool places) {
  double most = 0;
  for (size_t e = 0; e < count; e++) most = fmax(most, fabs(x[e] - (places ? x[e % 3] : 0)));
  return most > 0 ? most : 1;
}

/* How far differences go by x and by v, of which rows of V any column that moves is not 0. */
static void reach_of(const hk_bend_pass *w, const hk_bend_point *kept, double part, double reach[2], bool *row) {
  size_t v = w->v;
  for (int half = 0; half < 2; half++) reach[half] = part * size_of(kept->X + v * (size_t)half, v, half == 0);
  for (size_t e = 0; e < 2 * v; e++) {
    row[e] = false;
    for (size_t c = 0; c < w->columns && !row[e]; c++)
      row[e] = (c >= 2 * v || !w->moves || w->moves[c]) && kept->V[e * w->columns + c] != 0;
  }
}

/* Of differences of accelerations that give first and second derivatives: eps^(1/4)/8, by which the first are off by
 * 4e-11 of the third ones and the second by a part of 1e-6, of rounding. */
static double part_of_values(void) { return pow(DBL_EPSILON, 0.25) / 8; }

hk_status hk_bend_survey(hk_bend_pass *w, const hk_stage_point *p, const hk_bend_point *kept) {
  size_t v = w->v;
  double reach[2];
  bool *row = (bool *)(w->two + 4 * v);
  hk_status status = HK_OK;
  reach_of(w, kept, part_of_values(), reach, row);
  memcpy(kept->a, p->a, v * sizeof *kept->a);
  memset(kept->A, 0, 2 * v * v * sizeof *kept->A);
  for (size_t e = 0; e < 2 * v; e++) {
    double *less = kept->beside + 2 * e * v, *more = less + v;
    for (int side = 0; side < 2 && row[e] && status == HK_OK; side++) {
      memcpy(w->two, kept->X, 2 * v * sizeof *w->two); /* an evaluation imposes pins */
      w->two[e] += (side ? 1 : -1) * reach[e >= v];
      status = hk_sensitivity_evaluate(w->s->dynamics, p->t, w->two, side ? more : less);
    }
    for (size_t i = 0; i < v && row[e]; i++) kept->A[i * 2 * v + e] = (more[i] - less[i]) / (2 * reach[e >= v]);
  }
  return status;
}

/* u' da/dX at w->X, of the scene or of one beside it. */
static hk_status product_at(hk_bend_pass *w, hk_dynamics *dynamics, double t, const double *u, double *to) {
  hk_dynamics *own = w->s->dynamics;
  const hk_stage_point there = {t, w->X, NULL};
  w->s->dynamics = dynamics;
  hk_status status = hk_sensitivity_transposed(w->s, &there, u, to, NULL, NULL);
  w->s->dynamics = own;
  return status;
}

/* A column of G by the difference of products along number e. */
static hk_status column_of(hk_bend_pass *w, double t, const double *u, size_t e, double by) {
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
static hk_status find_bent(hk_bend_pass *w, double t, const double *u, double by, bool *bent) {
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

static hk_status by_products(hk_bend_pass *w, const hk_bend_point *kept, double t, const double *u, bool *row) {
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

static double product_of(const double *u, const double *a, size_t count) {
  double sum = 0;
  for (size_t e = 0; e < count; e++) sum += u[e] * a[e];
  return sum;
}

/* u.a where number e of X is larger by `far`, and number i by `wide`. */
static hk_status value_beside(hk_bend_pass *w, hk_dynamics *dynamics, double t, const double *u, size_t e, double far,
                              size_t i, double wide, double *value) {
  memcpy(w->two, w->X, 2 * w->v * sizeof *w->X); /* an evaluation imposes pins */
  w->two[e] += far;
  w->two[i] += wide;
  hk_status status = hk_sensitivity_evaluate(dynamics, t, w->two, w->dX);
  *value = product_of(u, w->dX, w->v);
  return status;
}

/* u.a at X, and along every number that moves: how much larger it is at what is more (w->cross), and with that at what
 * is less (w->one). */
static double along_each(hk_bend_pass *w, const hk_bend_point *kept, const double *u, const bool *row) {
  size_t v = w->v;
  double here = product_of(u, kept->a, v);
  for (size_t e = 0; e < 2 * v; e++) {
    const double *less = kept->beside + 2 * e * v;
    w->cross[e] = row[e] ? product_of(u, less + v, v) - here : 0;
    w->one[e] = row[e] ? w->cross[e] + (product_of(u, less, v) - here) : 0;
  }
  return here;
}

static hk_status by_values(hk_bend_pass *w, const hk_bend_point *kept, double t, const double *u, bool *row,
                           double reach[2]) {
  size_t two_v = 2 * w->v;
  hk_status status = HK_OK;
  reach_of(w, kept, part_of_values(), reach, row);
  double here = along_each(w, kept, u, row);
  for (size_t e = 0; e < two_v; e++)
    for (size_t i = 0; i <= e && status == HK_OK && row[e]; i++) {
      double far = reach[e >= w->v], wide = reach[i >= w->v], less = 0, more = 0, bend = w->one[e];
      bool flat = (w->one[e] == 0 && w->cross[e] == 0) || (w->one[i] == 0 && w->cross[i] == 0); /* nothing changes */
      if (!row[i] || flat) continue;
      if (i < e) {
        status = value_beside(w, w->s->dynamics, t, u, e, -far, i, -wide, &less);
        if (status == HK_OK) status = value_beside(w, w->s->dynamics, t, u, e, far, i, wide, &more);
        bend = (more - here + (less - here) - w->one[e] - w->one[i]) / 2;
      }
      w->G[e * two_v + i] = w->G[i * two_v + e] = bend / (far * wide);
    }
  return status;
}

/* Behind w->two: how u' da/dX changes with control j. */
static hk_status by_control(hk_bend_pass *w, size_t j, double t, const double *u, const bool *row,
                            const double reach[2]) {
  const hk_varied *by = &w->by[j];
  size_t two_v = 2 * w->v;
  double *to = w->two + two_v;
  hk_status status = HK_OK;
  if (!w->values) {
    status = product_at(w, by->more, t, u, w->two);
    if (status == HK_OK) status = product_at(w, by->less, t, u, to);
    for (size_t e = 0; e < two_v; e++) to[e] = (w->two[e] - to[e]) / (2 * by->by);
    return status;
  }
  double here = 0, there = 0;
  status = value_beside(w, by->more, t, u, 0, 0, 0, 0, &here);
  for (size_t e = 0; e < two_v; e++) {
    double far = reach[e >= w->v];
    to[e] = 0;
    if (!row[e] || status != HK_OK) continue;
    status = value_beside(w, by->more, t, u, e, far, e, 0, &there);
    to[e] = (there - here - w->cross[e]) / (far * by->by);
  }
  return status;
}

/* H += E' cross V and its transposed, for control j with the parts E of its values at both knots. */
static void add_cross(hk_bend_pass *w, size_t j, double part, const double *V, const bool *row) {
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
static void add_bend(hk_bend_pass *w, const double *V, const bool *row) {
  size_t columns = w->columns, two_v = 2 * w->v;
  for (size_t e = 0; e < two_v; e++) {
    double *to = w->GV + e * columns;
    if (!row[e]) continue;
    memset(to, 0, columns * sizeof *to);
    for (size_t i = 0; i < two_v; i++)
      if (row[i]) hk_bend_add_rows(w, to, w->G[e * two_v + i], V + i * columns, 1);
  }
  for (size_t e = 0; e < two_v; e++)
    for (size_t c = 0; c < columns && row[e]; c++) {
      double part = V[e * columns + c], *to = w->H + c * columns;
      for (size_t b = c; b < columns && part != 0; b++) to[b] += part * w->GV[e * columns + b];
    }
}

hk_status hk_bend_add(hk_bend_pass *w, const hk_bend_point *kept, double t, const double *u) {
  size_t two_v = 2 * w->v;
  bool *row = (bool *)(w->two + 2 * two_v);
  double reach[2] = {0};
  memcpy(w->X, kept->X, two_v * sizeof *w->X);
  memset(w->G, 0, two_v * two_v * sizeof *w->G);
  hk_status status = !w->values ? by_products(w, kept, t, u, row) : by_values(w, kept, t, u, row, reach);
  if (status == HK_OK) add_bend(w, kept->V, row);
  for (size_t j = 0; j < w->controls && status == HK_OK; j++) {
    status = by_control(w, j, t, u, row, reach);
    if (status == HK_OK) add_cross(w, j, hk_bend_part(w, t), kept->V, row);
  }
  return status;
}
