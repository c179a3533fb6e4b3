#include "plugins/common/gas/gas_balance.h"

double hk_gas_sum(const hk_gas *s, int field) {
  const hk_liquid_grid *g = &s->flow.grid;
  double sum = 0, volume = 1;
  for (size_t k = 0; k < hk_liquid_rows(g, 0); k++) {
    const hk_liquid_row row = hk_liquid_row_at(g, k, 0);
    for (size_t i = row.first; i < row.first + g->cells[hk_liquid_inner(g)]; i++) sum += s->now[field][i];
  }
  for (int c = 0; c < 3; c++) volume *= g->flat[c] ? 1 : g->spacing[c];
  return sum * volume;
}

static bool is_closed(const hk_gas *s) {
  bool open = s->flow.obstacles && s->flow.obstacles->count > 0;
  for (int c = 0; c < 3; c++) open |= s->open[c][0] || s->open[c][1];
  return !open;
}

void hk_gas_balance_before(hk_gas_balance *b, const hk_gas *s) {
  for (int k = 0; k < HK_GAS_SUMS && is_closed(s); k++) {
    double sum = s->carried[HK_GAS_HEAT + k] ? hk_gas_sum(s, HK_GAS_HEAT + k) : 0;
    b->moved[k] -= sum;
    b->whole[k] = fmax(b->whole[k], fabs(sum));
  }
}

void hk_gas_balance_after(hk_gas_balance *b, const hk_gas *s) {
  for (int k = 0; k < HK_GAS_SUMS && is_closed(s); k++)
    if (s->carried[HK_GAS_HEAT + k]) b->moved[k] += hk_gas_sum(s, HK_GAS_HEAT + k);
}

double hk_gas_drift(const hk_gas_balance *b, const hk_gas *s) {
  double most = NAN;
  for (int k = 0; k < HK_GAS_SUMS && is_closed(s); k++)
    if (b->whole[k] > 0 && !(fabs(most) >= fabs(b->moved[k] / b->whole[k]))) most = b->moved[k] / b->whole[k];
  return most;
}
