/* The part of the Hessian by which the sections' angles soften it. */
#ifndef HK_ROD_RELAXED_H
#define HK_ROD_RELAXED_H

#include "plugins/common/rods/rod_set.h"

hk_status hk_rod_relaxed_reserve(hk_rods *); /* after hk_rod_rows_build; HK_NO_MEMORY */
/* After the pattern of the joints, which are counted in `joints`. */
void hk_rod_relaxed_pattern(const hk_rods *, hk_pattern *);
void hk_rod_relaxed_subtract(const hk_rods *, size_t joints, const hk_blocks *into);

#endif
