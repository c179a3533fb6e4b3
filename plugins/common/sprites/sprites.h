/* Draws particles over a finished picture, on the processor: of many small ones it draws several times as many a second
 * as OpenGL in software, with light that adds up beyond the eight bits of a frame buffer. The bytes do not depend on
 * the number of threads. */
#ifndef HK_SPRITES_H
#define HK_SPRITES_H

#include "plugins/common/sprites/bands.h"
#include "plugins/common/sprites/projection.h"
#include "plugins/common/sprites/splat.h"

typedef struct hk_sprites {
  const hk_host *host;
  hk_srgb srgb;
  hk_sprite *sprite;
  uint32_t *order, *scratch; /* room, 3 room */
  size_t room, count, listed;
  hk_light_image image; /* the rectangle that holds all sprites; empty when none is visible */
  float *distance;      /* image.scene, to be filled by the caller between the two calls */
  size_t pixel_room;
  hk_bands bands;
} hk_sprites;

void hk_sprites_open(hk_sprites *, const hk_host *host);
void hk_sprites_close(hk_sprites *); /* a zeroed one is allowed */
/* Finds where the points are on the picture: `image` says of which pixels `distance` is needed. HK_NO_MEMORY. */
hk_status hk_sprites_place(hk_sprites *, const hk_lens *, const hk_sprite_shading *, int width, int height,
                           const hk_point_sprite *point, size_t count);
/* Draws what was placed over the picture, `width` pixels wide with 4 bytes each, the bottom row first. */
void hk_sprites_draw(hk_sprites *, const hk_sprite_shading *, unsigned char *rgba, int width);
/* The light that this share of the pixels that shine at all do not exceed, of what was placed, with nothing before it;
 * 0: none does. Overwrites `distance`. */
double hk_sprites_level(hk_sprites *, const hk_sprite_shading *, double share);

#endif
