/* A picture of several views: a grid of cells of one size. */
#ifndef HK_VIEW_GRID_H
#define HK_VIEW_GRID_H

#include <stdbool.h>
#include <stddef.h>

typedef struct hk_view_grid {
  size_t count;
  int columns, rows;
  int width, height;           /* of a cell, pixels */
  int full_width, full_height; /* of the picture */
} hk_view_grid;

/* As many columns as make cells nearest to 4 by 3; a cell that stays empty counts as much as a cell half as wide as it
 * should be. */
hk_view_grid hk_view_grid_for(size_t count, int width, int height);
/* Copies cell k, 4 bytes a pixel with the bottom row first, into the picture: row by row from the upper left. */
void hk_view_grid_put(const hk_view_grid *, size_t k, const unsigned char *cell, unsigned char *picture);

#endif
