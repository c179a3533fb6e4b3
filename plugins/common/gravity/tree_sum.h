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

#include "plugins/common/gravity/direct_sum.h"

/* Bodies of a group at most. On 1e5 bodies of a Plummer sphere forces took 0.20, 0.14, 0.12 and 0.11 s with 32, 64, 128
 * and 256 at alpha = 0.005, and the 99th percentile of their errors was 4.1e-3, 2.6e-3, 1.7e-3 and 1.5e-3. */
enum { HK_GROUP = 256 };

/* What a walk has to know of a cell: one line of cache. */
typedef struct hk_walk_cell {
  double at[3];   /* scaled: its centre of mass */
  double radius2; /* R^2 */
  double needs;   /* (M R^3)^(2/5), or (2 R)^2 */
  uint32_t next;  /* as hk_octree_cell */
  uint32_t begin, count;
} hk_walk_cell;

typedef struct hk_gravity_tree {
  size_t room;
  size_t cells;
  hk_walk_cell *walk;                /* cells */
  double (*moment)[HK_CELL_NUMBERS]; /* cells, scaled */
  size_t groups;
  uint32_t *group; /* groups + 1: their first bodies */
  double *size;    /* per body, the estimate of |a|; then per group, the sum of its squares */
} hk_gravity_tree;

typedef struct hk_tree_accuracy {
  double alpha; /* where `angle` is not given */
  double angle; /* NAN: not given */
} hk_tree_accuracy;

/* Memory for n bodies. HK_NO_MEMORY, without a message. */
hk_status hk_tree_reserve(hk_gravity_tree *, const hk_host *, size_t n);
void hk_tree_release(hk_gravity_tree *, const hk_host *);
/* The moments of the cells of `tree`, in whose order the bodies were gathered. */
void hk_tree_moments(hk_gravity_tree *, const hk_gravity_bodies *, const hk_octree *tree, const hk_tree_accuracy *);
/* As hk_direct_forces and the others, for all pairs. */
bool hk_tree_forces(hk_gravity_tree *, hk_gravity_bodies *, const hk_tree_accuracy *, double G, double *F);
double hk_tree_energy(hk_gravity_tree *, hk_gravity_bodies *, const hk_tree_accuracy *, double G);
void hk_tree_stiffness(hk_gravity_tree *, hk_gravity_bodies *, double G, double *pull);

#endif
