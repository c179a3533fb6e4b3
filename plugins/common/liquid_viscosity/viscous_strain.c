#include "plugins/common/liquid_viscosity/viscous_strain.h"

static const double nearest_wall = 0.1; /* of the way to the next face: a wall is no nearer */

/* The part below a flat surface at the distance s, in cells. */
static double part_of(double s) { return fmin(1, fmax(0, 0.5 - s)); }

static size_t number_along(const hk_liquid_grid *g, size_t at, int c) { return at / g->stride[c] % (g->cells[c] + 2); }

static bool in_box(const hk_liquid_grid *g, size_t cell) {
  for (int c = 0; c < 3; c++) {
    size_t k = number_along(g, cell, c);
    if (k < 1 || k > g->cells[c]) return false;
  }
  return true;
}

/* Whether cell i, and the one below it along each axis, is in the box along that axis. */
static void find_place(const hk_liquid_grid *g, size_t i, bool in[3][2]) {
  for (int c = 0; c < 3; c++) {
    size_t k = number_along(g, i, c);
    in[c][0] = k >= 1 && k <= g->cells[c];
    in[c][1] = k >= 2 && k <= g->cells[c] + 1;
  }
}

/* The mean distance to the surface of those that are in the box of the cells i, i - s[0], i - s[1] and i - s[0] - s[1],
 * s being the strides of the axes a and b, or with b = -1 of the first two. Divisions that locate cells are what this
 * costs: only i is located. */
static double mean_distance(const hk_liquid_grid *g, size_t i, int a, int b) {
  bool in[3][2];
  double sum = 0;
  int count = 0;
  find_place(g, i, in);
  for (int k = 0; k < (b < 0 ? 2 : 4); k++) {
    int p = k % 2, q = k / 2;
    bool within = true;
    for (int c = 0; c < 3; c++) within = within && in[c][c == a ? p : c == b ? q : 0];
    if (within) sum += g->distance[i - (p ? g->stride[a] : 0) - (q ? g->stride[b] : 0)], count++;
  }
  return count ? sum / count : 1;
}

/* Face `at` of component a is closed: what it adds is known, but for the motion of a body. The wall is on the way to
 * the face at `beside`, `back` of it from the closed one, and its velocity is that which it has there: with that of the
 * closed face a drum of 13 cells would have turned its liquid 8 % faster than itself. */
static void add_wall(const hk_liquid *l, int a, size_t at, size_t beside, double back, double by, hk_strain *e) {
  const hk_liquid_grid *g = &l->grid;
  const hk_liquid_bodies *bodies = &l->bodies;
  uint16_t owner = bodies->count ? bodies->owner[a][at] : 0;
  double *x = e->covered_at[e->covered], open[3], u[3];
  hk_liquid_face_place(g, at, a, x);
  hk_liquid_face_place(g, beside, a, open);
  for (int c = 0; c < 3; c++) x[c] += back * (open[c] - x[c]);
  if (owner) {
    hk_liquid_body_velocity(&bodies->body[owner - 1], x, u);
    e->walls += by * u[a];
  } else {
    bool moves = back > 0 && !l->stood && in_box(g, at) && !hk_thin_walls_at(&l->thin, a, at);
    e->walls += by * (moves ? hk_liquid_obstacle_speed(l, x, a) : g->wall[a][at]);
  }
  if (owner == 0 || !bodies->body[owner - 1].free || !bodies->body[owner - 1].wet) return;
  e->body[e->covered] = (uint16_t)(owner - 1);
  e->covered_axis[e->covered] = a;
  e->covered_by[e->covered++] = by;
}

/* m, from the centre of a face of component a to the nearest obstacle: the mean of its corners. */
static double to_obstacle(const hk_liquid_grid *g, size_t i, int a) {
  int b = a == 0 ? 1 : 0, c = 3 - a - b;
  size_t s = g->flat[b] ? 0 : g->stride[b], t = g->flat[c] ? 0 : g->stride[c];
  return (g->solid[i] + g->solid[i + s] + g->solid[i + t] + g->solid[i + s + t]) / 4;
}

bool hk_viscous_face_held(const hk_liquid *l, size_t i, int a, bool slip) {
  double open = l->grid.open[a][i];
  return !(open > 0) || (!slip && open < 1 && to_obstacle(&l->grid, i, a) < 0);
}

double hk_liquid_part_of_face(const hk_liquid *l, size_t i, int a) {
  const hk_liquid_grid *g = &l->grid;
  return part_of(mean_distance(g, i, a, -1));
}

/* The numbers of faces are as many as are counted: the rest is not cleared. */
static void begin(hk_strain *e, double weight) {
  e->count = e->covered = 0;
  e->walls = 0;
  e->weight = weight;
}

void hk_strain_along(const hk_liquid *l, size_t i, int a, bool slip, hk_strain *e) {
  const hk_liquid_grid *g = &l->grid;
  double unit = 1 / g->spacing[a];
  begin(e, 2 * part_of(g->distance[i]));
  if (!(e->weight > 0)) return;
  for (int k = 0; k < 2; k++) {
    size_t at = k ? i + g->stride[a] : i;
    double by = k ? unit : -unit;
    if (hk_viscous_face_held(l, at, a, slip)) {
      add_wall(l, a, at, at, 0, by, e);
      continue;
    }
    e->axis[e->count] = a;
    e->at[e->count] = at;
    e->by[e->count++] = by;
  }
}

/* Where the wall is between the centre of an open face and that of one which is not, by their distance: the box is in
 * the middle. */
static double part_to_wall(const hk_liquid *l, int a, size_t open, size_t closed) {
  const hk_liquid_grid *g = &l->grid;
  for (int c = 0; c < 3; c++)
    if (c != a && (number_along(g, closed, c) < 1 || number_along(g, closed, c) > g->cells[c])) return 0.5;
  double near = to_obstacle(g, open, a), beyond = to_obstacle(g, closed, a);
  return near > 0 && beyond < 0 ? fmax(nearest_wall, near / (near - beyond)) : nearest_wall;
}

/* Adds the difference of component a across the edge, by the spacing. Returns the part of the way that is liquid: less
 * than 1 where it ends at a wall, whose velocity is then counted in. */
static double add_difference(const hk_liquid *l, int a, size_t below, size_t above, double unit, bool slip,
                             hk_strain *e) {
  const size_t at[2] = {below, above};
  const bool open[2] = {!hk_viscous_face_held(l, below, a, slip), !hk_viscous_face_held(l, above, a, slip)};
  double part = 1;
  if (open[0] != open[1]) part = part_to_wall(l, a, open[0] ? below : above, open[0] ? above : below);
  for (int k = 0; k < 2; k++) {
    double by = (k ? unit : -unit) / part;
    if (!open[k]) {
      add_wall(l, a, at[k], at[1 - k], 1 - part, by, e);
      continue;
    }
    e->axis[e->count] = a;
    e->at[e->count] = at[k];
    e->by[e->count++] = by;
  }
  return part;
}

void hk_strain_between(const hk_liquid *l, size_t i, int a, int b, bool slip, hk_strain *e) {
  const hk_liquid_grid *g = &l->grid;
  size_t s = g->stride[a], t = g->stride[b];
  begin(e, part_of(mean_distance(g, i, a, b)));
  if (!(e->weight > 0)) return;
  double first = add_difference(l, a, i - t, i, 1 / g->spacing[b], slip, e);
  double second = add_difference(l, b, i - s, i, 1 / g->spacing[a], slip, e);
  e->weight *= slip && fmin(first, second) < 1 ? 0 : fmin(first, second);
}
