/* Curves that begin where the border of one surface passes through the other and end where the border of the other
 * passes through the one cut neither, by a little: on each surface they end in a triangle near its border. Such a curve
 * is prolonged on both to the nearest border. */
#ifndef HK_PROLONG_H
#define HK_PROLONG_H

#include "plugins/common/contact/untangling/contours.h"

typedef struct hk_prolong {
  uint32_t (*side)[3];    /* triangles: their edges */
  uint32_t *from, *queue; /* triangles: the edge by which one was reached; those reached */
  uint32_t *depth;        /* triangles: how many edges from the start, from 1; 0: not reached */
  uint32_t *barred;       /* edges: the curve that crosses it, counted from 1 */
  size_t reached, triangle_room[4], edge_room;
} hk_prolong;

/* Fills `beyond` of the curves, and what they cut. HK_NO_MEMORY. */
hk_status hk_contours_prolong(hk_prolong *, hk_contours *, const hk_host *, const hk_surface_mesh *);
void hk_prolong_free(hk_prolong *, const hk_host *);

#endif
