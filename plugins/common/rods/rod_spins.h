/* Sections whose angles are particles (Bergou and others 2008 with the twist as a degree of freedom): the blocks of
 * their second derivatives. */
#ifndef HK_ROD_SPINS_H
#define HK_ROD_SPINS_H

#include "plugins/common/rods/rod_set.h"

enum { HK_ROD_SPIN_BLOCKS = 16 }; /* for each joint */

/* After the pattern of the joints, which are counted in `joints`. */
void hk_rod_spins_pattern(const hk_rods *, hk_pattern *);
void hk_rod_spins_add(const hk_rods *, size_t joints, const hk_blocks *into);

#endif
