/* The canvas of a picture: a multisampled frame buffer, and its conversion to bytes. Needs a current context. */
#ifndef HK_CANVAS_H
#define HK_CANVAS_H

#include <stdbool.h>

typedef struct hk_canvas {
  int width, height;
  unsigned target[3]; /* frame buffers: drawn on, kept (both many samples a pixel), resolved (one sample a pixel) */
  unsigned buffer[6]; /* their render buffers: colour and depth of each */
} hk_canvas;

/* False when the driver has no memory for this size; the canvas can then only be closed. */
bool hk_canvas_open(hk_canvas *, int width, int height);
void hk_canvas_close(hk_canvas *);
void hk_canvas_use(const hk_canvas *);        /* directs drawing to the canvas */
unsigned hk_canvas_target(const hk_canvas *); /* the frame buffer that is drawn on */
void hk_canvas_keep(const hk_canvas *);       /* stores the present picture, colour and depth ... */
/* ... and restores it in the rectangle whose lower left pixel is (x, y). */
void hk_canvas_restore(const hk_canvas *, int x, int y, int width, int height);
/* Reads this rectangle into its place in a whole picture: 4 bytes a pixel (red, green, blue, 255), the bottom row
 * first.
 */
void hk_canvas_read(const hk_canvas *, int x, int y, int width, int height, unsigned char *rgba);
/* Depths, 0 at the near and 1 at the far plane, of the rectangle whose lower left pixel is (x, y): width x height. */
void hk_canvas_read_depth(const hk_canvas *, int x, int y, int width, int height, float *depth);

#endif
