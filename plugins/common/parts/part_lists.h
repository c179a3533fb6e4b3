/* Elements in the order of the parts of a sum (core/plugin/parts.h), and all parts of a force one after the other. */
#ifndef HK_PART_LISTS_H
#define HK_PART_LISTS_H

#include "core/plugin.h"

#define HK_ALL_PARTS SIZE_MAX /* in place of the number of a part */

/* Particles that are not the host's, as one block. */
static inline hk_partition hk_partition_undivided(size_t n) {
  return (hk_partition){.n = n, .bits = 31, .blocks = 1, .width = 1, .domains = 1, .parts = 2};
}

/* The elements of part p are item[first[p]] ... item[first[p + 1] - 1], rising. Of elements with a particle where the
 * force does not act there is none. To be zeroed before the first use. */
typedef struct hk_part_lists {
  size_t count;
  hk_partition partition;
  size_t *first;  /* partition.parts + 1 */
  uint32_t *item; /* count */
} hk_part_lists;

/* To be called in `create` and `topology`. is_active: the view's. HK_NO_MEMORY: it can only be freed. */
hk_status hk_part_lists_sort(hk_part_lists *, const hk_host *host, const hk_partition *, const hk_tuples *node,
                             const bool *is_active);
void hk_part_lists_free(hk_part_lists *, const hk_host *host);
/* What hk_force.parts has to do. */
void hk_part_lists_touch(const hk_part_lists *, const hk_tuples *node, const hk_part_use *use);

/* Calls body(context, part) for every part p with first[p] < first[p + 1], on all threads: those of a domain in their
 * order, then those across domains, in rounds that share none. What bodies add to the particles of their part has the
 * same bits for any number of threads. */
void hk_parts_each(const hk_host *host, const hk_partition *, const size_t *first,
                   void (*body)(const void *context, size_t part), const void *context);

#endif
