#include "plugins/common/gas/gas_pace.h"

#include "plugins/kit/vector3.h"

static double lift_of(const hk_gas *s, double heat, double smoke) {
  return fabs(smoke / s->density - s->expansion * heat) * sqrt(hk_dot(s->gravity, s->gravity));
}

double hk_gas_fastest_lift(const hk_gas *s, const hk_gas_source *source) {
  double most = source ? lift_of(s, source->value[HK_GAS_HEAT], source->value[HK_GAS_SMOKE]) : 0;
  for (size_t i = 0; i < s->flow.grid.size; i++)
    most = fmax(most, lift_of(s, s->now[HK_GAS_HEAT][i], s->now[HK_GAS_SMOKE][i]));
  return most;
}

/* Cells a second and a second^2: speed h + lift h^2 = courant. */
double hk_gas_longest_step(const hk_gas *s, double lift, double courant) {
  const hk_liquid_grid *g = &s->flow.grid;
  double speed = hk_gas_courant(s, s->now, 1), most = 0;
  for (int c = 0; c < 3; c++)
    if (!g->flat[c] && s->gravity[c] != 0) most = fmax(most, lift / g->spacing[c]);
  double rising = speed + sqrt(speed * speed + 4 * most * courant);
  return rising > 0 ? 2 * courant / rising : INFINITY;
}
