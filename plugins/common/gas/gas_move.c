/* The way of tracers in a gas. */
#include "plugins/common/gas/gas.h"

static const double margin = 1e-3; /* of a cell: tracers are no nearer to closed sides */

void hk_gas_flow(const hk_gas *s, const double x[3], double u[3]) {
  const hk_liquid_grid *g = &s->flow.grid;
  hk_liquid_place at;
  hk_liquid_locate(g, x, &at);
  for (int a = 0; a < 3; a++) u[a] = g->flat[a] ? 0 : hk_liquid_value(g, s->now[a], &at, a);
}

void hk_gas_keep(const hk_gas *s, size_t particle, double x[3]) {
  const hk_liquid_grid *g = &s->flow.grid;
  const hk_obstacle_set *all = s->flow.obstacles;
  for (size_t k = 0; all && k < all->count; k++) {
    double n[3], gap = hk_obstacle_gap(all->member[k], &all->member[k]->motion.end, x, particle, n);
    for (int c = 0; c < 3 && gap < 0; c++) x[c] -= gap * n[c];
  }
  for (int c = 0; c < 3; c++) {
    double least = g->flat[c] ? 0 : margin * g->spacing[c];
    if (!s->open[c][0]) x[c] = fmax(x[c], g->low[c] + least);
    if (!s->open[c][1]) x[c] = fmin(x[c], g->high[c] - least);
  }
}

void hk_gas_move(const hk_gas *s, size_t particle, double h, double x[3]) {
  double u[3], middle[3];
  hk_gas_flow(s, x, u);
  for (int c = 0; c < 3; c++) middle[c] = x[c] + h / 2 * u[c];
  hk_gas_flow(s, middle, u);
  for (int c = 0; c < 3; c++) x[c] += h * u[c];
  hk_gas_keep(s, particle, x);
}
