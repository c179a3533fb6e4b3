/* Viscosity and conduction: the difference of second order, with mirrored values at the box's faces, by explicit stages
 * of the method RKL2, which is of order 2 and whose stable step grows as the square of the number of stages (Meyer,
 * Balsara, Aslam 2012, A second-order accurate super TimeStepping formulation for anisotropic thermal conduction).
 * Walls of obstacles are those of whole cells here, of order 1. */
#include "plugins/common/gas/gas.h"

#include <string.h>

enum { LEAST_STAGES = 3, MOST_STAGES = 51, GRAIN = 8192 };

static const double safety = 0.9; /* of the largest stable step */

/* The value of a field on the box, NAN: nothing passes. */
static double on_box(const hk_gas *s, int f, int c, bool upper) {
  if (s->open[c][upper]) return NAN;
  if (f == HK_GAS_HEAT) return c != 2 ? NAN : upper ? s->ceiling : s->floor;
  if (f > HK_GAS_HEAT || s->sticks == HK_GAS_SLIPS || (s->sticks == HK_GAS_STICKS_TO_FLOORS && c != 2)) return NAN;
  return c == 2 && upper ? s->lid[f] : 0;
}

/* What comes over from the neighbour of place i along axis c, by D/h^2. */
static double passes(const hk_gas *s, const hk_liquid_row *row, size_t i, int f, int c, bool upper) {
  const hk_liquid_grid *g = &s->flow.grid;
  size_t at = hk_gas_at(g, row, i, c), j = upper ? i + g->stride[c] : i - g->stride[c];
  double own = s->now[f][i];
  if (c != f && at == (upper ? g->cells[c] : 1)) {
    double wall = on_box(s, f, c, upper);
    return isnan(wall) ? 0 : 2 * (wall - own);
  }
  double part =
      f >= HK_GAS_HEAT ? g->open[c][upper ? j : i] : g->open[f][j] > 0 || s->sticks == HK_GAS_STICKS || c == f;
  return part * (s->now[f][j] - own);
}

enum { START, RATE_AT_START, RATE, PRIOR }; /* in `work` */

/* The rate of change of a field by the diffusivity `factor`. */
static void find_rate(const hk_gas_task *t, const hk_liquid_row *row, size_t i) {
  hk_gas *s = t->gas;
  const hk_liquid_grid *g = &s->flow.grid;
  int f = t->field;
  double sum = 0;
  bool fixed = !hk_gas_has(g, row, i, f) || (f < 3 && (hk_liquid_on_box(g, row, i, f) || !(g->open[f][i] > 0)));
  for (int c = 0; c < 3 && !fixed; c++)
    if (!g->flat[c])
      sum += (passes(s, row, i, f, c, false) + passes(s, row, i, f, c, true)) / (g->spacing[c] * g->spacing[c]);
  s->work[RATE][i] = t->factor * sum;
}

/* Stage j of s: Y_j = mu Y_j-1 + nu Y_j-2 + (1 - mu - nu) Y_0 + rate M Y_j-1 + start M Y_0. */
typedef struct stage {
  hk_gas *gas;
  int field;
  double mu, nu, rate, start;
} stage;

static void stage_piece(void *context, size_t begin, size_t end, size_t piece) {
  const stage *k = context;
  double *now = k->gas->now[k->field], *const *work = k->gas->work;
  (void)piece;
  for (size_t i = begin; i < end; i++) {
    double value = k->mu * now[i] + k->nu * work[PRIOR][i] + (1 - k->mu - k->nu) * work[START][i] +
                   k->rate * work[RATE][i] + k->start * work[RATE_AT_START][i];
    work[PRIOR][i] = now[i];
    now[i] = value;
  }
}

static double b(int j) { return j < 2 ? 1.0 / 3 : (j * j + j - 2) / (2.0 * j * (j + 1)); }

/* h: of the step; the coefficients of Meyer et al. 2012. */
static stage stage_of(hk_gas *s, int f, int j, int stages, double h) {
  double w = 4.0 / (stages * stages + stages - 2);
  if (j == 1) return (stage){s, f, 1, 0, b(1) * w * h, 0};
  double mu = (2.0 * j - 1) / j * b(j) / b(j - 1), nu = -(j - 1.0) / j * b(j) / b(j - 2);
  return (stage){s, f, mu, nu, mu * w * h, -(1 - b(j - 1)) * mu * w * h};
}

/* By Gershgorin's circles a row of the difference is at most 4/h^2 an axis, also beside a wall. */
static hk_status spread(hk_gas *s, int f, double D, double h, const char *name) {
  const hk_liquid_grid *g = &s->flow.grid;
  size_t bytes = g->size * sizeof(double);
  double rate = 0;
  if (!(D > 0)) return HK_OK;
  for (int c = 0; c < 3; c++) rate += g->flat[c] ? 0 : 1 / (g->spacing[c] * g->spacing[c]);
  double explicit_steps = h * 2 * D * rate / safety;
  int stages = LEAST_STAGES;
  while (stages < MOST_STAGES && (stages * stages + stages - 2) / 4.0 < explicit_steps) stages += 2;
  double most = (stages * stages + stages - 2) / 4.0;
  if (explicit_steps > most)
    return s->host->fail(s->host, HK_BAD_PARAM,
                         "%s: with %g m^2/s a step of %g s spreads over too many cells: take a --dt of %.3g s, or "
                         "larger cells",
                         name, D, h, 0.99 * h * most / explicit_steps);
  hk_gas_task t = {.gas = s, .field = f, .factor = D};
  memcpy(s->work[START], s->now[f], bytes);
  memcpy(s->work[PRIOR], s->now[f], bytes);
  for (int j = 1; j <= stages; j++) {
    stage k = stage_of(s, f, j, stages, h);
    hk_gas_each(&t, find_rate);
    if (j == 1) memcpy(s->work[RATE_AT_START], s->work[RATE], bytes);
    s->host->parallel_for(s->host, g->size, GRAIN, stage_piece, &k);
  }
  return HK_OK;
}

/* Closed faces are at their walls' velocity, which no-slip feels. */
static void stick(const hk_gas_task *t, const hk_liquid_row *row, size_t i) {
  hk_gas *s = t->gas;
  const hk_liquid_grid *g = &s->flow.grid;
  for (int c = 0; c < 3; c++)
    if (hk_gas_has(g, row, i, c) && !(g->open[c][i] > 0)) s->now[c][i] = g->wall[c][i];
}

hk_status hk_gas_spread(hk_gas *s, double h) {
  hk_gas_task t = {.gas = s};
  if (s->viscosity > 0) hk_gas_each(&t, stick);
  hk_status status = spread(s, HK_GAS_HEAT, s->diffusivity, h, "diffusivity");
  for (int c = 0; c < 3 && status == HK_OK; c++)
    if (!s->flow.grid.flat[c]) status = spread(s, c, s->viscosity, h, "viscosity");
  return status;
}
