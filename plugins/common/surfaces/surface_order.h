/* The order of pairs: by kind, and then by their particles. */
#ifndef HK_SURFACE_ORDER_H
#define HK_SURFACE_ORDER_H

#include "plugins/common/surfaces/surfaces.h"

int hk_surface_order(const hk_surface_pair *, const hk_surface_pair *); /* as strcmp */

typedef struct hk_surface_sorter {
  hk_array start; /* uint32_t: where each bucket begins; scratch */
  hk_array order; /* uint32_t: positions in the list; scratch */
  hk_array spare; /* uint32_t; scratch */
} hk_surface_sorter;

/* Of `count` pairs of n particles: `order` holds their positions, rising, one of each that is there more than once;
 * *kept is their number. HK_NO_MEMORY. */
hk_status hk_surface_sort(hk_surface_sorter *, const hk_host *, const hk_surface_pair *, size_t count, size_t n,
                          size_t *kept);

#endif
