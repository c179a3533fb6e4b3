/* The solid angle of a plane triangle seen from a point, above 0 where the point is behind it: over closed triangles
 * that face outwards they sum up to 4 pi inside (Van Oosterom and Strackee 1983, "The solid angle of a plane triangle",
 * IEEE Trans. Biomed. Eng. 30, equation 8). */
#ifndef HK_SOLID_ANGLE_H
#define HK_SOLID_ANGLE_H

#include "plugins/kit/vector3.h"

#include <math.h>

#define HK_WHOLE_SOLID_ANGLE 12.566370614359172

/* sr, -2 pi to 2 pi; x: n x 3, m; t: the corners. */
static inline double hk_solid_angle(const double *x, const uint32_t t[3], const double p[3]) {
  double a[3][3], size[3], n[3];
  for (int c = 0; c < 3; c++) {
    hk_subtract(a[c], x + 3 * (size_t)t[c], p);
    size[c] = hk_length(a[c]);
  }
  hk_cross(n, a[1], a[2]);
  double along = size[0] * size[1] * size[2] + hk_dot(a[0], a[1]) * size[2] + hk_dot(a[1], a[2]) * size[0] +
                 hk_dot(a[2], a[0]) * size[1];
  return 2 * atan2(hk_dot(a[0], n), along);
}

#endif
