/* Second derivatives of the energy with respect to the sections' angles, added after those of the joints: where angles
 * follow the positions (rod_relaxed.c) and where they are particles (rod_spins.c). */
#ifndef HK_ROD_ANGLES_H
#define HK_ROD_ANGLES_H

#include "plugins/common/rods/rod_set.h"

/* Patterns follow the pattern of the joints, which are counted in `joints`. */
hk_status hk_rod_relaxed_reserve(hk_rods *); /* after hk_rod_rows_build; HK_NO_MEMORY */
void hk_rod_relaxed_pattern(const hk_rods *, hk_pattern *);
void hk_rod_relaxed_subtract(const hk_rods *, size_t joints, const hk_blocks *into);

void hk_rod_spins_pattern(const hk_rods *, hk_pattern *);
void hk_rod_spins_add(const hk_rods *, size_t joints, const hk_blocks *into);

#endif
