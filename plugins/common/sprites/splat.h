/* Drawing of single sprites into an image of light. */
#ifndef HK_SPLAT_H
#define HK_SPLAT_H

#include "plugins/common/sprites/sprite.h"
#include "plugins/common/sprites/srgb.h"

/* A rectangle of the picture, row by row from the lowest. A row has four planes: red, green and blue light that comes
 * from the sprites, and the share of what is behind them that is still seen, 1 before the first. */
enum { HK_PLANES = 4 };

typedef struct hk_light_image {
  int left, bottom, width, height; /* pixels */
  float *light;                    /* height x HK_PLANES x width */
  const float *scene;              /* height x width: distance of what else is seen there, m */
} hk_light_image;

/* Draws the rows first <= y < end (counted from the image's lowest) of the sprite, behind those drawn before. */
void hk_splat(const hk_light_image *, const hk_srgb *, const hk_sprite_shading *, const hk_sprite *, int first,
              int end);

#endif
