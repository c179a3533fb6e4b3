/* Colours for numbers and groups, as red, green, blue, 255. */
#ifndef HK_COLORMAP_H
#define HK_COLORMAP_H

#include <stdint.h>

typedef enum hk_colormap {
  HK_MAP_VIRIDIS, /* dark violet, green, yellow */
  HK_MAP_INFERNO, /* black, violet, orange, light yellow */
  HK_MAP_CIVIDIS, /* dark blue, grey, yellow: nearly the same to those who see red and green alike */
  HK_MAP_GREY,
  HK_MAP_FIRE,      /* black, red, yellow, white */
  HK_MAP_DIVERGING, /* blue, light grey, red: for numbers around zero */
  HK_MAPS
} hk_colormap;

#define HK_MAP_NAMES "viridis|inferno|cividis|grey|fire|diverging"

extern const char *const hk_map_names[HK_MAPS]; /* the same */

enum { HK_MAP_SIZE = 512 };

/* Fills the table; entry k is the colour at the place (k + 1/2) / HK_MAP_SIZE, or at its mirror image. */
void hk_colormap_fill(hk_colormap, int reverse, uint8_t table[HK_MAP_SIZE][4]);
/* The colour at `place`, 0..1; places beyond get the colours of the ends, NAN black. */
void hk_colormap_colour(uint8_t (*table)[4], double place, uint8_t colour[4]);
enum { HK_GROUP_COLOURS = 8 };

/* One of these in turn, which are distinguishable for the colour-blind. */
void hk_colormap_group(uint32_t group, uint8_t colour[4]);

#endif
