/* Vectors of three numbers. */
#ifndef HK_VECTOR3_H
#define HK_VECTOR3_H

#include <math.h>

static inline double hk_dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

static inline double hk_length(const double a[3]) { return sqrt(hk_dot(a, a)); }

static inline void hk_copy(double to[3], const double a[3]) {
  for (int c = 0; c < 3; c++) to[c] = a[c];
}

static inline void hk_subtract(double to[3], const double a[3], const double b[3]) {
  for (int c = 0; c < 3; c++) to[c] = a[c] - b[c];
}

/* to += s a */
static inline void hk_add_scaled(double to[3], double s, const double a[3]) {
  for (int c = 0; c < 3; c++) to[c] += s * a[c];
}

static inline void hk_cross(double to[3], const double a[3], const double b[3]) {
  double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
  to[0] = x, to[1] = y, to[2] = z;
}

#endif
