/* What drives a gas: buoyancy, and vorticity confinement. */
#include "plugins/common/gas/gas.h"

/* m/s^2, of component c in cell i. */
static double lift(const hk_gas_task *t, int c, size_t i) {
  const hk_gas *s = t->gas;
  return s->gravity[c] * (t->fields[HK_GAS_SMOKE][i] / s->density - s->expansion * t->fields[HK_GAS_HEAT][i]);
}

/* The mean of the cells on both sides of a face; on an open side of the box there is one. */
static void lift_face(const hk_gas_task *t, const hk_liquid_row *row, size_t i) {
  hk_gas *s = t->gas;
  const hk_liquid_grid *g = &s->flow.grid;
  for (int c = 0; c < 3; c++) {
    if (s->gravity[c] == 0 || !hk_gas_has(g, row, i, c) || !(g->open[c][i] > 0)) continue;
    size_t at = hk_gas_at(g, row, i, c), below = i - g->stride[c];
    double a = at == 1                 ? lift(t, c, i)
               : at == g->cells[c] + 1 ? lift(t, c, below)
                                       : (lift(t, c, below) + lift(t, c, i)) / 2;
    t->to[c][i] += t->h * a;
  }
}

void hk_gas_lift(const hk_gas_task *t) {
  if (t->gas->carried[HK_GAS_HEAT] || t->gas->carried[HK_GAS_SMOKE]) hk_gas_each(t, lift_face);
}

/* The difference along axis d, by the way, of a function of cells: central, on the box to one side. */
typedef double (*of_cell)(const hk_gas *, int c, size_t i);

static double slope(const hk_gas *s, const hk_liquid_row *row, size_t i, int d, of_cell f, int c) {
  const hk_liquid_grid *g = &s->flow.grid;
  if (g->flat[d]) return 0;
  size_t at = hk_gas_at(g, row, i, d), low = at > 1 ? i - g->stride[d] : i;
  size_t high = at < g->cells[d] ? i + g->stride[d] : i;
  double way = ((at > 1) + (at < g->cells[d])) * g->spacing[d];
  return way > 0 ? (f(s, c, high) - f(s, c, low)) / way : 0;
}

static double speed_in(const hk_gas *s, int c, size_t i) {
  return s->flow.grid.flat[c] ? 0 : (s->now[c][i] + s->now[c][i + s->flow.grid.stride[c]]) / 2;
}

static double vorticity_in(const hk_gas *s, int c, size_t i) {
  (void)c;
  return s->work[3][i];
}

/* work: the curl in 0 to 2, its size in 3. */
static void turn_cell(const hk_gas_task *t, const hk_liquid_row *row, size_t i) {
  hk_gas *s = t->gas;
  double square = 0;
  if (!hk_gas_has(&s->flow.grid, row, i, 3)) return;
  for (int c = 0; c < 3; c++) {
    int a = (c + 1) % 3, b = (c + 2) % 3;
    double w = slope(s, row, i, a, speed_in, b) - slope(s, row, i, b, speed_in, a);
    s->work[c][i] = w;
    square += w * w;
  }
  s->work[3][i] = sqrt(square);
}

/* The force of a cell takes the place of its curl; only the sizes of others are read. */
static void force_cell(const hk_gas_task *t, const hk_liquid_row *row, size_t i) {
  hk_gas *s = t->gas;
  const hk_liquid_grid *g = &s->flow.grid;
  double n[3], w[3], length = 0;
  if (!hk_gas_has(g, row, i, 3)) return;
  for (int c = 0; c < 3; c++) {
    n[c] = slope(s, row, i, c, vorticity_in, 0);
    w[c] = s->work[c][i];
    length += n[c] * n[c];
  }
  length = sqrt(length);
  for (int c = 0; c < 3; c++) {
    int a = (c + 1) % 3, b = (c + 2) % 3;
    s->work[c][i] = length > 0 ? s->confinement * g->spacing[c] * (n[a] * w[b] - n[b] * w[a]) / length : 0;
  }
}

static void confine_face(const hk_gas_task *t, const hk_liquid_row *row, size_t i) {
  hk_gas *s = t->gas;
  const hk_liquid_grid *g = &s->flow.grid;
  for (int c = 0; c < 3; c++) {
    if (!hk_gas_has(g, row, i, c) || hk_liquid_on_box(g, row, i, c) || !(g->open[c][i] > 0)) continue;
    s->now[c][i] += t->h * (s->work[c][i] + s->work[c][i - g->stride[c]]) / 2;
  }
}

void hk_gas_push(hk_gas *s, double h) {
  hk_gas_task t = {.gas = s, .h = h / 2, .fields = s->now, .to = s->now};
  hk_gas_lift(&t);
  t.h = h;
  if (!(s->confinement > 0)) return;
  hk_gas_each(&t, turn_cell);
  hk_gas_each(&t, force_cell);
  hk_gas_each(&t, confine_face);
}
