/* Sprites by the bands of rows that they reach, so that several threads can draw at once and every pixel still sees its
 * sprites in one order. */
#ifndef HK_BANDS_H
#define HK_BANDS_H

#include "core/plugin.h"
#include "plugins/common/sprites/sprite.h"

enum { HK_BAND_ROWS = 16 };

typedef struct hk_bands {
  size_t count;
  size_t *start;  /* count + 1 */
  uint32_t *item; /* start[count]: of each band the numbers of its sprites, in the order given */
  size_t room, item_room;
} hk_bands;

/* Sorts sprite[order[0..listed)] into the bands of the rows bottom <= y < bottom + height. HK_NO_MEMORY. */
hk_status hk_bands_fill(hk_bands *, const hk_host *, const hk_sprite *sprite, const uint32_t *order, size_t listed,
                        int bottom, int height);
void hk_bands_free(hk_bands *, const hk_host *);

#endif
