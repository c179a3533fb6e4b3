/* An octree with the moments of its cells, for sums of gravitation by tree_sum.h. */
#ifndef HK_GRAVITY_TREE_H
#define HK_GRAVITY_TREE_H

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
#endif
