/* The directions in which the nearest points of a pair may move, as they are and made orthonormal: what derivatives of
 * the distance are made of (distance_derivatives.c). */
#ifndef HK_NEAREST_FRAME_H
#define HK_NEAREST_FRAME_H

#include "plugins/common/contact/geometry/distance.h"

/* The directions in which the nearest points may move, each from the first active point of a feature to another one: by
 * them w changes by dw[k] and d by dd[k], m, to which d is at right angles. Returns their number; the others are 0. */
int hk_nearest_directions(const hk_nearest *, const double x[12], double dw[2][4], double dd[2][3]);

typedef struct hk_nearest_frame {
  int count;         /* of the directions, 0 to 2 */
  double axis[3][3]; /* orthonormal: that of d; `count` directions; others */
  double dw[2][4];   /* 1/m: how w changes as d moves along a direction; otherwise 0 */
  double distance;   /* m, d along the first axis */
} hk_nearest_frame;

hk_nearest_frame hk_nearest_frame_of(const hk_nearest *, const double x[12]);

#endif
