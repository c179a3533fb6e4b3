/* How a step of a gas begins. */
#include "plugins/common/gas/gas.h"

#include <string.h>

void hk_gas_begin(hk_gas *s, double last) {
  size_t size = s->flow.grid.size;
  for (int c = 0; c < 3; c++)
    for (size_t i = 0; i < size; i++) s->rate[c][i] = last > 0 ? (s->now[c][i] - s->before[c][i]) / last : 0;
  for (int f = 0; f < HK_GAS_FIELDS; f++) memcpy(s->before[f], s->now[f], size * sizeof(double));
  memcpy(s->impulse_before, s->impulse, size * sizeof(double));
}

/* The slope of the impulse across the face of component c below cell i; on an open side it is zero. */
static double slope_across(const hk_gas *s, const hk_liquid_row *row, int c, size_t i) {
  const hk_liquid_grid *g = &s->flow.grid;
  const double *p = s->impulse_before;
  size_t at = hk_gas_at(g, row, i, c), below = i - g->stride[c];
  if (!(g->open[c][i] > 0)) return 0;
  if (at == 1) return 2 * p[i] / g->spacing[c];
  if (at == g->cells[c] + 1) return -2 * p[below] / g->spacing[c];
  return (p[i] - p[below]) / g->spacing[c];
}

static void prepare_place(const hk_gas_task *t, const hk_liquid_row *row, size_t i) {
  hk_gas *s = t->gas;
  for (int c = 0; c < 3; c++) {
    if (!hk_gas_has(&s->flow.grid, row, i, c)) continue;
    s->along[c][i] = s->before[c][i] + t->h / 2 * s->rate[c][i];
    s->from[c][i] = s->before[c][i] - t->factor * slope_across(s, row, c, i);
  }
}

void hk_gas_prepare(hk_gas *s, double h, double last) {
  hk_gas_task t = {.gas = s, .h = h, .factor = last > 0 ? h / last / 2 : 0};
  hk_gas_each(&t, prepare_place);
  t.fields = s->before, t.to = s->from, t.h = h / 2;
  hk_gas_lift(&t);
}
