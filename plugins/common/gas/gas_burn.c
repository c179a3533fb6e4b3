/* Sources of heat, smoke and fuel, fire, and the loss of heat: what happens in each cell by itself. */
#include "plugins/common/gas/gas.h"

static double whole(double x, double most) { return fmax(0, fmin(most, x)); }

void hk_gas_feed(hk_gas *s, const hk_gas_source *source, const double x[3], double h) {
  const hk_liquid_grid *g = &s->flow.grid;
  size_t from[3], to[3];
  double cell = INFINITY;
  for (int c = 0; c < 3; c++) {
    double middle = (x[c] - g->low[c]) / g->spacing[c], reach = source->radius / g->spacing[c] + 1;
    from[c] = g->flat[c] ? 1 : 1 + (size_t)whole(floor(middle - reach), (double)g->cells[c]);
    to[c] = g->flat[c] ? 1 : (size_t)whole(ceil(middle + reach), (double)g->cells[c]);
    if (!g->flat[c]) cell = fmin(cell, g->spacing[c]);
  }
  for (size_t k = from[2]; k <= to[2]; k++)
    for (size_t j = from[1]; j <= to[1]; j++)
      for (size_t i = from[0]; i <= to[0]; i++) {
        const size_t at[3] = {i, j, k};
        size_t place = i * g->stride[0] + j * g->stride[1] + k * g->stride[2];
        double square = 0;
        for (int c = 0; c < 3; c++) {
          double d = g->flat[c] ? 0 : g->low[c] + g->spacing[c] * ((double)at[c] - 0.5) - x[c];
          square += d * d;
        }
        double part = whole((source->radius - sqrt(square)) / cell + 0.5, 1); /* of the cell that is in the ball */
        double kept = exp(-part * h / source->time);
        for (int f = HK_GAS_HEAT; f < HK_GAS_FIELDS && part > 0; f++)
          if (s->carried[f]) s->now[f][place] = source->value[f] + kept * (s->now[f][place] - source->value[f]);
      }
}

static void burn_cell(const hk_gas_task *t, const hk_liquid_row *row, size_t i) {
  hk_gas *s = t->gas;
  if (!hk_gas_has(&s->flow.grid, row, i, HK_GAS_HEAT)) return;
  double *heat = &s->now[HK_GAS_HEAT][i], *fuel = &s->now[HK_GAS_FUEL][i];
  if (*heat >= s->ignition && *fuel > 0) {
    double burnt = *fuel * (1 - exp(-s->burn_rate * t->h));
    *fuel -= burnt;
    *heat += s->burn_heat * burnt;
    s->now[HK_GAS_SMOKE][i] += s->soot * burnt;
  }
  *heat *= exp(-s->cooling * t->h);
  /* dT/dt = -radiation (T/1000 K)^4 */
  double T = *heat / 1000;
  if (s->radiation > 0 && T > 0) *heat = 1000 * T / pow(1 + 3 * s->radiation / 1000 * t->h * T * T * T, 1.0 / 3);
}

void hk_gas_burn(hk_gas *s, double h) {
  hk_gas_task t = {.gas = s, .h = h};
  if (s->carried[HK_GAS_FUEL] || s->cooling > 0 || s->radiation > 0) hk_gas_each(&t, burn_cell);
}
