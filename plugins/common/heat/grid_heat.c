#include "plugins/common/heat/grid_heat.h"

#include <float.h>
#include <stdatomic.h>
#include <string.h>

enum { GRAIN = 4096, MOST_ROUNDS = 10 };

static const double pi = 3.14159265358979323846;
static const double full = 0.8;       /* of a cell, that counts as all of it */
static const double a_lot = 1e3;      /* times an enthalpy */
static const double rounding = 1e-12; /* of an enthalpy */

hk_status hk_grid_heat_open(hk_grid_heat *s, const hk_host *host) {
  size_t size = s->grid.size, cells = 1;
  for (int c = 0; c < 3; c++) cells *= s->grid.cells[c];
  s->mass = host->allocate(host, size * sizeof *s->mass);
  s->sum = host->allocate(host, size * sizeof *s->sum);
  for (int k = 0; k < 2; k++) s->room[k] = host->allocate(host, size * sizeof *s->room[k]);
  s->row = host->allocate(host, size * sizeof *s->row);
  s->cell = host->allocate(host, cells * sizeof *s->cell);
  if (!s->mass || !s->sum || !s->room[0] || !s->room[1] || !s->row || !s->cell)
    return host->fail(host, HK_NO_MEMORY, "no memory for the heat of %zu cells: take larger ones", cells);
  return hk_implicit_heat_open(&s->cells, host, cells);
}

void hk_grid_heat_close(hk_grid_heat *s, const hk_host *host) {
  void *all[] = {s->mass, s->sum, s->room[0], s->room[1], s->row, s->cell};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) host->release(host, all[k]);
  hk_implicit_heat_close(&s->cells);
}

typedef struct task {
  hk_grid_heat *s;
  const uint32_t *index;
  size_t count;
  const double *x, *mass, *h;
  double *change, *given, *over;
  atomic_bool beyond; /* some particle is warmer or colder than all about it */
  double part;        /* m s/kg, of what is finer than cells: the part that decays, by the steepest d theta/dh */
} task;

/* ---- from particles to cells and back ---- */

/* Whether heat passes a face of the box across the axis. */
static bool passes(const hk_grid_heat *s, int axis) {
  const hk_heat_face *face = &s->face[2 * axis];
  return face[0].temperature > 0 || face[0].flux != 0 || face[1].temperature > 0 || face[1].flux != 0;
}

/* The eight centres about x and their weights; whether it is between a face that heat passes and its nearest centre,
 * where centres do not say how theta goes on. */
static bool weigh(const hk_grid_heat *s, const double *x, size_t to[8], double weight[8]) {
  const hk_liquid_grid *g = &s->grid;
  hk_liquid_place at = {0};
  double f[3];
  hk_liquid_locate(g, x, &at);
  size_t corner = hk_liquid_corner(g, &at, 3, f);
  for (int b = 0; b < 8; b++) {
    to[b] = corner;
    weight[b] = 1;
    for (int c = 0; c < 3; c++) {
      bool beyond = b >> c & 1;
      to[b] += beyond ? g->stride[c] : 0;
      weight[b] *= beyond ? f[c] : 1 - f[c];
    }
  }
  bool beyond = false;
  for (int c = 0; c < 3; c++) beyond |= at.at_wall[c] && passes(s, c);
  return beyond;
}

/* sum += m value in cells; value NULL: 1. */
static void scatter(const task *t, const double *value, double *sum) {
  memset(sum, 0, t->s->grid.size * sizeof *sum);
  for (size_t k = 0; k < t->count; k++) {
    size_t i = t->index[k], to[8];
    double weight[8], m = value ? t->mass[i] * value[i] : t->mass[i];
    weigh(t->s, t->x + 3 * i, to, weight);
    for (int b = 0; b < 8; b++) sum[to[b]] += weight[b] * m;
  }
}

static void gather_piece(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  const hk_implicit_heat *c = &t->s->cells;
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    size_t i = t->index[k], to[8];
    double weight[8], change = 0, given = 0, theta = 0;
    bool at_wall = weigh(t->s, t->x + 3 * i, to, weight);
    for (int b = 0; b < 8; b++) {
      if (!(weight[b] > 0)) continue;
      uint32_t row = t->s->row[to[b]];
      change += weight[b] * c->heat[row];
      given += weight[b] * c->given[row];
      theta += weight[b] * c->potential[row];
    }
    double finer = hk_heat_potential(&t->s->law, t->h[i] + change) - theta;
    t->change[i] = at_wall ? change : change - t->part * finer;
    t->given[i] = given;
  }
}

/* ---- no warmer than what is about it ---- */

static double smaller(double a, double b) { return a < b ? a : b; }
static double larger(double a, double b) { return a > b ? a : b; }

/* The cells about a particle, with their weights. */
typedef struct about {
  size_t cell[8];
  double weight[8];
  bool at_wall;
} about;

static about find_about(const task *t, size_t i) {
  about at;
  at.at_wall = weigh(t->s, t->x + 3 * i, at.cell, at.weight);
  return at;
}

/* Widens the range of potentials, W/m, by the faces that the particle is beside. */
static void add_faces(const hk_grid_heat *s, const double *x, double *least, double *most) {
  double flow = 0;
  for (int k = 0; k < 6; k++) {
    const hk_heat_face *face = &s->face[k];
    double half = s->grid.spacing[k / 2] / 2, from = x[k / 2] - s->grid.low[k / 2];
    if (k % 2) from = 2 * half * (double)s->grid.cells[k / 2] - from;
    if (s->grid.flat[k / 2] || from > half) continue;
    flow += face->flux * half;
    if (!(face->temperature > 0)) continue;
    double theta = hk_heat_potential(&s->law, hk_heat_enthalpy(&s->law, face->temperature));
    *least = smaller(*least, theta), *most = larger(*most, theta);
  }
  *least += smaller(flow, 0), *most += larger(flow, 0);
}

/* J/kg: the enthalpies that a particle may get: between those of the coldest and the warmest of the cells about it, of
 * the faces beside it, and of itself before; where that is melting, all of it. */
static void find_range(const task *t, size_t i, const about *at, double range[2]) {
  const hk_grid_heat *s = t->s;
  double least = hk_heat_potential(&s->law, t->h[i]), most = least;
  for (int b = 0; b < 8; b++) {
    if (!(at->weight[b] > 0)) continue;
    double theta = s->cells.potential[s->row[at->cell[b]]];
    least = smaller(least, theta), most = larger(most, theta);
  }
  if (at->at_wall) add_faces(s, t->x + 3 * i, &least, &most);
  double far = a_lot * (fabs(t->h[i]) + fabs(t->change[i]) + DBL_MIN); /* what does not conduct has no end */
  range[0] = larger(hk_heat_least_enthalpy(&s->law, least), -far);
  range[1] = smaller(hk_heat_most_enthalpy(&s->law, most), far);
}

/* Notes what the particle has beyond its range, J/kg; below it that is negative. */
static bool note_beyond(const task *t, size_t i, const double range[2]) {
  double h = t->h[i] + t->change[i], over = h - smaller(larger(h, range[0]), range[1]);
  t->over[i] = fabs(over) > rounding * (fabs(t->h[i]) + fabs(t->change[i])) ? over : 0;
  return t->over[i] != 0;
}

/* What the particles of a cell lack of its change, as weights smooth it and the decay of what is finer takes from it,
 * they get in a second round. */
static void give_rest_piece(void *context, size_t begin, size_t end, size_t piece) {
  task *t = context;
  bool any = false;
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    size_t i = t->index[k];
    const about at = find_about(t, i);
    double range[2];
    for (int b = 0; b < 8; b++)
      if (at.weight[b] > 0)
        t->change[i] += at.weight[b] * (t->s->cells.heat[t->s->row[at.cell[b]]] - t->s->sum[at.cell[b]]);
    find_range(t, i, &at, range);
    any |= note_beyond(t, i, range);
  }
  if (any) atomic_store(&t->beyond, true);
}

static bool has_any(const hk_grid_heat *s, const about *at) {
  bool any = false;
  for (int b = 0; b < 8; b++) any |= at->weight[b] > 0 && s->sum[at->cell[b]] != 0;
  return any;
}

/* J of the cells: sum, what their particles have beyond their ranges; of these cells room, what their particles could
 * lose and gain. */
static void collect(const task *t) {
  hk_grid_heat *s = t->s;
  double *all[] = {s->sum, s->room[0], s->room[1]};
  for (int a = 0; a < 3; a++) memset(all[a], 0, s->grid.size * sizeof *all[a]);
  for (size_t k = 0; k < t->count; k++) {
    size_t i = t->index[k];
    if (t->over[i] == 0) continue;
    const about at = find_about(t, i);
    for (int b = 0; b < 8; b++) s->sum[at.cell[b]] += at.weight[b] * t->mass[i] * t->over[i];
  }
  for (size_t k = 0; k < t->count; k++) {
    size_t i = t->index[k];
    const about at = find_about(t, i);
    double range[2], h = t->h[i] + t->change[i];
    if (!has_any(s, &at)) continue;
    find_range(t, i, &at, range);
    for (int b = 0; b < 8; b++) {
      if (!(at.weight[b] > 0)) continue;
      s->room[0][at.cell[b]] += at.weight[b] * t->mass[i] * larger(h - range[0], 0);
      s->room[1][at.cell[b]] += at.weight[b] * t->mass[i] * larger(range[1] - h, 0);
    }
  }
}

/* Takes from the particles what they have beyond their ranges and gives it to those of the same cells that have room,
 * by their room; what there is no room for goes to all, and with those of the next cells to these in another round. */
static void limit_piece(void *context, size_t begin, size_t end, size_t piece) {
  task *t = context;
  const hk_grid_heat *s = t->s;
  bool any = false;
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    size_t i = t->index[k];
    const about at = find_about(t, i);
    double range[2], h = t->h[i] + t->change[i];
    if (!has_any(s, &at)) continue;
    find_range(t, i, &at, range);
    double own[] = {larger(h - range[0], 0), larger(range[1] - h, 0)};
    t->change[i] -= t->over[i];
    for (int b = 0; b < 8; b++) {
      size_t c = at.cell[b];
      if (!(at.weight[b] > 0) || s->sum[c] == 0) continue;
      double heat = s->sum[c], room = s->room[heat > 0][c], taken = smaller(fabs(heat), room);
      double share = room > 0 ? own[heat > 0] * (taken / room) : 0, rest = (fabs(heat) - taken) / s->mass[c];
      t->change[i] += at.weight[b] * copysign(share + rest, heat);
    }
    any |= note_beyond(t, i, range);
  }
  if (any) atomic_store(&t->beyond, true);
}

/* ---- the cells ---- */

/* Particles that lie at random fill a cell to some percent more or less: as full counts what is nearly so. */
static double filled(const hk_grid_heat *s, size_t cell) {
  return fmin(1, s->mass[cell] / (full * s->density * hk_liquid_cell_volume(&s->grid)));
}

/* m, between the centres of two cells with something in them: the harmonic mean of what is filled. */
static double way_between(const hk_grid_heat *s, size_t a, size_t b, int axis) {
  double f = filled(s, a), g = filled(s, b), spacing = s->grid.spacing[axis];
  return 2 * f * g / (f + g) * hk_liquid_cell_volume(&s->grid) / (spacing * spacing);
}

static void add_face(hk_grid_heat *s, size_t r, const hk_heat_face *face, int axis) {
  double spacing = s->grid.spacing[axis], area = filled(s, s->cell[r]) * hk_liquid_cell_volume(&s->grid) / spacing;
  double way = face->temperature > 0 ? area / (spacing / 2) : 0;
  s->cells.wall_way[r] += way;
  s->cells.source[r] += area * face->flux;
  if (way > 0) s->cells.source[r] += way * hk_heat_potential(&s->law, hk_heat_enthalpy(&s->law, face->temperature));
}

static void join(hk_grid_heat *s, size_t r) {
  const hk_liquid_grid *g = &s->grid;
  size_t i = s->cell[r];
  s->cells.wall_way[r] = s->cells.source[r] = 0;
  for (int k = 0; k < HK_HEAT_SIDES; k++) {
    int axis = k / 2;
    size_t at = i / g->stride[axis] % (g->cells[axis] + 2), j = k % 2 ? i + g->stride[axis] : i - g->stride[axis];
    bool on_box = !g->flat[axis] && at == (k % 2 ? g->cells[axis] : 1);
    uint32_t other = g->flat[axis] || on_box ? HK_LIQUID_NONE : s->row[j];
    s->cells.other[r][k] = other == HK_LIQUID_NONE ? (uint32_t)r : other;
    s->cells.way[r][k] = other == HK_LIQUID_NONE ? 0 : way_between(s, i, j, axis);
    if (on_box) add_face(s, r, &s->face[k], axis);
  }
}

/* Cells with something in them, in the order of memory. */
static void find_cells(hk_grid_heat *s) {
  size_t rows = 0;
  for (size_t i = 0; i < s->grid.size; i++) {
    s->row[i] = s->mass[i] > 0 ? (uint32_t)rows : HK_LIQUID_NONE;
    if (s->mass[i] > 0) s->cell[rows++] = (uint32_t)i;
  }
  s->cells.rows = rows;
  for (size_t r = 0; r < rows; r++) {
    s->cells.mass[r] = s->mass[s->cell[r]];
    s->cells.before[r] = s->sum[s->cell[r]] / s->cells.mass[r];
    join(s, r);
  }
}

hk_status hk_grid_heat_step(hk_grid_heat *s, const uint32_t *index, size_t count, const double *x, const double *mass,
                            const double *h, double tau, double *change, double *given, double *over) {
  const hk_host *host = s->cells.host;
  double steepest = hk_heat_steepest_potential(&s->law), cell = 0;
  for (int c = 0; c < 3; c++) cell = s->grid.flat[c] ? cell : fmax(cell, s->grid.spacing[c]);
  double decays = 1 - exp(-tau * pi * pi * steepest / (s->density * cell * cell));
  task t = {s, index, count, x, mass, h, change, given, over, false, steepest > 0 ? decays / steepest : 0};
  scatter(&t, NULL, s->mass);
  scatter(&t, h, s->sum);
  find_cells(s);
  s->cells.law = &s->law;
  s->cells.tau = tau;
  hk_status status = hk_implicit_heat_solve(&s->cells, s->tolerance);
  if (status != HK_OK) return status;
  host->parallel_for(host, count, GRAIN, gather_piece, &t);
  scatter(&t, change, s->sum);
  for (size_t r = 0; r < s->cells.rows; r++) s->sum[s->cell[r]] /= s->cells.mass[r];
  host->parallel_for(host, count, GRAIN, give_rest_piece, &t);
  for (int k = 0; k < MOST_ROUNDS && atomic_load(&t.beyond); k++) {
    collect(&t);
    atomic_store(&t.beyond, false);
    host->parallel_for(host, count, GRAIN, limit_piece, &t);
  }
  return HK_OK;
}
