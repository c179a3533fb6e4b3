/* Another order for a list of springs whose neighbours in the list are not neighbours in space: see edge_order.c. */
#ifndef HK_EDGE_ORDER_H
#define HK_EDGE_ORDER_H

#include "core/plugin.h"

/* Springs and their numbers, as they were given or in memory of the host. */
typedef struct hk_edge_order {
  hk_tuples edges;
  hk_per_tuple k, c, L;
} hk_edge_order;

/* Changes to a better order, where there is one; the numbers are copied with it. `particles`: n. False: no memory, the
 * order is as it was. */
bool hk_edge_order_improve(hk_edge_order *, const hk_host *host, size_t particles);
/* Releases what replaced the lists of `given`. */
void hk_edge_order_release(hk_edge_order *, const hk_host *host, const hk_edge_order *given);

#endif
