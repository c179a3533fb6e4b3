#include "plugins/common/mac_grid/narrow_gaps.h"

#include <stdio.h>

enum { TURNS = 200 };
static const double touching = 1e-6; /* of a gap's ends, by its narrowing in a turn, and by a cell */

/* From x to the surface, along the normal; returns the distance. */
static double go_to(const hk_obstacle *o, double x[3]) {
  double n[3], gap = hk_obstacle_gap(o, &o->motion.end, x, 0, n) + hk_obstacle_radius(o, 0);
  for (int c = 0; c < 3; c++) x[c] -= gap * n[c];
  return gap;
}

static void take_middle(const double a[3], const double b[3], double middle[3]) {
  for (int c = 0; c < 3; c++) middle[c] = (a[c] + b[c]) / 2;
}

double hk_gap_between(const hk_obstacle *a, const hk_obstacle *b, double middle[3]) {
  double x[3], y[3], gap = 0;
  for (int c = 0; c < 3; c++) x[c] = a->motion.end.origin[c];
  for (int turn = 0; turn < TURNS; turn++) {
    double before = gap;
    for (int c = 0; c < 3; c++) y[c] = x[c];
    if (!(go_to(b, y) > 0)) return 0;
    for (int c = 0; c < 3; c++) x[c] = y[c];
    gap = go_to(a, x);
    if (!(gap > 0)) return 0;
    take_middle(x, y, middle);
    if (fabs(before - gap) <= touching * gap) return gap;
  }
  return 0;
}

double hk_gap_to_side(const hk_obstacle *o, int axis, double at, double inside, double middle[3]) {
  double x[3], y[3], gap = 0;
  for (int c = 0; c < 3; c++) x[c] = o->motion.end.origin[c];
  for (int turn = 0; turn < TURNS; turn++) {
    double before = gap;
    if (!((x[axis] - at) * inside > 0)) return 0;
    for (int c = 0; c < 3; c++) y[c] = c == axis ? at : x[c];
    for (int c = 0; c < 3; c++) x[c] = y[c];
    gap = go_to(o, x);
    if (!(gap > 0)) return 0;
    take_middle(x, y, middle);
    if (fabs(before - gap) <= touching * gap) return gap;
  }
  return 0;
}

/* ---- the narrowest ---- */

typedef struct narrowest {
  const hk_liquid_grid *grid;
  double gap, middle[3];
  size_t first, second; /* obstacles; second: NONE: a side */
  int axis;
  double at;
} narrowest;

enum { NONE = HK_OBSTACLES };

/* Whether it is the narrowest so far. */
static bool consider(narrowest *n, double gap, const double middle[3], double least, size_t first, size_t second) {
  if (!(gap > least) || gap >= n->gap || !hk_liquid_in_box(n->grid, middle)) return false;
  *n = (narrowest){n->grid, gap, {middle[0], middle[1], middle[2]}, first, second, 0, 0};
  return true;
}

static bool has_outside(const hk_obstacle *o) { return o->shape.kind != HK_SHAPE_PLANE && !o->shape.hollow; }

static void look_at_sides(narrowest *n, const hk_obstacle *o, const bool open[3][2], double least, size_t k) {
  double middle[3];
  for (int c = 0; c < 3; c++)
    for (int upper = 0; upper < 2 && !n->grid->flat[c]; upper++) {
      if (open[c][upper]) continue;
      double at = upper ? n->grid->high[c] : n->grid->low[c];
      double gap = hk_gap_to_side(o, c, at, upper ? -1 : 1, middle);
      if (gap > 0 && consider(n, gap, middle, least, k, NONE)) n->axis = c, n->at = at;
    }
}

hk_narrow_gap hk_warn_of_gaps(const hk_host *host, const hk_liquid_grid *g, const hk_obstacle_set *all,
                              const bool open[3][2], const char *what) {
  double cell = 0, middle[3];
  for (int c = 0; c < 3; c++) cell = g->flat[c] ? cell : fmax(cell, g->spacing[c]);
  narrowest n = {.grid = g, .gap = 2 * cell * (1 - touching)};
  double least = touching * cell;
  for (size_t k = 0; k < all->count; k++) {
    if (!has_outside(all->member[k])) continue;
    look_at_sides(&n, all->member[k], open, least, k);
    for (size_t l = 0; l < all->count; l++) {
      if (l == k || (l < k && has_outside(all->member[l]))) continue;
      double gap = hk_gap_between(all->member[k], all->member[l], middle);
      if (gap > 0) consider(&n, gap, middle, least, k, l);
    }
  }
  if (n.gap >= 2 * cell * (1 - touching)) return (hk_narrow_gap){.width = INFINITY, .cell = cell};
  char other[48] = "a side of the box";
  if (n.second != NONE) snprintf(other, sizeof other, "obstacle %zu", n.second + 1);
  host->warn(host,
             "between obstacle %zu and %s, near (%.3g, %.3g, %.3g), is a gap of %.3g m, and cells are %.3g m: no %s "
             "flows as it should through what is narrower than two of them; take cells of %.3g m, or close the gap",
             n.first + 1, other, n.middle[0], n.middle[1], n.middle[2], n.gap, cell, what, n.gap / 2);
  return (hk_narrow_gap){n.gap, cell, n.first, n.second, n.axis, n.at};
}

static bool is_beside(const hk_narrow_gap *g, const hk_obstacle *o, const double x[3]) {
  double n[3], gap = hk_obstacle_gap(o, &o->motion.end, x, 0, n) + hk_obstacle_radius(o, 0);
  return gap > 0 && gap < g->cell;
}

bool hk_gap_holds(const hk_narrow_gap *g, const hk_obstacle_set *all, const double x[3]) {
  if (!isfinite(g->width) || g->first >= all->count || !is_beside(g, all->member[g->first], x)) return false;
  if (g->second == NONE) return fabs(x[g->axis] - g->at) < g->cell;
  return g->second < all->count && is_beside(g, all->member[g->second], x);
}
