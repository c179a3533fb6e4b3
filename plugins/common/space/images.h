/* Points of a periodic box for a search by cells: each at its place in the box, and behind them the images that lie
 * within a depth of the box, of which rows tell again whose they are. */
#ifndef HK_IMAGES_H
#define HK_IMAGES_H

#include "plugins/common/space/cell_list.h"

typedef struct hk_images {
  size_t n, count; /* points; with their images */
  double *x;       /* count x 3, m */
  uint32_t *of;    /* count: the point that it is an image of; its own number below n */
  size_t room;
} hk_images;

/* Rows of the points x (n x 3, finite) up to `reach`, m: of each i all j != i whose nearest image is closer, rising.
 * The box may have any length. The same for any number of threads. HK_NO_MEMORY: there are no rows. */
hk_status hk_images_rows(hk_images *, hk_cell_list *, const hk_host *, const hk_periodic_box *, const double *x,
                         size_t n, double reach);

#endif
