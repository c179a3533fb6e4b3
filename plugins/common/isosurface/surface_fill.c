/* Isosurface stuffing in three passes: values and cuts of the lattice, points onto the surface, tetrahedra. */
#include "plugins/common/isosurface/surface_fill.h"
#include "plugins/common/isosurface/fill_lattice.h"

void hk_filling_free(hk_filling *f, const hk_host *host) {
  host->release(host, f->x);
  host->release(host, f->tetrahedron);
  *f = (hk_filling){0};
}

hk_status hk_surface_fill(hk_filling *filling, const hk_host *host, const hk_isosurface_grid *grid,
                          const hk_isosurface_field *field, const hk_isosurface_options *options) {
  hk_fill_work w = {.host = host, .grid = grid, .field = field, .options = options};
  hk_status status = hk_fill_survey(&w);
  if (status == HK_OK) hk_fill_move_points(&w);
  if (status == HK_OK) status = hk_fill_cells(&w);
  host->release(host, w.value);
  host->release(host, w.side);
  host->release(host, w.first);
  host->release(host, w.moved);
  host->release(host, w.number);
  host->release(host, w.cut);
  if (status != HK_OK) hk_filling_free(&w.found, host);
  if (status != HK_OK) return status;
  hk_filling_free(filling, host);
  *filling = w.found;
  return HK_OK;
}
