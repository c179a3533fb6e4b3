/* How large accelerations are, roughly, for the error that a cell may have (tree_sum.h): of 16 bodies of each group,
 * evenly spaced in it, by a walk with monopoles in which near cells stand for bodies between those of the group. All
 * bodies instead of 16 took a quarter of the time that forces of 1e4 bodies did, and left the errors as they were. */
#ifndef HK_TREE_ESTIMATE_H
#define HK_TREE_ESTIMATE_H

#include "plugins/common/gravity/tree/gravity_tree.h"

/* What the sums of groups have in common. */
typedef struct hk_tree_pulls {
  hk_gravity_tree *tree;
  hk_gravity_bodies *g;
  const hk_tree_accuracy *accuracy;
  double least; /* |a| that errors are compared with at least */
} hk_tree_pulls;

/* What of the sums follows from an accuracy: with an opening angle nothing is estimated. */
hk_tree_pulls hk_tree_pulls_of(hk_gravity_tree *, hk_gravity_bodies *, const hk_tree_accuracy *);
/* The factor of a group for HK_WALK_NEEDS: its body with the least acceleration determines it. */
double hk_tree_factor(const hk_tree_pulls *, size_t group);

#endif
