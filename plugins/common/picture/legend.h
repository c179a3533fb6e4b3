/* The colour bar with its numbers, as strokes for the painter; text in a plain stroke font. */
#ifndef HK_LEGEND_H
#define HK_LEGEND_H

#include "plugins/common/colour/colormap.h"
#include "plugins/common/colour/scale.h"
#include "plugins/common/picture/painter.h"

typedef struct hk_legend {
  const char *label;
  hk_scale scale;
  uint8_t (*table)[4];
  bool light; /* text for a dark background */
  /* Numbers lie beyond the low and the high end: the bar is pointed there, in the colour that they have. */
  bool beyond[2];
} hk_legend;

/* Draws a view's name over the painter's picture, at its upper left, unless it is too small. */
void hk_legend_name(hk_painter *, const char *name, bool light);
/* Pixels from the lower edge of the picture that the legend takes, with a margin above it; 0: it would not be drawn. */
int hk_legend_height(const hk_painter *);
/* Draws over the painter's picture, at its lower left. Does nothing when the picture is too small. */
void hk_legend_draw(hk_painter *, const hk_legend *);

#endif
