/* See liquid_start.h. */
#include "plugins/common/liquid/liquid_start.h"
#include "plugins/common/mac_grid/narrow_gaps.h"
#include "plugins/common/mac_grid/thin_solids.h"
#include "plugins/common/obstacles/obstacles_service.h"

double hk_liquid_default_cell(const hk_view *view, const uint32_t *index, size_t count, double density,
                              const double low[3], const double high[3]) {
  double mass = 0;
  for (size_t k = 0; k < count; k++) mass += view->model->mass[index[k]];
  double volume = mass / ((double)count * density);
  bool plane = low[0] == high[0] || low[1] == high[1] || low[2] == high[2];
  /* in a plane a cell is as deep as it is wide, and has four particles: volume = cell^3/4 */
  return plane ? pow(4 * volume, 1.0 / 3) : 2 * pow(volume, 1.0 / 3);
}

hk_status hk_liquid_check_start(const hk_liquid *l, const hk_view *view, const uint32_t *index, size_t count) {
  const hk_liquid_grid *g = &l->grid;
  for (size_t k = 0; k < count; k++) {
    const double *x = view->x + 3 * (size_t)index[k];
    for (int c = 0; c < 3; c++)
      if (x[c] < g->low[c] || x[c] > g->high[c])
        return l->host->fail(
            l->host, HK_BAD_PARAM,
            "particle %u is outside the box, at %c = %g m where it goes from %g to %g: move it, take a "
            "larger box, or name those that are the liquid by `particles`",
            view->model->id[index[k]], "xyz"[c], x[c], g -> low[c], g -> high[c]);
  }
  return HK_OK;
}

void hk_liquid_warn_of_births(const hk_liquid *l, const hk_view *view, const uint32_t *index, size_t count) {
  const hk_liquid_grid *g = &l->grid;
  for (size_t k = 0; k < count; k++)
    for (int c = 0; c < 3; c++) {
      double x = view->x[3 * (size_t)index[k] + (size_t)c];
      if (x >= g->low[c] && x <= g->high[c]) continue;
      l->host->warn(l->host,
                    "particles of the liquid are born outside its box, and the next step puts them on its faces: "
                    "emit them inside, or take a larger box");
      return;
    }
}

void hk_liquid_warn_of_walls(hk_liquid *l) {
  static const bool open[3][2];
  hk_warn_of_thin(l->host, &l->grid, l->obstacles, "the liquid");
  l->gap = hk_warn_of_gaps(l->host, &l->grid, l->obstacles, open, "liquid");
}

hk_status hk_liquid_find_walls(hk_liquid *l, const bool *const *carried) {
  const hk_obstacles *all = l->host->query(l->host, HK_OBSTACLES_INTERFACE);
  const hk_inflows *inflows = l->host->query(l->host, HK_INFLOWS_INTERFACE);
  if (!all || !inflows) return HK_FAILED;
  l->obstacles = all->set;
  l->inflows = inflows;
  inflows->take(inflows->self);
  return all->carry(all->self, carried);
}
