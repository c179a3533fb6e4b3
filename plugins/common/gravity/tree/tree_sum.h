/* Gravitation by an octree, n log n: a cell far away acts as one body with a quadrupole (Barnes and Hut 1986; Hernquist
 * 1987). The bodies of a small cell are a group, which walks the tree once for all; the kernels of gravity_path.h then
 * sum what it has listed for 16 bodies at a time.
 *
 * A cell of mass M, whose bodies are within R of its centre of mass, is taken whole at a distance r from the group's
 * box where r > R and M R^3 <= alpha |a| r^5       the first order left out against the least acceleration in the group
 * (as GADGET's criterion, Springel 2005, eq. 18, for a quadrupole), or, where one is given, 2 R <= theta r the classic
 * opening angle. |a| is estimated for some bodies of the group by a walk with monopoles, and at least a hundredth of
 * its root mean square: where forces cancel, nobody asks for a small error relative to nothing. So forces are a
 * function of the places alone.
 *
 * Down to alpha = 1e-4, or an angle of 0.2, sums are in single precision where the processor has vectors of 8 floats
 * (single_path.h), in double precision for groups where that does not do: twice as fast with the same errors. Tried
 * without gain: the field of far cells as a Taylor series about the middle of a group (Dehnen 2002) to fourth order,
 * which at an error of 1e-2 takes a third of the cells of a group of 50 at 30 ns each. */
#ifndef HK_TREE_SUM_H
#define HK_TREE_SUM_H

#include "plugins/common/gravity/tree/tree_estimate.h"

/* a: sum of m d/s^3 for each body of a group, scaled. Returns 1 + a body that with softening 0 is at the
 * place of another one, or 0. */
size_t hk_tree_pull(const hk_tree_pulls *, size_t group, double (*a)[3]);

/* As hk_direct_forces and the others, for all pairs. */
bool hk_tree_forces(hk_gravity_tree *, hk_gravity_bodies *, const hk_tree_accuracy *, double G, double *F);
double hk_tree_energy(hk_gravity_tree *, hk_gravity_bodies *, const hk_tree_accuracy *, double G);
void hk_tree_stiffness(hk_gravity_tree *, hk_gravity_bodies *, double G, double *pull);

#endif
