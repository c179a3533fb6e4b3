/* An octree with the moments of its cells, for sums of gravitation by tree_sum.h. */
#ifndef HK_GRAVITY_TREE_H
#define HK_GRAVITY_TREE_H

#include "plugins/common/gravity/direct_sum.h"
#include "plugins/common/gravity/tree/single_path.h"

/* Bodies of a group at most. On 1e4 bodies of a Plummer sphere at alpha = 0.05 forces took 10.6, 9.6 and 9.4 ms with
 * 64, 128 and 256 (AVX2), and the 99th percentile of their errors was 2.0e-2, 1.2e-2 and 0.8e-2: what is nearer to a
 * group is summed exactly. */
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
  double *size;    /* per group, the estimate of the least |a| in it; then per group, that of the sum of squares */
  const hk_single_path *single; /* NULL: all sums are in double precision */
  double mass_scale;            /* 1/kg, of what follows: a power of two, which brings the whole mass near 1 */
  float (*body)[HK_SINGLE_BODY], (*cell)[HK_SINGLE_CELL];
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
