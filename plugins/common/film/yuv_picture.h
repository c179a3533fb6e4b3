/* A picture as films have it, three planes of 8 bits after ITU-R BT.601-7, 2.5: with red, green and blue R, G, B of
 * 0..255 Y  = 16 + 219/255 (0.299 R + 0.587 G + 0.114 B), Cb = 128 + 224/255 (B - L)/1.772,    Cr = 128 + 224/255 (R -
 * L)/1.402,    L the sum in brackets of Y, Y for each pixel and Cb and Cr for the mean of 2 x 2 of them, each right to
 * 0.51. */
#ifndef HK_YUV_PICTURE_H
#define HK_YUV_PICTURE_H

#include <stddef.h>

/* Bytes of width x height pixels, both even. */
static inline size_t hk_yuv_size(int width, int height) { return (size_t)width * (size_t)height * 3 / 2; }
/* rgba: width x height, 4 bytes each, of which the first three are used, the bottom row first. into: Y, the top row
 * first, then Cb, then Cr. lanes: hk_host.lanes. */
void hk_yuv_picture(int lanes, int width, int height, const unsigned char *rgba, unsigned char *into);

#endif
