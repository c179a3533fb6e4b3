/* The particles that a liquid or a gas on a grid carries. */
#ifndef HK_CARRIED_H
#define HK_CARRIED_H

#include "core/plugin.h"

/* Fills index (n + 1) and *count: of the listed particles, or where none are listed of all that are in no edge or
 * triangle of the scene, those that move freely; without those in `without` (NULL: none) and those inside of elements.
 * HK_BAD_PARAM: one slides on a pin, of which the grid knows nothing; HK_NO_MEMORY; with a message. */
hk_status hk_carried_find(const hk_host *, const hk_view *, const hk_tuples *listed, const hk_tuples *without,
                          uint32_t *index, size_t *count);

#endif
