/* Sums over the pairs among which a barrier acts: energy, force and blocks. Pairs are evaluated by several threads and
 * summed in their order (barrier_sum.c, barrier_blocks.c). */
#ifndef HK_BARRIER_SUM_H
#define HK_BARRIER_SUM_H

#include "plugins/common/contact/barrier/barrier_contacts.h"

/* J; infinite where two surfaces touch. */
double hk_barrier_energy(hk_barrier_contacts *, const hk_view *view);
/* HK_NOT_FINITE where two surfaces touch: an explicit method's stage may. */
hk_status hk_barrier_add(hk_barrier_contacts *, const hk_view *view, double *F);
/* 16 blocks for each name, in their order. */
void hk_barrier_pattern(const hk_barrier_contacts *, hk_pattern *pattern);
hk_status hk_barrier_jacobian(hk_barrier_contacts *, const hk_view *view, const hk_blocks *into);

#endif
