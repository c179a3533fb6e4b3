/* The shadows of the key light. */
#ifndef HK_SHADOW_H
#define HK_SHADOW_H

#include "plugins/common/picture/painter.h"

/* Casts the shadows of the painter's triangles, tubes and points into its map, for the light from direction `key`. */
void hk_shadow_cast(hk_painter *, const hk_view_setup *setup, const double key[3]);
/* Fills the painter's `shade` (0 light, 255 dark) with the soft shadow on the floor, from the map. */
void hk_shadow_shade(hk_painter *, const hk_view_setup *setup);

#endif
