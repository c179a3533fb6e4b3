/* Near bodies are copied one after the other, so that the loop over them is long. */
#include "plugins/common/gravity/tree/single_sum.h"
#include "plugins/common/gravity/tree/tree_walk.h"

#include <string.h>

enum { ROOM = 512, LANES_MOST = 16 };

typedef struct single_sum {
  const hk_gravity_tree *tree;
  double eps2;
  hk_single_targets targets;
  size_t sources;
  float source[ROOM][HK_SINGLE_BODY];
  hk_walk_list list;
} single_sum;

static void open_targets(single_sum *s, const hk_group *group) {
  hk_single_targets *t = &s->targets;
  t->count = group->count;
  memset(t->a, 0, sizeof t->a);
  memset(t->near, 0, sizeof t->near);
  size_t until = (group->count + LANES_MOST - 1) / LANES_MOST * LANES_MOST;
  for (size_t l = 0; l < until; l++) {
    const float *body = s->tree->body[group->first + (l < group->count ? l : 0)];
    for (int c = 0; c < 6; c++) t->at[c][l] = body[c];
  }
}

static void use_sources(single_sum *s) {
  s->tree->single->pull((const float(*)[HK_SINGLE_BODY])s->source, s->sources, s->eps2, &s->targets);
  s->sources = 0;
}

static void pull_of_list(void *context, const hk_walk_list *l) {
  single_sum *s = context;
  const hk_gravity_tree *t = s->tree;
  t->single->pull_of_cells((const float(*)[HK_SINGLE_CELL])t->cell, l->cell, l->cells, s->eps2, &s->targets);
  for (size_t r = 0; r < l->ranges; r++)
    for (size_t k = l->range[r][0], end = l->range[r][1]; k < end;) {
      size_t here = end - k < ROOM - s->sources ? end - k : ROOM - s->sources;
      memcpy(s->source + s->sources, t->body + k, here * sizeof *s->source);
      s->sources += here, k += here;
      if (s->sources == ROOM) use_sources(s);
    }
}

/* Whether all is finite, and no body is near another one than itself. */
static bool close_targets(const hk_single_targets *t, double mass, double (*a)[3]) {
  double all = 0;
  bool apart = true;
  for (size_t l = 0; l < t->count; l++) {
    for (size_t c = 0; c < 3; c++) {
      a[l][c] = t->a[c][l] * mass;
      all += 0 * a[l][c];
    }
    apart = apart && t->near[l] <= 1;
  }
  return apart && all == 0;
}

bool hk_single_pull(const hk_tree_pulls *t, size_t index, double (*a)[3]) {
  single_sum s;
  hk_group group = hk_group_of(t->tree, t->g, index);
  s.tree = t->tree, s.eps2 = t->g->eps2, s.sources = 0;
  group.factor = hk_tree_factor(t, index);
  open_targets(&s, &group);
  hk_tree_walk(t->tree, &group, HK_WALK_NEEDS, &s.list, pull_of_list, &s);
  use_sources(&s);
  return close_targets(&s.targets, 1 / t->tree->mass_scale, a);
}
