/* The order of pairs: by kind, and then by their particles. */
#ifndef HK_PAIR_ORDER_H
#define HK_PAIR_ORDER_H

#include "plugins/common/contact/surfaces/surfaces.h"

typedef struct hk_pair_sorter {
  hk_array start; /* uint32_t: where each bucket begins; scratch */
  hk_array order; /* uint32_t: positions in the list; scratch */
  hk_array spare; /* uint32_t; scratch */
} hk_pair_sorter;

/* Of `count` pairs of n particles: `order` holds their positions, rising, one of each that is there more than once;
 * *kept is their number. HK_NO_MEMORY. */
hk_status hk_pairs_sort(hk_pair_sorter *, const hk_host *, const hk_feature_pair *, size_t count, size_t n,
                        size_t *kept);

#endif
