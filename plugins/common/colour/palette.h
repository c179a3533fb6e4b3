/* The colours of things that stand for no number: of pictures and of pages, which get them as data. */
#ifndef HK_PALETTE_H
#define HK_PALETTE_H

#include <stdint.h>

typedef enum hk_palette_entry {
  HK_PALETTE_PLAIN,  /* particles, springs and cloth */
  HK_PALETTE_SECOND, /* those of the second of two runs */
  HK_PALETTE_PIN,
  HK_PALETTE_HELD, /* pins of pages, where they are larger and are to be found */
  HK_PALETTE_BODY, /* what particles bounce off */
  HK_PALETTE_BODY_AT_NIGHT,
  HK_PALETTE_PLANE,
  HK_PALETTE_PLANE_AT_NIGHT,
  HK_PALETTE_WIND, /* arrows */
  HK_PALETTE_CONTACT,
  HK_PALETTE_PICKED, /* the particle that somebody has chosen */
  HK_PALETTE_ARROW,
  HK_PALETTE_SIZE
} hk_palette_entry;

extern const char *const hk_palette_names[HK_PALETTE_SIZE];
extern const uint8_t hk_palette_colours[HK_PALETTE_SIZE][4]; /* red, green, blue, 255 */

#endif
