/* Another order for a list of springs whose neighbours in the list are not neighbours in space: see edge_order.c. */
#ifndef HK_EDGE_ORDER_H
#define HK_EDGE_ORDER_H

#include "core/plugin.h"

/* Springs and their numbers, as they were given or in memory of the host. */
typedef struct hk_edge_order {
  hk_tuples edges;
  hk_per_tuple k, c, L;
} hk_edge_order;

enum {
  HK_RUN_MIN = 16, /* places: the call costs more than shorter runs save */
  HK_RUN_GAP = 8   /* places without a spring that a run goes on over: a vector's */
};

/* How many of the springs order[0], order[1], ... form a run (i+t, j+t) with rising t that begins with the first; with
 * the places without a spring it has *places. No gap is longer than what is before it, and two thirds of the places
 * have a spring: a place takes half the time of a spring in a list. */
size_t hk_edge_run(const hk_tuples *edges, const uint32_t *order, size_t count, size_t *places);

/* Changes to a better order, where there is one; the numbers are copied with it. `particles`: n. False: no memory, the
 * order is as it was. */
bool hk_edge_order_improve(hk_edge_order *, const hk_host *host, size_t particles);
/* Releases what replaced the lists of `given`. */
void hk_edge_order_release(hk_edge_order *, const hk_host *host, const hk_edge_order *given);

#endif
