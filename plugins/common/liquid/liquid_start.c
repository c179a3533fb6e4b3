/* See liquid_start.h. */
#include "plugins/common/liquid/liquid_start.h"

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

/* m, through the solid where it is thinnest; INFINITY: it has but one side. */
static double thickness_of(const hk_liquid_grid *g, const hk_shape *shape) {
  if (shape->kind == HK_SHAPE_PLANE || shape->kind == HK_SHAPE_MESH || shape->hollow) return INFINITY;
  double least = INFINITY;
  bool plane = g->flat[0] || g->flat[1] || g->flat[2];
  for (int c = 0; c < 3; c++)
    if (!plane || shape->kind != HK_SHAPE_BOX || !g->flat[c]) least = fmin(least, 2 * shape->half[c]);
  return least;
}

void hk_liquid_warn_of_thin(const hk_liquid *l) {
  double cell = fmax(l->grid.spacing[0], fmax(l->grid.spacing[1], l->grid.spacing[2]));
  for (size_t k = 0; k < l->obstacles->count; k++) {
    double least = thickness_of(&l->grid, &l->obstacles->member[k]->shape);
    if (least < 2 * cell)
      l->host->warn(
          l->host,
          "obstacle %zu is %.3g m thin, and cells are %.3g m: the liquid may leak through what is thinner than "
          "two of them; take smaller ones or a thicker obstacle",
          k + 1, least, cell);
  }
}
