/* The memory of a liquid. */
#include "plugins/common/liquid/liquid.h"

hk_status hk_liquid_open(hk_liquid *l, const hk_host *host, size_t most) {
  size_t cells = l->grid.cells[0] * l->grid.cells[1] * l->grid.cells[2];
  l->host = host;
  l->most = most;
  if (!l->start) {
    l->start = host->allocate(host, (l->grid.size + 1) * sizeof *l->start);
    if (hk_pressure_open(&l->pressure, host, &l->grid) != HK_OK || !l->start)
      return host->fail(host, HK_NO_MEMORY, "no memory for the pressure of %zu cells: take larger ones", cells);
  }
  hk_moving_walls *walls = &l->pressure.walls;
  if (l->bodies.count + l->thin.vertices != walls->bodies) {
    host->release(host, walls->body);
    walls->bodies = l->bodies.count + l->thin.vertices;
    walls->body = walls->bodies ? host->allocate(host, walls->bodies * sizeof *walls->body) : NULL;
    if (walls->bodies && !walls->body)
      return host->fail(host, HK_NO_MEMORY, "no memory for %zu bodies and points of cloth in a liquid", walls->bodies);
  }
  host->release(host, l->sorted);
  host->release(host, l->cell);
  l->sorted = host->allocate(host, (most + 1) * sizeof *l->sorted);
  host->release(host, l->through);
  l->cell = host->allocate(host, (most + 1) * sizeof *l->cell);
  l->through = host->allocate(host, (most + 1) * sizeof *l->through);
  if (l->sorted && l->cell && l->through) return HK_OK;
  return host->fail(host, HK_NO_MEMORY, "no memory for %zu particles of a liquid", most);
}

void hk_liquid_close(hk_liquid *l) {
  if (!l->host) return;
  hk_pressure_close(&l->pressure);
  hk_thin_walls_close(&l->thin);
  hk_liquid_grid_free(&l->grid, l->host);
  l->host->release(l->host, l->start);
  l->host->release(l->host, l->sorted);
  l->host->release(l->host, l->cell);
  l->host->release(l->host, l->through);
  l->start = l->sorted = l->cell = NULL;
  l->through = NULL;
}
