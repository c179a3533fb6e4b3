/* The walk of a group through a tree, and the list of what acts on it: cells and ranges of bodies. A list that is full
 * is used and emptied, so that memory is bounded. */
#ifndef HK_TREE_WALK_H
#define HK_TREE_WALK_H

#include "plugins/common/gravity/tree/gravity_tree.h"

enum { HK_GROUP_BLOCKS = HK_GROUP / HK_GRAVITY_BLOCK, HK_WALK_ROOM = 1024 };

typedef struct hk_group {
  size_t first, count;
  double center[3], half[3]; /* its box */
  double factor;             /* see hk_walk_rule */
} hk_group;

typedef struct hk_walk_list {
  size_t cells, ranges;
  uint32_t cell[HK_WALK_ROOM], range[HK_WALK_ROOM][2]; /* begin and end of bodies */
} hk_walk_list;

/* The cells of a list as point masses. */
typedef struct hk_walk_points {
  double number[4][HK_WALK_ROOM];
  hk_bodies at;
} hk_walk_points;

/* Which cells at a distance r, with R < r, are taken whole. */
typedef enum hk_walk_rule {
  HK_WALK_NEEDS, /* those with needs <= factor r^2 */
  HK_WALK_RADII, /* those with R^2 <= factor r^2 */
  HK_WALK_ROUGH  /* all; near ones too, where they have few bodies, so that lists have cells only */
} hk_walk_rule;

hk_group hk_group_of(const hk_gravity_tree *, const hk_gravity_bodies *, size_t index);

/* r^2 from a cell's centre to the nearest point of the group's box. */
static inline double hk_group_distance2(const hk_group *g, const hk_walk_cell *c) {
  double r2 = 0;
  for (int k = 0; k < 3; k++) {
    double d = fabs(c->at[k] - g->center[k]) - g->half[k];
    d = d > 0 ? d : 0;
    r2 += d * d;
  }
  return r2;
}

/* Calls `use` with lists that together have all that acts on the group. */
void hk_tree_walk(const hk_gravity_tree *, const hk_group *, hk_walk_rule, hk_walk_list *,
                  void (*use)(void *context, const hk_walk_list *), void *context);

/* The parts of `into` that are used have the cells of the list. */
void hk_walk_points_of(const hk_gravity_tree *, const hk_walk_list *, hk_walk_points *into);

#endif
