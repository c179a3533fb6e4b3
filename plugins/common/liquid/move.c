/* Velocities beyond the liquid, and the way of particles along them. */
#include "plugins/common/liquid/liquid_balance.h"

#include <string.h>

enum { GRAIN = 2048 };

static const double margin = 1e-3;        /* of a cell: particles are no nearer to the box */
static const double hardly_beyond = 1e-6; /* of a cell: rounding of a wall's place */

typedef struct task {
  hk_liquid *l;
  const hk_liquid_particles *p;
  double h;
  int component;
  uint8_t layer;
} task;

/* The mean of the faces beside one that are known. */
static void extend_rows(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  hk_liquid_grid *g = &t->l->grid;
  const uint8_t *known = g->known[t->component];
  double *u = g->u[t->component];
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    size_t first = hk_liquid_row_at(g, k, 0).first;
    for (size_t i = first; i < first + g->cells[hk_liquid_inner(g)]; i++) {
      double sum = 0;
      int count = 0;
      g->fresh[i] = known[i];
      if (known[i]) continue;
      for (int c = 0; c < 3; c++) {
        size_t s = g->stride[c];
        if (known[i - s]) sum += u[i - s], count++;
        if (known[i + s]) sum += u[i + s], count++;
      }
      if (!count) continue;
      u[i] = sum / count;
      g->fresh[i] = t->layer;
    }
  }
}

static void settle_rows(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  hk_liquid_grid *g = &t->l->grid;
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    size_t first = hk_liquid_row_at(g, k, 0).first;
    memcpy(g->known[t->component] + first, g->fresh + first, g->cells[hk_liquid_inner(g)]);
  }
}

/* Whether the face has liquid on a side, so that pressure has acted on it. */
static bool is_wet(const hk_liquid_grid *g, int a, size_t i) {
  return g->unknown[i] != HK_LIQUID_NONE || g->unknown[i - g->stride[a]] != HK_LIQUID_NONE;
}

/* Whether the face shares a side with one of the same component that is wet. */
static bool is_beside_wet(const hk_liquid_grid *g, int a, size_t i) {
  bool beside = false;
  for (int c = 0; c < 3 && !beside; c++) beside = is_wet(g, a, i - g->stride[c]) || is_wet(g, a, i + g->stride[c]);
  return beside;
}

/* m/s, the mean of the wet faces about one, across edges and corners; own: of one that has none. */
static double mean_of_wet(const hk_liquid_grid *g, int a, size_t i, double own) {
  double sum = 0, count = 0;
  for (int k = 0; k < 27; k++) {
    const int d[3] = {k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1};
    size_t j = i;
    for (int c = 0; c < 3; c++) j += g->flat[c] ? 0 : (size_t)d[c] * g->stride[c]; /* modulo 2^64, as d may be -1 */
    if (j >= g->stride[a] && j < g->size && is_wet(g, a, j)) sum += g->u[a][j], count++;
  }
  return count > 0 ? sum / count : own;
}

/* Faces just beyond the surface that carry particles have felt forces and no pressure: they lag behind the liquid, and
 * made a wave 0.6 % too slow with 64 cells in its length. They are to get the velocity of the liquid beside them, as
 * all others there; those that one with a viscosity has across an edge or a corner get the mean of these faces: with
 * the velocity of a step of free fall they took the edges of a solid block down by up to 7 cells in a second (steps of
 * 33 ms), and the faster the longer the steps. Those of drops that fly by themselves keep their own. */
static void forget_rows(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  hk_liquid_grid *g = &t->l->grid;
  int a = t->component;
  uint8_t *known = g->known[a];
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    const hk_liquid_row row = hk_liquid_row_at(g, k, 0);
    for (size_t i = row.first; i < row.first + g->cells[hk_liquid_inner(g)]; i++) {
      if (!known[i] || is_wet(g, a, i) || hk_liquid_on_box(g, &row, i, a)) continue;
      if (is_beside_wet(g, a, i))
        known[i] = 0;
      else if (t->l->viscous)
        g->u[a][i] = mean_of_wet(g, a, i, g->u[a][i]);
    }
  }
}

void hk_liquid_extend(hk_liquid *l, int layers) {
  for (int a = 0; a < 3; a++) {
    task t = {.l = l, .component = a};
    if (!l->grid.flat[a]) l->host->parallel_for(l->host, hk_liquid_rows(&l->grid, 0), 16, forget_rows, &t);
  }
  for (int a = 0; a < 3; a++)
    for (int n = 0; n < layers && !l->grid.flat[a]; n++) {
      task t = {.l = l, .component = a, .layer = (uint8_t)(n + 2)};
      l->host->parallel_for(l->host, hk_liquid_rows(&l->grid, 0), 16, extend_rows, &t);
      l->host->parallel_for(l->host, hk_liquid_rows(&l->grid, 0), 16, settle_rows, &t);
    }
}

static void velocity_at(const hk_liquid_grid *g, const double x[3], double u[3]) {
  hk_liquid_place at;
  hk_liquid_locate(g, x, &at);
  for (int a = 0; a < 3; a++) u[a] = g->flat[a] ? 0 : hk_liquid_value(g, g->u[a], &at, a);
}

static void along(const double x[3], double h, const double u[3], double to[3]) {
  for (int c = 0; c < 3; c++) to[c] = x[c] + h * u[c];
}

/* m, of a point to body k; n: its outward normal, where it is inside. */
static double body_gap(const hk_liquid *l, size_t k, const double x[3], double n[3]) {
  const hk_liquid_body *b = &l->bodies.body[k];
  const double at[3] = {x[0], x[1], x[2]};
  return b->present ? hk_liquid_body_distance(b, at, 0, n) : INFINITY;
}

/* The particle, at x on the wall with the outward normal n, no longer moves into it. On the grid, pressure stops what
 * is liquid there; on what flies freely, in drops of less than half a cell, none acts, and it would keep its velocity
 * as long as the wall holds it, and give the liquid that it comes to a blow: films in a round bowl came to 20 m/s. */
static void stop_at(const hk_obstacle *o, const double x[3], const double n[3], double v[3]) {
  static const double rest[3];
  double u[3], into = 0;
  hk_body_move(&o->motion.end, x, rest, u);
  for (int c = 0; c < 3; c++) into += (v[c] - u[c]) * n[c];
  for (int c = 0; c < 3 && into < 0; c++) v[c] -= into * n[c];
}

/* Out of obstacles and bodies along their normals, then into the box. */
static void keep(const hk_liquid *l, size_t i, double x[3], double v[3]) {
  const hk_liquid_grid *g = &l->grid;
  for (size_t k = 0; l->obstacles && k < l->obstacles->count; k++) {
    const hk_obstacle *o = l->obstacles->member[k];
    double n[3], gap = hk_obstacle_gap(o, &o->motion.end, x, i, n);
    if (!(gap < 0)) continue;
    for (int c = 0; c < 3; c++) x[c] -= gap * n[c];
    stop_at(o, x, n, v);
  }
  for (size_t k = 0; k < l->bodies.count; k++) {
    double n[3], gap = body_gap(l, k, x, n);
    for (int c = 0; c < 3 && gap < 0; c++) x[c] -= gap * n[c];
  }
  for (int c = 0; c < 3; c++) {
    double least = g->flat[c] ? 0 : margin * g->spacing[c];
    x[c] = fmax(g->low[c] + least, fmin(g->high[c] - least, x[c]));
  }
}

static bool passes_obstacle(const hk_liquid *l, const double from[3], const double to[3]) {
  bool passes = false;
  for (size_t k = 0; l->obstacles && k < l->obstacles->count && !passes; k++)
    passes = hk_liquid_passes(l->obstacles->member[k], from, to);
  return passes;
}

static void move_piece(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  const hk_liquid_grid *g = &t->l->grid;
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    size_t i = t->p->index[t->l->sorted[k]];
    double *x = t->p->x + 3 * i, *v = t->p->v + 3 * i, from[3] = {x[0], x[1], x[2]};
    double first[3], second[3], third[3], on[3];
    hk_liquid_place at;
    hk_liquid_locate(g, x, &at);
    velocity_at(g, x, first);
    along(x, t->h / 2, first, on);
    velocity_at(g, on, second);
    along(x, 0.75 * t->h, second, on);
    velocity_at(g, on, third);
    for (int c = 0; c < 3; c++) {
      x[c] += t->h / 9 * (2 * first[c] + 3 * second[c] + 4 * third[c]);
      if (!g->flat[c]) x[c] += hk_liquid_value(g, g->push[c], &at, c);
    }
    keep(t->l, i, x, v);
    if (t->l->thin.triangles) {
      hk_thin_walls_keep(&t->l->thin, g, t->l->cell[t->l->sorted[k]], from, x);
      keep(t->l, i, x, v);
    }
    t->l->through[t->l->sorted[k]] = passes_obstacle(t->l, from, x);
  }
}

void hk_liquid_move(hk_liquid *l, const hk_liquid_particles *p, double h) {
  task t = {.l = l, .p = p, .h = h};
  l->host->parallel_for(l->host, p->count, GRAIN, move_piece, &t);
}

/* m, how far particle i at x is beyond a wall; 0 or less: it is not. */
static double beyond_wall(const hk_liquid *l, size_t i, const double x[3]) {
  const hk_liquid_grid *g = &l->grid;
  double most = -INFINITY, n[3];
  for (int c = 0; c < 3; c++) most = fmax(most, fmax(g->low[c] - x[c], x[c] - g->high[c]));
  for (size_t o = 0; l->obstacles && o < l->obstacles->count; o++)
    most = fmax(most, -hk_obstacle_gap(l->obstacles->member[o], &l->obstacles->member[o]->motion.end, x, i, n));
  for (size_t b = 0; b < l->bodies.count; b++) most = fmax(most, -body_gap(l, b, x, n));
  return most;
}

double hk_liquid_beyond(const hk_liquid *l, const hk_liquid_particles *p) {
  double most = 0;
  for (size_t k = 0; k < p->count; k++) most = fmax(most, beyond_wall(l, p->index[k], p->x + 3 * (size_t)p->index[k]));
  return most;
}

double hk_liquid_squeezed(const hk_liquid *l, const hk_liquid_particles *p) {
  bool within = false;
  if (!l->obstacles || !(l->gap.width < l->gap.cell)) return 0;
  for (size_t k = 0; k < p->count && !within; k++)
    within = hk_gap_holds(&l->gap, l->obstacles, p->x + 3 * (size_t)p->index[k]);
  return within ? l->gap.cell - l->gap.width : 0;
}

size_t hk_liquid_count_beyond(const hk_liquid *l, const hk_liquid_particles *p) {
  double least = 0;
  size_t count = 0;
  for (int c = 0; c < 3; c++) least = fmax(least, hardly_beyond * l->grid.spacing[c]);
  for (size_t k = 0; k < p->count; k++) count += beyond_wall(l, p->index[k], p->x + 3 * (size_t)p->index[k]) > least;
  return count;
}

void hk_liquid_step_back(const hk_liquid_particles *p, hk_correction *c, double (*came)[6]) {
  for (size_t k = 0; k < p->count; k++) {
    size_t i = 3 * (size_t)p->index[k];
    memcpy(came[k], p->x + i, 3 * sizeof(double));
    memcpy(came[k] + 3, p->v + i, 3 * sizeof(double));
    memcpy(p->x + i, c->x_before + i, 3 * sizeof(double));
  }
}

bool hk_liquid_differs(const hk_liquid_particles *p, double (*came)[6]) {
  for (size_t k = 0; k < p->count; k++) {
    size_t i = 3 * (size_t)p->index[k];
    if (memcmp(came[k], p->x + i, 3 * sizeof(double)) || memcmp(came[k] + 3, p->v + i, 3 * sizeof(double))) return true;
  }
  return false;
}
