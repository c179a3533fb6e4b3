/* The sums of a group of bodies by the tree in single precision. */
#ifndef HK_SINGLE_SUM_H
#define HK_SINGLE_SUM_H

#include "plugins/common/gravity/tree/tree_estimate.h"

/* As hk_tree_pull, of a tree that has `single`. False: something is too near for single precision, or leaves its range,
 * and `a` is undefined. */
bool hk_single_pull(const hk_tree_pulls *, size_t group, double (*a)[3]);

#endif
