#include "plugins/common/heat/grid_heat.h"

#include <string.h>

enum { GRAIN = 4096 };

static const double pi = 3.14159265358979323846;
static const double full = 0.8; /* of a cell, that counts as all of it */

hk_status hk_grid_heat_open(hk_grid_heat *s, const hk_host *host) {
  size_t size = s->grid.size, cells = 1;
  for (int c = 0; c < 3; c++) cells *= s->grid.cells[c];
  s->mass = host->allocate(host, size * sizeof *s->mass);
  s->sum = host->allocate(host, size * sizeof *s->sum);
  s->row = host->allocate(host, size * sizeof *s->row);
  s->cell = host->allocate(host, cells * sizeof *s->cell);
  if (!s->mass || !s->sum || !s->row || !s->cell)
    return host->fail(host, HK_NO_MEMORY, "no memory for the heat of %zu cells: take larger ones", cells);
  return hk_implicit_heat_open(&s->cells, host, cells);
}

void hk_grid_heat_close(hk_grid_heat *s, const hk_host *host) {
  void *all[] = {s->mass, s->sum, s->row, s->cell};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) host->release(host, all[k]);
  hk_implicit_heat_close(&s->cells);
}

typedef struct task {
  hk_grid_heat *s;
  const uint32_t *index;
  size_t count;
  const double *x, *mass, *h;
  double *change, *given;
  double part; /* m s/kg, of what is finer than cells: the part that decays, by the steepest d theta/dh */
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

/* What the particles of a cell lack of its change, as weights smooth it and the decay of what is finer takes from it,
 * they get in a second round. */
static void give_rest_piece(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    size_t i = t->index[k], to[8];
    double weight[8];
    weigh(t->s, t->x + 3 * i, to, weight);
    for (int b = 0; b < 8; b++)
      if (weight[b] > 0) t->change[i] += weight[b] * (t->s->cells.heat[t->s->row[to[b]]] - t->s->sum[to[b]]);
  }
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
                            const double *h, double tau, double *change, double *given) {
  const hk_host *host = s->cells.host;
  double steepest = hk_heat_steepest_potential(&s->law), cell = 0;
  for (int c = 0; c < 3; c++) cell = s->grid.flat[c] ? cell : fmax(cell, s->grid.spacing[c]);
  double decays = 1 - exp(-tau * pi * pi * steepest / (s->density * cell * cell));
  task t = {s, index, count, x, mass, h, change, given, steepest > 0 ? decays / steepest : 0};
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
  return HK_OK;
}
