/* Stills of a film side by side in one picture, evenly spaced in time, the first and the last among them; below them a
 * footer for what they have in common. */
#ifndef HK_CONTACT_SHEET_H
#define HK_CONTACT_SHEET_H

#include "core/plugin.h"

typedef struct hk_contact_sheet { /* a zeroed one is empty */
  const hk_host *host;
  size_t count, frames; /* stills; pictures of the film */
  int columns, rows;
  int width, height;         /* of a still, pixels */
  int full_width;            /* of a picture */
  int out_width, out_height; /* of the sheet */
  int footer;                /* height, pixels; 0: there is none */
  unsigned char *rgba;       /* out_width x out_height x 4, the bottom row first */
  size_t taken;
} hk_contact_sheet;

/* For `count` stills out of `frames` pictures of width x height pixels, for all of them where there are fewer. The
 * sheet is about as wide as one picture. HK_NO_MEMORY. */
hk_status hk_contact_sheet_open(hk_contact_sheet *, const hk_host *, size_t count, size_t frames, int width, int height,
                                int footer);
/* Whether picture k is the next of the stills. */
bool hk_contact_sheet_wants(const hk_contact_sheet *, size_t k);
/* Takes it, 4 bytes a pixel with the bottom row first. */
void hk_contact_sheet_take(hk_contact_sheet *, const unsigned char *rgba);
/* Fills the footer with the lowest rows of a picture of this width, whose last column goes on to the sheet's end. */
void hk_contact_sheet_fill_footer(hk_contact_sheet *, const unsigned char *rgba, int width);
/* HK_IO. */
hk_status hk_contact_sheet_write(const hk_contact_sheet *, const char *name);
void hk_contact_sheet_free(hk_contact_sheet *);

#endif
