/* Sums in double precision: they are few. */
#include "plugins/common/gravity/tree/tree_estimate.h"
#include "plugins/common/gravity/tree/tree_walk.h"

enum { BLOCK = HK_GRAVITY_BLOCK };

static const double least_part = 0.01; /* of the root mean square of |a|: see tree_sum.h */

typedef struct estimate {
  const hk_tree_pulls *of;
  hk_group group;
  double eps2;
  hk_targets at;
  hk_pull pull;
  hk_walk_list list;
} estimate;

static void pull_of_list(void *context, const hk_walk_list *l) {
  estimate *e = context;
  hk_walk_points p;
  hk_walk_points_of(e->of->tree, l, &p);
  e->of->g->path->pull(&p.at, 0, l->cells, &e->at, e->eps2, &e->pull);
}

/* Returns how many bodies are targets; the softening is at least the size of the group. */
static size_t open_estimate(estimate *e, const hk_tree_pulls *t, size_t index) {
  const hk_bodies *at = &t->g->at;
  e->of = t;
  e->pull = (hk_pull){0};
  e->group = hk_group_of(t->tree, t->g, index);
  e->eps2 = t->g->eps2;
  for (size_t c = 0; c < 3; c++) e->eps2 += e->group.half[c] * e->group.half[c];
  size_t count = e->group.count < BLOCK ? e->group.count : BLOCK;
  for (size_t l = 0; l < BLOCK; l++) {
    size_t k = e->group.first + (l < count ? (2 * l + 1) * e->group.count / (2 * count) : 0);
    e->at.x[0][l] = at->x[k], e->at.x[1][l] = at->y[k], e->at.x[2][l] = at->z[k];
  }
  return count;
}

static void estimate_groups(void *context, size_t begin, size_t end, size_t chunk) {
  const hk_tree_pulls *t = context;
  estimate e;
  (void)chunk;
  for (size_t index = begin; index < end; index++) {
    double sum = 0, least = INFINITY;
    size_t count = open_estimate(&e, t, index);
    hk_tree_walk(t->tree, &e.group, HK_WALK_ROUGH, &e.list, pull_of_list, &e);
    for (size_t l = 0; l < count; l++) {
      double x = e.pull.a[0][l], y = e.pull.a[1][l], z = e.pull.a[2][l], a2 = x * x + y * y + z * z;
      least = fmin(least, sqrt(a2));
      sum += a2;
    }
    t->tree->size[index] = least;
    t->tree->size[t->tree->groups + index] = sum * (double)e.group.count / (double)count;
  }
}

hk_tree_pulls hk_tree_pulls_of(hk_gravity_tree *tree, hk_gravity_bodies *g, const hk_tree_accuracy *accuracy) {
  hk_tree_pulls t = {tree, g, accuracy, 0};
  double sum = 0;
  if (!isnan(accuracy->angle)) return t;
  g->host->parallel_for(g->host, tree->groups, 1, estimate_groups, &t);
  for (size_t k = 0; k < tree->groups; k++) sum += tree->size[tree->groups + k];
  t.least = g->count ? least_part * sqrt(sum / (double)g->count) : 0;
  return t;
}

double hk_tree_factor(const hk_tree_pulls *t, size_t group) {
  if (!isnan(t->accuracy->angle)) return t->accuracy->angle * t->accuracy->angle;
  return pow(t->accuracy->alpha * fmax(t->tree->size[group], t->least), 0.4);
}
