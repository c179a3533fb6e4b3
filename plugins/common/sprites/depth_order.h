/* The order in which sprites hide each other. */
#ifndef HK_DEPTH_ORDER_H
#define HK_DEPTH_ORDER_H

#include "plugins/common/sprites/sprite.h"

/* Lists the visible sprites, the nearest first, those of equal depth by number. `order` and `spare` have room for
 * `count` entries each, `key` for twice as many. Returns how many are listed in `order`. */
size_t hk_depth_order(const hk_sprite *sprite, size_t count, uint32_t *order, uint32_t *spare, uint32_t *key);

#endif
