/* Whether a gas has room, and its grid cells enough. */
#include "plugins/common/gas/gas.h"
#include "plugins/common/mac_grid/narrow_gaps.h"
#include "plugins/common/mac_grid/thin_solids.h"

hk_status hk_gas_check_box(const hk_host *host, const double low[3], const double high[3], double cell, double most) {
  double cells[3];
  int flat = 0;
  for (int c = 0; c < 3; c++) {
    double length = high[c] - low[c];
    if (!(length >= 0))
      return host->fail(host, HK_BAD_PARAM,
                        "high: %g m is below low, %g m, along %c: the gas has no room; give the box's upper corner",
                        high[c], low[c], "xyz"[c]);
    if (length > 0 && length <= cell / 2)
      return host->fail(host, HK_BAD_PARAM,
                        "cell: %g m is twice the box along %c, %g m, or more: take smaller cells, or for a plane a box "
                        "without depth there, high = low",
                        cell, "xyz"[c], length);
    flat += length == 0;
    cells[c] = length == 0 ? 1 : fmax(1, round(length / cell));
  }
  if (flat > 1)
    return host->fail(host, HK_BAD_PARAM,
                      "low, high: the box has no depth along two axes or more: a gas needs a plane or space; give it "
                      "room along another one");
  double bytes = hk_gas_bytes(cells);
  if (bytes > most)
    return host->fail(host, HK_BAD_PARAM,
                      "cell: a gas on %.0f x %.0f x %.0f cells of %g m takes %.3g GB, and `memory` allows %.3g: take "
                      "larger cells or a smaller box, or allow more",
                      cells[0], cells[1], cells[2], cell, bytes / 1e9, most / 1e9);
  return HK_OK;
}

void hk_gas_warn_of_cells(const hk_gas *s, double source_radius) {
  const hk_liquid_grid *g = &s->flow.grid;
  const hk_obstacle_set *all = s->flow.obstacles;
  double cell = fmax(g->spacing[0], fmax(g->spacing[1], g->spacing[2]));
  hk_warn_of_thin(s->host, g, all, "gas");
  hk_warn_of_gaps(s->host, g, all, s->open, "gas");
  for (int c = 0; c < 3; c++)
    if (!g->flat[c] && g->cells[c] < 4)
      s->host->warn(s->host,
                    "the gas has %zu cells across its box along %c: fewer than four show no flow; take cells of "
                    "%.3g m or less",
                    g->cells[c], "xyz"[c], (g->high[c] - g->low[c]) / 4);
  if (source_radius < cell)
    s->host->warn(s->host,
                  "source_radius: %.3g m is less than a cell, %.3g m: what such a source gives depends on "
                  "where cells are; take a larger one or smaller cells",
                  source_radius, cell);
}
