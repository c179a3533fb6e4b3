#include "plugins/common/liquid_viscosity/viscous_flow.h"
#include "plugins/common/liquid/couple.h"

#include <string.h>

enum { MOST_PRESSURES = 8, BODY = 6 };

static const double most_moved = 1e-3;      /* of a cell in a step, of what is stiff */
static const double most_divergence = 1e-6; /* of a cell in a step, that rounding may leave */

/* ---- all velocities as one list ---- */

static size_t numbers_of(const hk_liquid *l) {
  return 3 * l->grid.size + BODY * l->bodies.count + 3 * (l->thin.triangles ? l->thin.vertices : 0);
}

/* Copies the numbers to the list, or the list to them. */
static size_t copy(double *list, double *own, size_t count, bool back) {
  if (own && count) memcpy(back ? own : list, back ? list : own, count * sizeof *list);
  return count;
}

static void copy_all(hk_liquid *l, double *list, bool back) {
  for (int a = 0; a < 3; a++) list += copy(list, l->grid.u[a], l->grid.size, back);
  for (size_t b = 0; b < l->bodies.count; b++) {
    list += copy(list, l->bodies.body[b].velocity, 3, back);
    list += copy(list, l->bodies.body[b].spin, 3, back);
  }
  for (size_t k = 0; l->thin.triangles && k < l->thin.vertices; k++) list += copy(list, l->thin.vertex[k].v, 3, back);
}

static void put_back(hk_liquid *l, double *list) {
  copy_all(l, list, true);
  if (l->bodies.count) hk_liquid_move_bodies(l);
  if (l->thin.triangles) hk_liquid_move_thin_faces(l);
}

/* ---- what is stiff ---- */

/* By how much of itself a strain of one cell, of the viscosity mu, is less after the viscous step: near 1 if it is
 * stiff. */
static double stiffness(const hk_liquid *l, double mu, double h) {
  double side = INFINITY;
  for (int c = 0; c < 3; c++) side = l->grid.flat[c] ? side : fmin(side, l->grid.spacing[c]);
  double times = h * mu / (l->density * side * side);
  return times / (1 + times);
}

/* Of a cell, how far the change of the velocities moves what is stiff in h, s. */
static double moved(const hk_liquid *l, const hk_liquid_viscosity *v, const double *change, double h) {
  const hk_liquid_grid *g = &l->grid;
  double most = 0;
  for (size_t k = 0; k < l->pressure.rows; k++)
    for (int c = 0; c < 3; c++) {
      size_t i = l->pressure.cell[k], j = i - g->stride[c];
      if (g->flat[c] || g->unknown[j] == HK_LIQUID_NONE) continue;
      double way = h * fabs(change[(size_t)c * g->size + i]) / g->spacing[c];
      if (way > most) most = fmax(most, way * stiffness(l, fmin(v->cell[i], v->cell[j]), h));
    }
  return most;
}

/* ---- the step ---- */

/* Lists of velocities. `left` is what a projection changes after the viscous step from what is given: a pressure's
 * slope, and what is left of the equations. Along a way, by which what is given changes, `gain` is the change of what
 * is left, and `rise` that of what is projected. */
enum { GIVEN, PROJECTED, LEFT, WAY, GAIN, RISE, LAST_WAY, LAST_GAIN, LAST_RISE, LISTS };

static hk_status make_lists(hk_liquid_viscosity *v, const hk_host *host, size_t size, size_t count, double **list) {
  if (!v->guess) v->guess = host->allocate(host, size * sizeof *v->guess);
  if (count > v->listed) {
    host->release(host, v->lists);
    v->lists = host->allocate(host, LISTS * count * sizeof *v->lists);
    v->listed = v->lists ? count : 0;
  }
  for (size_t k = 0; k < LISTS && v->lists; k++) list[k] = v->lists + k * count;
  return v->lists && v->guess ? HK_OK
                              : host->fail(host, HK_NO_MEMORY, "no memory for the velocities of a viscous liquid");
}

static double dot(const double *a, const double *b, size_t count) {
  double sum = 0;
  for (size_t i = 0; i < count; i++) sum += a[i] * b[i];
  return sum;
}

static void add(double *to, double by, const double *list, size_t count) {
  for (size_t i = 0; i < count; i++) to[i] += by * list[i];
}

/* From the velocities that the liquid has, which are given, to those that are projected and what that changes. */
static hk_status evaluate(hk_liquid *l, hk_liquid_viscosity *v, double h, double *guess, double *projected,
                          double *left, size_t count) {
  hk_status status = hk_liquid_shear(l, v, h);
  copy_all(l, left, false);
  if (status == HK_OK) status = hk_liquid_project(l, guess);
  copy_all(l, projected, false);
  for (size_t i = 0; i < count; i++) left[i] = projected[i] - left[i];
  return status;
}

static void drop_part(double **list, size_t count) {
  double size = dot(list[LAST_GAIN], list[LAST_GAIN], count);
  double part = size > 0 ? dot(list[GAIN], list[LAST_GAIN], count) / size : 0;
  for (int k = WAY; k <= RISE; k++) add(list[k], -part, list[k + LAST_WAY - WAY], count);
}

static void go(double **list, size_t count) {
  double size = dot(list[GAIN], list[GAIN], count);
  double part = size > 0 ? -dot(list[LEFT], list[GAIN], count) / size : 0;
  add(list[GIVEN], part, list[WAY], count);
  add(list[PROJECTED], part, list[RISE], count);
  add(list[LEFT], part, list[GAIN], count);
}

/* Makes what is left as small as a step along itself and the last one allow. */
static hk_status improve(hk_liquid *l, hk_liquid_viscosity *v, double h, double **list, size_t count, bool first) {
  memcpy(list[WAY], list[GIVEN], count * sizeof *list[WAY]);
  add(list[WAY], 1, list[LEFT], count);
  put_back(l, list[WAY]);
  memcpy(list[WAY], list[LEFT], count * sizeof *list[WAY]);
  memset(v->guess, 0, l->grid.size * sizeof *v->guess);
  hk_status status = evaluate(l, v, h, v->guess, list[RISE], list[GAIN], count);
  if (status != HK_OK) return status;
  add(list[RISE], -1, list[PROJECTED], count);
  add(list[GAIN], -1, list[LEFT], count);
  if (!first) drop_part(list, count);
  go(list, count);
  for (int k = WAY; k <= RISE; k++) {
    double *swap = list[k];
    list[k] = list[k + LAST_WAY - WAY], list[k + LAST_WAY - WAY] = swap;
  }
  return HK_OK;
}

hk_status hk_viscous_flow(hk_liquid *l, hk_liquid_viscosity *v, double h, double *guess) {
  double *list[LISTS];
  size_t count = numbers_of(l);
  if (!v->cell) {
    hk_status status = hk_liquid_shear(l, v, h);
    return status == HK_OK ? hk_liquid_project(l, guess) : status;
  }
  hk_status status = make_lists(v, l->host, l->grid.size, count, list);
  if (status != HK_OK) return status;
  copy_all(l, list[GIVEN], false);
  status = evaluate(l, v, h, guess, list[PROJECTED], list[LEFT], count);
  int k = 0;
  for (; status == HK_OK && k < MOST_PRESSURES && moved(l, v, list[LEFT], h) > most_moved; k++)
    status = improve(l, v, h, list, count, k == 0);
  if (status != HK_OK || k == 0) return status;
  put_back(l, list[PROJECTED]);
  l->left = hk_liquid_divergence(l);
  if (!(h * l->left > most_divergence)) return HK_OK;
  memset(v->guess, 0, l->grid.size * sizeof *v->guess);
  return hk_liquid_project(l, v->guess);
}
