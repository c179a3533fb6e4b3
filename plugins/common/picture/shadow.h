/* The soft shadow on the floor. */
#ifndef HK_SHADOW_H
#define HK_SHADOW_H

#include "plugins/common/picture/painter.h"

/* Fills the painter's `shade` (0 light, 255 dark) with the shadow of its triangles, tubes and beads; `key` points to
 * the light. `patch`: the square on the floor that the texels cover, centre x, y and half side. */
void hk_shadow_cast(hk_painter *, const hk_view_setup *setup, const double key[3], float patch[3]);

#endif
