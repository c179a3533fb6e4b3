/* The sides of a gas's box, obstacles in it, and the projection. */
#include "plugins/common/gas/gas.h"

#include <string.h>

void hk_gas_open_sides(hk_gas *s, hk_gas_open which) {
  for (int c = 0; c < 3; c++)
    for (int upper = 0; upper < 2; upper++) {
      bool open = c < 2 ? which >= HK_GAS_SIDES : upper ? which >= HK_GAS_TOP : which == HK_GAS_ALL;
      s->open[c][upper] = open && !s->flow.grid.flat[c];
      s->inlet[c][upper] = s->open[c][upper] && (upper ? -s->wind[c] : s->wind[c]) > 0;
    }
}

/* Faces on sides that are open have no wall, those of inlets the wind. */
static void open_face(const hk_gas_task *t, const hk_liquid_row *row, size_t i) {
  hk_gas *s = t->gas;
  hk_liquid_grid *g = &s->flow.grid;
  for (int c = 0; c < 3; c++) {
    if (!hk_gas_has(g, row, i, c) || !hk_liquid_on_box(g, row, i, c)) continue;
    bool upper = hk_gas_at(g, row, i, c) > 1;
    bool blocked = !(g->solid[i] > 0);
    g->open[c][i] = s->open[c][upper] && !s->inlet[c][upper] && !blocked;
    g->wall[c][i] = s->inlet[c][upper] && !blocked ? s->wind[c] : 0;
  }
}

void hk_gas_walls(hk_gas *s) {
  hk_liquid_grid *g = &s->flow.grid;
  hk_gas_task t = {.gas = s};
  hk_liquid_walls(&s->flow);
  hk_gas_each(&t, open_face);
  for (size_t i = 0; i < g->size; i++) g->filled[i] = 1;
  hk_liquid_find_surface(&s->flow);
}

/* The pressure that the step began with is counted in: what was found is the rest. */
hk_status hk_gas_project(hk_gas *s, double h, double last) {
  hk_liquid_grid *g = &s->flow.grid;
  size_t bytes = g->size * sizeof(double);
  double had = last > 0 ? h / last / 2 : 0, *rest = s->work[0];
  for (int c = 0; c < 3; c++) memcpy(g->u[c], s->now[c], bytes);
  for (size_t i = 0; i < g->size; i++) rest[i] = had * s->impulse_before[i];
  hk_status status = hk_liquid_project(&s->flow, rest);
  if (status != HK_OK) return status;
  for (size_t i = 0; i < g->size; i++) s->impulse[i] = had * s->impulse_before[i] + rest[i];
  if (s->sticks != HK_GAS_STICKS && s->flow.obstacles && s->flow.obstacles->count) hk_liquid_extend(&s->flow, 4);
  for (int c = 0; c < 3; c++) memcpy(s->now[c], g->u[c], bytes);
  return HK_OK;
}
