/* The fields of a gas at the start. */
#include "plugins/common/gas/gas_start.h"

enum { IN = 5, OUT = 3 };

/* Field f, number `part` of the function's results, less `from`. */
static hk_status fill(hk_gas *s, int f, const hk_function *function, size_t results, double from, double t) {
  const hk_liquid_grid *g = &s->flow.grid;
  size_t rows = hk_liquid_rows(g, 1), length = g->cells[hk_liquid_inner(g)] + 1;
  for (size_t k = 0; k < rows; k++) {
    const hk_liquid_row row = hk_liquid_row_at(g, k, 1);
    for (size_t i = row.first; i < row.first + length; i++) {
      double in[IN] = {t, 0, 0, 0, (double)i}, out[OUT];
      if (!hk_gas_has(g, &row, i, f)) continue;
      hk_gas_point(g, &row, i, f, in + 1);
      hk_status status = s->host->call(s->host, function, in, IN, out, results);
      if (status != HK_OK) return status;
      s->now[f][i] = out[f < 3 ? f : 0] - from;
    }
  }
  return HK_OK;
}

hk_status hk_gas_start_fields(hk_gas *s, const hk_gas_start *start, double t) {
  const hk_function *const of[HK_GAS_FIELDS] = {start->velocity,    start->velocity, start->velocity,
                                                start->temperature, start->smoke,    start->fuel};
  hk_status status = HK_OK;
  for (int f = 0; f < HK_GAS_FIELDS && status == HK_OK; f++) {
    bool moves = f < 3 && !s->flow.grid.flat[f];
    for (size_t i = 0; moves && i < s->flow.grid.size; i++) s->now[f][i] = s->wind[f];
    if (of[f] && s->carried[f]) status = fill(s, f, of[f], f < 3 ? 3 : 1, f == HK_GAS_HEAT ? start->ambient : 0, t);
  }
  return status;
}
