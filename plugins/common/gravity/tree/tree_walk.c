/* One loop over the cells in their order, which goes past those that are taken whole. */
#include "plugins/common/gravity/tree/tree_walk.h"

enum {
  FEW = 2,  /* bodies that cost less than a cell with its quadrupole */
  NEAR = 64 /* bodies that a rough walk does not look into */
};

/* Scaled distance below which no cell is taken whole for forces: its centre has an error of some 1e-16, in single
 * precision (single_path.h) of 2e-15. */
static const double nearest = HK_SINGLE_NEAR;

static void stretch(double at, double *low, double *high) {
  if (at < *low) *low = at;
  if (at > *high) *high = at;
}

hk_group hk_group_of(const hk_gravity_tree *t, const hk_gravity_bodies *g, size_t index) {
  hk_group group = {.first = t->group[index], .count = t->group[index + 1] - t->group[index]};
  double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
  for (size_t k = group.first; k < group.first + group.count; k++) {
    stretch(g->at.x[k], &low[0], &high[0]);
    stretch(g->at.y[k], &low[1], &high[1]);
    stretch(g->at.z[k], &low[2], &high[2]);
  }
  for (int c = 0; c < 3; c++) {
    group.center[c] = (low[c] + high[c]) / 2;
    group.half[c] = (high[c] - low[c]) / 2;
  }
  return group;
}

static void add_range(hk_walk_list *l, uint32_t begin, uint32_t end) {
  if (l->ranges > 0 && l->range[l->ranges - 1][1] == begin) {
    l->range[l->ranges - 1][1] = end;
    return;
  }
  l->range[l->ranges][0] = begin;
  l->range[l->ranges++][1] = end;
}

static bool is_taken(const hk_group *g, const hk_walk_cell *c, hk_walk_rule rule) {
  double r2 = hk_group_distance2(g, c);
  if (rule == HK_WALK_ROUGH) return r2 > c->radius2 || c->count <= NEAR;
  return r2 > c->radius2 && r2 >= nearest * nearest &&
         r2 * g->factor >= (rule == HK_WALK_RADII ? c->radius2 : c->needs);
}

void hk_tree_walk(const hk_gravity_tree *t, const hk_group *g, hk_walk_rule rule, hk_walk_list *l,
                  void (*use)(void *context, const hk_walk_list *), void *context) {
  l->cells = l->ranges = 0;
  for (size_t k = 0; k < t->cells;) {
    const hk_walk_cell *c = &t->walk[k];
    bool taken = is_taken(g, c, rule);
    if (!taken && c->next > k + 1) {
      k++;
      continue;
    }
    if (rule == HK_WALK_ROUGH || (taken && c->count > FEW))
      l->cell[l->cells++] = (uint32_t)k;
    else
      add_range(l, c->begin, c->begin + c->count);
    k = c->next;
    if (l->cells < HK_WALK_ROOM && l->ranges < HK_WALK_ROOM) continue;
    use(context, l);
    l->cells = l->ranges = 0;
  }
  use(context, l);
}

void hk_walk_points_of(const hk_gravity_tree *t, const hk_walk_list *l, hk_walk_points *into) {
  into->at = (hk_bodies){into->number[0], into->number[1], into->number[2], into->number[3]};
  for (size_t k = 0; k < l->cells; k++) {
    const double *m = t->moment[l->cell[k]];
    for (size_t c = 0; c < 3; c++) into->number[c][k] = m[c];
    into->number[3][k] = m[HK_CELL_M];
  }
}
