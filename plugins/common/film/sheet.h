/* Stills of a film side by side in one picture, evenly spaced in time, the first and the last among them. */
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
  unsigned char *rgba;       /* out_width x out_height x 4, the bottom row first */
  size_t taken;
} hk_sheet;

/* For so many stills, or all where there are fewer pictures than that; pictures have this size. The sheet is about as
 * wide as one of them. HK_NO_MEMORY. */
hk_status hk_sheet_open(hk_sheet *, const hk_host *, size_t count, size_t frames, int width, int height);
/* Takes picture k, 4 bytes a pixel with the bottom row first, if it is one of the stills. In the order of time. */
void hk_sheet_take(hk_sheet *, size_t k, const unsigned char *rgba);
/* HK_IO. */
hk_status hk_sheet_write(const hk_sheet *, const char *name);
void hk_sheet_free(hk_sheet *);

#endif
