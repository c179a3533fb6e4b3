/* Where a picture differs from its surroundings. */
#ifndef HK_PAINTED_H
#define HK_PAINTED_H

#include "plugins/common/picture/painter.h"

/* Around the painter's triangles and tubes; around the shadow on the floor, its `shade`. */
hk_patch hk_things_patch(const hk_painter *, const hk_view_setup *setup, const hk_lens *);
hk_patch hk_shadow_patch(const hk_painter *, const hk_lens *);

#endif
