/* Colours for numbers and groups, as red, green, blue, 255. */
#ifndef HK_COLORMAP_H
#define HK_COLORMAP_H

#include <stdint.h>

typedef enum hk_colormap {
  HK_MAP_DIVERGING, /* blue, light grey, red: for numbers around zero */
  HK_MAP_SEQUENTIAL /* dark violet to yellow, uniform in lightness */
} hk_colormap;

enum { HK_MAP_SIZE = 512 };

/* Fills the table; entry k is the colour at the fraction (k + 1/2) / HK_MAP_SIZE of the range. */
void hk_colormap_fill(hk_colormap, uint8_t table[HK_MAP_SIZE][4]);
/* The colour of `value` in [low, high]; values beyond the range get the colours of its ends, values that are not finite
 * black. */
void hk_colormap_look(uint8_t (*table)[4], double low, double high, double value, uint8_t colour[4]);
/* One of eight colours in turn, which are distinguishable for the colour-blind. */
void hk_colormap_group(uint32_t group, uint8_t colour[4]);

#endif
