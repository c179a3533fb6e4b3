/* The pairs that act at some positions, with their energies and derivatives: evaluated once for each state, whatever
 * asks for it, force, energy, blocks or the record of an accepted step. */
#ifndef HK_BARRIER_VALUES_H
#define HK_BARRIER_VALUES_H

#include "plugins/common/barrier/barrier_contacts.h"

/* Makes `acting`, in the order of `near`, those of the positions x. Evaluates nothing where they are already. */
void hk_barrier_values_at(hk_barrier_contacts *, const hk_view *view);
const hk_barrier_value *hk_barrier_acting(const hk_barrier_contacts *, size_t k); /* k < acting_count */

#endif
