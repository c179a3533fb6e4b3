/* The range of numbers that the colours of a motion stand for. */
#ifndef HK_RANGE_H
#define HK_RANGE_H

#include "plugins/common/colour/scale.h"

/* Chooses low and high for these numbers, which it sorts, without the outermost one per cent at each end: a few extreme
 * values may saturate so that the others differ in colour. `centred`: symmetric about zero. A logarithmic scale is for
 * the positive ones. False: there is no number for it; the range is then 0 to 1, or 1 to 10. */
bool hk_range_choose(hk_scale *, float *number, size_t count, bool centred);

#endif
