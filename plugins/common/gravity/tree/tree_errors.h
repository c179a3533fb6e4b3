/* The errors of sums by the tree, from a sample of bodies all over it that are summed over all pairs as well. */
#ifndef HK_TREE_ERRORS_H
#define HK_TREE_ERRORS_H

#include "plugins/common/gravity/tree/tree_sum.h"

/* v: n x 3, of the particles in the order of the view. */
void hk_tree_errors(hk_gravity_tree *, hk_gravity_bodies *, const hk_tree_accuracy *, double G, const double *v,
                    hk_force_errors *out);

#endif
