/* The colour bar with its numbers, as strokes for the painter; text in a plain stroke font. */
#ifndef HK_LEGEND_H
#define HK_LEGEND_H

#include "plugins/common/picture/colormap.h"
#include "plugins/common/picture/painter.h"

typedef struct hk_legend {
  const char *label;
  double low, high; /* values at the bar's ends */
  uint8_t (*table)[4];
} hk_legend;

/* Draws over the painter's picture, at its lower left. Does nothing when the picture is too small. */
void hk_legend_draw(hk_painter *, const hk_legend *);

#endif
