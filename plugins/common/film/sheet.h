/* Stills of a film side by side in one picture, evenly spaced in time, the first and the last among them; below them a
 * strip for what they have in common. */
#ifndef HK_SHEET_H
#define HK_SHEET_H

#include "core/plugin.h"

typedef struct hk_sheet { /* a zeroed one is empty */
  const hk_host *host;
  size_t count, frames; /* stills; pictures of the film */
  int columns, rows;
  int width, height;         /* of a still, pixels */
  int full_width;            /* of a picture */
  int out_width, out_height; /* of the sheet */
  int strip;                 /* height, pixels; 0: there is none */
  unsigned char *rgba;       /* out_width x out_height x 4, the bottom row first */
  size_t taken;
} hk_sheet;

/* For so many stills, or all where there are fewer pictures than that; pictures have this size. The sheet is about as
 * wide as one of them. HK_NO_MEMORY. */
hk_status hk_sheet_open(hk_sheet *, const hk_host *, size_t count, size_t frames, int width, int height, int strip);
/* Whether picture k is the next of the stills. */
bool hk_sheet_wants(const hk_sheet *, size_t k);
/* Takes it, 4 bytes a pixel with the bottom row first. */
void hk_sheet_take(hk_sheet *, const unsigned char *rgba);
/* Fills the strip with the lowest rows of a picture of this width, whose last column goes on to the sheet's end. */
void hk_sheet_fill_strip(hk_sheet *, const unsigned char *rgba, int width);
/* HK_IO. */
hk_status hk_sheet_write(const hk_sheet *, const char *name);
void hk_sheet_free(hk_sheet *);

#endif
