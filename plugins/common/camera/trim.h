/* What of a motion the picture may leave out: few particles far from all others would make those small. */
#ifndef HK_TRIM_H
#define HK_TRIM_H

#include "plugins/common/snapshot/point_sample.h"
#include "plugins/common/camera/camera.h"

/* Shrinks the box so that beyond each of its sides is no more than this share of the points, when that makes its
 * diagonal at least a fifth shorter; otherwise returns false and changes nothing. `scratch`: HK_SAMPLES numbers. */
bool hk_trim_box(const hk_point_sample *, double share, float *scratch, double low[3], double high[3]);
/* Adds to the fit all points but this share beyond each side of the picture. */
void hk_trim_fit(const hk_point_sample *, double share, double radius, float *scratch, hk_fit *);

#endif
