/* Gravitation by an octree, n log n: a cell far away acts as one body with a quadrupole (Barnes and Hut 1986; Hernquist
 * 1987). The bodies of a small cell are a group, which walks the tree once for all; the kernels of gravity_path.h then
 * sum what it has listed for 16 bodies at a time.
 *
 * A cell of mass M, whose bodies are within R of its centre of mass, is taken whole at a distance r from the group's
 * box where r > R and M R^3 <= alpha |a| r^5       the first order left out against the least acceleration in the group
 * (as GADGET's criterion, Springel 2005, eq. 18, for a quadrupole), or, where one is given, 2 R <= theta r the classic
 * opening angle. |a| is estimated by a walk with monopoles, and at least a hundredth of its root mean square: where
 * forces cancel, nobody asks for a small error relative to nothing. So forces are a function of the places alone. */
#ifndef HK_TREE_SUM_H
#define HK_TREE_SUM_H

#include "plugins/common/gravity/gravity_tree.h"

/* What the sums of groups have in common. */
typedef struct hk_tree_pulls {
  hk_gravity_tree *tree;
  hk_gravity_bodies *g;
  const hk_tree_accuracy *accuracy;
  double least; /* |a| that errors are compared with at least */
} hk_tree_pulls;

hk_tree_pulls hk_tree_pulls_of(hk_gravity_tree *, hk_gravity_bodies *, const hk_tree_accuracy *);
/* a: sum of m d/s^3 for each body of a group, scaled. Returns 1 + a body that with softening 0 is at the
 * place of another one, or 0. */
size_t hk_tree_pull(const hk_tree_pulls *, size_t group, double (*a)[3]);

/* As hk_direct_forces and the others, for all pairs. */
bool hk_tree_forces(hk_gravity_tree *, hk_gravity_bodies *, const hk_tree_accuracy *, double G, double *F);
double hk_tree_energy(hk_gravity_tree *, hk_gravity_bodies *, const hk_tree_accuracy *, double G);
void hk_tree_stiffness(hk_gravity_tree *, hk_gravity_bodies *, double G, double *pull);

#endif
