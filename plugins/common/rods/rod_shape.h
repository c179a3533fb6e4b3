/* Joints and rest shapes of rods. */
#ifndef HK_ROD_SHAPE_H
#define HK_ROD_SHAPE_H

#include "plugins/common/rods/rod_set.h"

/* `create` and `topology` of a force of rods. HK_BAD_PARAM, HK_NO_MEMORY. */
hk_status hk_rods_open(hk_rods *, const hk_host *, const hk_view *view);
hk_status hk_rods_follow(hk_rods *, const hk_view *view);

#endif
