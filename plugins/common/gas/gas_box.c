/* Whether a gas has room. */
#include "plugins/common/gas/gas.h"

hk_status hk_gas_check_box(const hk_host *host, const double low[3], const double high[3], double cell, double most) {
  double cells[3];
  int flat = 0;
  for (int c = 0; c < 3; c++) {
    double length = high[c] - low[c];
    if (!(length >= 0))
      return host->fail(host, HK_BAD_PARAM,
                        "high: %g m is below low, %g m, along %c: the gas has no room; give the box's upper corner",
                        high[c], low[c], "xyz"[c]);
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
