/* The second derivatives of rods' energy, with the sections' angles as they are. */
#ifndef HK_ROD_BLOCKS_H
#define HK_ROD_BLOCKS_H

#include "plugins/common/rods/rod_set.h"

void hk_rod_blocks_pattern(const hk_rods *, hk_pattern *);
/* At the state of the last hk_rods_evaluate. `definite`: without the terms that may be negative. */
void hk_rod_blocks_add(const hk_rods *, const hk_host *, const hk_blocks *into);
/* As hk_force.stiffness_bound, of all of K or of D. */
void hk_rod_blocks_bound(const hk_rods *, const hk_view *, hk_stiffness_part, double (*block)[6]);

#endif
