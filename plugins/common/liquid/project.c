/* The projection of a liquid's velocities, and the displacement that evens its density: the same matrix with two
 * right-hand sides. */
#include "plugins/common/liquid/couple.h"

#include <string.h>

enum { GRAIN = 2048, TURNS = 3 /* in which liquid comes off walls */ };

static const double even_to = 1e-3;      /* the residual of the displacement, which is small itself */
static const double least_excess = 1e-7; /* is not evened */
static const double at_once = 0.25;      /* of what the density is off, with part = 1 */
static const double most_push = 0.1;     /* of a cell */
static const double slightly = 1e-6;     /* of the largest pressure: rounding, and what the tolerance leaves */
static const double at_centre = 0.01;    /* of a cell: the surface is there, and pressure beside it is of order 1 */

static void row_of(hk_liquid *l, size_t k) {
  const hk_liquid_grid *g = &l->grid;
  hk_pressure *p = &l->pressure;
  size_t i = p->cell[k];
  p->diagonal[k] = 0;
  for (int c = 0; c < 3; c++) {
    size_t s = g->stride[c];
    double unit = 1 / (g->spacing[c] * g->spacing[c]);
    double before = g->open[c][i] * unit, after = g->open[c][i + s] * unit;
    uint32_t prior = g->unknown[i - s], next = g->unknown[i + s];
    p->prior[c][k] = before > 0 && prior != HK_LIQUID_NONE ? prior : (uint32_t)p->rows;
    p->next[c][k] = after > 0 && next != HK_LIQUID_NONE ? next : (uint32_t)p->rows;
    p->side[c][k] = p->next[c][k] < p->rows ? after : 0;
    if (before > 0) p->diagonal[k] += prior == HK_LIQUID_NONE ? before / hk_liquid_part_to_surface(g, c, i, i) : before;
    if (after > 0) p->diagonal[k] += next == HK_LIQUID_NONE ? after / hk_liquid_part_to_surface(g, c, i + s, i) : after;
  }
}

static void rows_piece(void *context, size_t begin, size_t end, size_t piece) {
  (void)piece;
  for (size_t k = begin; k < end; k++) row_of(context, k);
}

/* 1/s, with what walls bring in or take away. */
static double divergence(const hk_liquid_grid *g, size_t i) {
  double sum = 0;
  for (int c = 0; c < 3; c++) {
    size_t s = i + g->stride[c];
    double out = g->open[c][s] * g->u[c][s] + (1 - g->open[c][s]) * g->wall[c][s];
    double in = g->open[c][i] * g->u[c][i] + (1 - g->open[c][i]) * g->wall[c][i];
    sum += (out - in) / g->spacing[c];
  }
  return sum;
}

double hk_liquid_divergence(const hk_liquid *l) {
  double most = 0;
  for (size_t k = 0; k < l->pressure.rows; k++) most = fmax(most, fabs(divergence(&l->grid, l->pressure.cell[k])));
  return most;
}

/* Faces that border on a cell of the liquid and have nothing from particles: the mean of their neighbours that have. */
static void fill_gap(hk_liquid_grid *g, int a, size_t i) {
  double sum = 0, count = 0;
  if (g->weight[a][i] > 0) return;
  for (int c = 0; c < 3; c++) {
    size_t s = g->stride[c];
    if (g->weight[a][i - s] > 0) sum += g->u[a][i - s], count++;
    if (i + s < g->size && g->weight[a][i + s] > 0) sum += g->u[a][i + s], count++; /* the last face has none beyond */
  }
  if (count > 0) g->u[a][i] = g->before[a][i] = sum / count;
}

static void fill_gaps(hk_liquid *l) {
  hk_liquid_grid *g = &l->grid;
  for (size_t k = 0; k < l->pressure.rows; k++)
    for (int c = 0; c < 3; c++) {
      fill_gap(g, c, l->pressure.cell[k]);
      fill_gap(g, c, l->pressure.cell[k] + g->stride[c]);
    }
}

typedef struct task {
  hk_liquid *l;
  double part; /* of the displacement; 0: velocities change */
} task;

/* Rows of faces: pressure acts, closed faces have the wall's velocity. known: the liquid's faces, and those that carry
 * particles beside it. */
static void act_rows(void *context, size_t begin, size_t end, size_t piece) {
  const task *t = context;
  hk_liquid_grid *g = &t->l->grid;
  size_t length = g->cells[hk_liquid_inner(g)] + 1;
  (void)piece;
  for (size_t k = begin; k < end; k++) {
    const hk_liquid_row row = hk_liquid_row_at(g, k, 1);
    for (size_t i = row.first; i < row.first + length; i++)
      for (int c = 0; c < 3; c++) {
        bool open = g->open[c][i] > 0;
        double slope = open ? hk_liquid_slope(t->l, c, i) : 0;
        if (t->part > 0) {
          double push = -at_once * t->part * slope, most = most_push * g->spacing[c];
          g->push[c][i] = fmax(-most, fmin(most, push));
          continue;
        }
        bool wet = g->unknown[i] != HK_LIQUID_NONE || g->unknown[i - g->stride[c]] != HK_LIQUID_NONE;
        g->u[c][i] = open ? g->u[c][i] - slope : g->wall[c][i];
        bool held = hk_liquid_on_box(g, &row, i, c) || hk_thin_walls_at(&t->l->thin, c, i);
        g->known[c][i] = open ? wet || g->weight[c][i] > 0 : held;
      }
  }
}

static void act(hk_liquid *l, double part) {
  task t = {l, part};
  l->host->parallel_for(l->host, hk_liquid_rows(&l->grid, 1), 16, act_rows, &t);
}

/* 1/s, of the divergence, a sum of differences of six velocities. */
static double rounding_of(const hk_liquid *l) {
  const hk_liquid_grid *g = &l->grid;
  double most = 0;
  for (size_t k = 0; k < l->pressure.rows; k++)
    for (int c = 0; c < 3; c++) most = fmax(most, fabs(g->u[c][l->pressure.cell[k]]) / g->spacing[c]);
  return 1e-15 * most;
}

/* Whether a wall cuts the cell. */
static bool is_cut(const hk_liquid_grid *g, size_t i) {
  bool cut = false;
  for (int f = 0; f < 6 && !cut; f++) {
    size_t face = f & 1 ? i + g->stride[f / 2] : i; /* the last cell outside the box has none beyond */
    cut = face < g->size && g->open[f / 2][face] > 0 && g->open[f / 2][face] < 1;
  }
  return cut;
}

/* Whether the cell has air beyond a face, and a wall cuts it, or one beside it. */
static bool is_cut_at_air(const hk_liquid_grid *g, size_t i) {
  bool cut = is_cut(g, i), air = false;
  for (int f = 0; f < 6; f++) {
    size_t s = g->stride[f / 2], face = f & 1 ? i + s : i, beside = f & 1 ? i + s : i - s;
    if (!(g->open[f / 2][face] > 0)) continue;
    air |= g->unknown[beside] == HK_LIQUID_NONE;
    cut |= is_cut(g, beside);
  }
  return cut && air;
}

/* Where less comes into a cell through a face that a wall covers in part than leaves through a whole one, at the edge
 * of a plate say, only a pressure below that of the air would fill it. Liquid does not: it comes off the wall, and the
 * cell is air with a pressure of zero. Held to be full it drew jets round edges by 15 degrees, and a jet pushed a plate
 * by 28 % too little. False: there is no such cell. */
static bool let_go(hk_liquid *l) {
  hk_liquid_grid *g = &l->grid;
  hk_pressure *p = &l->pressure;
  hk_moving_walls *walls = &p->walls;
  double most = 0;
  size_t count = 0, kept = 0;
  for (size_t k = 0; k < p->rows; k++) most = fmax(most, fabs(p->x[k]));
  for (size_t k = 0; k < p->rows; k++) {
    if (!(p->x[k] < -slightly * most) || !is_cut_at_air(g, p->cell[k])) continue;
    g->distance[p->cell[k]] = at_centre;
    count++;
  }
  if (count == 0) return false;
  for (size_t k = 0; k < walls->count; k++) walls->wall[k].row = p->cell[walls->wall[k].row];
  hk_liquid_number_cells(l);
  for (size_t k = 0; k < walls->count; k++) {
    hk_moving_wall wall = walls->wall[k];
    if (g->unknown[wall.row] == HK_LIQUID_NONE) continue;
    wall.row = g->unknown[wall.row];
    walls->wall[kept++] = wall;
  }
  walls->count = kept;
  return true;
}

static hk_status solve(hk_liquid *l, const double *guess) {
  hk_pressure *p = &l->pressure;
  l->host->parallel_for(l->host, p->rows, GRAIN, rows_piece, l);
  hk_pressure_prepare(p);
  for (size_t k = 0; k < p->rows; k++) {
    p->b[k] = -divergence(&l->grid, p->cell[k]);
    p->x[k] = guess[p->cell[k]];
  }
  if (hk_pressure_solve(p, l->tolerance, rounding_of(l))) return HK_OK;
  return l->host->fail(l->host, HK_NOT_CONVERGED,
                       "the pressure of %zu cells did not come to its tolerance of %g in %d iterations: take a larger "
                       "`tolerance`",
                       p->rows, l->tolerance, p->iterations);
}

hk_status hk_liquid_project(hk_liquid *l, double *guess) {
  hk_liquid_grid *g = &l->grid;
  hk_pressure *p = &l->pressure;
  fill_gaps(l);
  hk_status status = hk_liquid_couple(l, guess);
  if (status == HK_OK) status = hk_liquid_couple_thin(l, guess);
  if (status != HK_OK) return status;
  status = solve(l, guess);
  for (int turn = 0; turn < TURNS && status == HK_OK && !l->clings && let_go(l); turn++) status = solve(l, guess);
  if (status != HK_OK) return status;
  memset(guess, 0, g->size * sizeof *guess);
  for (size_t k = 0; k < p->rows; k++) guess[p->cell[k]] = p->x[k];
  hk_liquid_react(l);
  hk_liquid_move_thin(l);
  act(l, 0);
  l->left = hk_liquid_divergence(l);
  return HK_OK;
}

/* How much fuller than the density a cell is, by its whole volume: what a wall leaves of it. What borders on air or
 * cloth may be thinner. */
static double excess(const hk_liquid *l, size_t k) {
  const hk_liquid_grid *g = &l->grid;
  const hk_pressure *p = &l->pressure;
  size_t i = p->cell[k];
  double off = g->filled[i] - 1;
  if (g->room[i] < 1) off *= hk_liquid_open_cell(g, i);
  if (off >= 0) return off;
  if (hk_thin_walls_beside(&l->thin, g, i, 1)) return 0;
  for (int c = 0; c < 3; c++) {
    size_t s = g->stride[c];
    if (g->open[c][i] > 0 && p->prior[c][k] == p->rows) return 0;
    if (g->open[c][i + s] > 0 && p->next[c][k] == p->rows) return 0;
  }
  return off;
}

hk_status hk_liquid_even(hk_liquid *l, double part) {
  hk_pressure *p = &l->pressure;
  hk_moving_walls_clear(&p->walls); /* bodies stand */
  for (size_t k = 0; k < p->rows; k++) {
    p->b[k] = fmax(-0.5, fmin(0.5, excess(l, k)));
    p->x[k] = 0;
  }
  if (!hk_pressure_solve(p, even_to, least_excess))
    return l->host->fail(l->host, HK_NOT_CONVERGED,
                         "the density of %zu cells could not be evened in %d iterations: take "
                         "smaller steps",
                         p->rows, p->iterations);
  act(l, part);
  return HK_OK;
}
