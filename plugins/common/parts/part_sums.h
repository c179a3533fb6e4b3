/* Forces that are sums over elements of a few particles, part by part: with the loop over some of its elements, a force
 * has `add`, `add_part` and `parts`. */
#ifndef HK_PART_SUMS_H
#define HK_PART_SUMS_H

#include "plugins/common/parts/part_lists.h"

/* Adds to F what the elements item[0] ... item[count - 1] exert, in this order, and returns their power, W. */
typedef double (*hk_part_body)(const void *force, const hk_view *view, const uint32_t *item, size_t count, double *F);

/* To be zeroed before the first use. The memory belongs to the instance and is released with it. */
typedef struct hk_part_sums {
  hk_part_lists lists;
  double *power; /* W, of the parts in one `add` */
} hk_part_sums;

/* To be called in `create` and `topology`; is_active: as of hk_part_lists_sort. HK_NO_MEMORY. */
hk_status hk_part_sums_sort(hk_part_sums *, const hk_view *view, const hk_tuples *node, const bool *is_active);
/* F += one part, as hk_force.add_part does it, or HK_ALL_PARTS, on several threads, as hk_force.add; view->power gets
 * their power. `force`: the argument of `body`. */
void hk_part_sums_add(const hk_part_sums *, const hk_view *view, size_t part, hk_part_body body, const void *force,
                      double *F);

#endif
