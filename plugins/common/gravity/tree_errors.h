/* The errors of sums by the tree, from a sample of bodies all over it that are summed over all pairs as well. */
#ifndef HK_TREE_ERRORS_H
#define HK_TREE_ERRORS_H

#include "plugins/common/gravity/tree_sum.h"

enum { HK_SAMPLE_GROUPS = 64, HK_SAMPLE = 4 * HK_SAMPLE_GROUPS };

/* Bodies with their sums of m d/s^3, scaled: as found by an approximation, and exact. */
typedef struct hk_pull_sample {
  uint32_t body[HK_SAMPLE]; /* position in the order; UINT32_MAX: none */
  double found[HK_SAMPLE][3], exact[HK_SAMPLE][3];
} hk_pull_sample;

void hk_pull_sample_clear(hk_pull_sample *);
/* v: n x 3, of the particles in the order of the view. */
void hk_pull_sample_errors(const hk_pull_sample *, const hk_gravity_bodies *, double G, const double *v,
                           hk_force_errors *out);

void hk_tree_errors(hk_gravity_tree *, hk_gravity_bodies *, const hk_tree_accuracy *, double G, const double *v,
                    hk_force_errors *out);

#endif
