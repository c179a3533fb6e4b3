/* Products of vectors in space. */
#ifndef HK_VECTOR_H
#define HK_VECTOR_H

static inline double hk_dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* a.b less what their parts along the unit vector n have of it; n = 0: all of it. */
static inline double hk_dot_across(const double n[3], const double a[3], const double b[3]) {
  return hk_dot(a, b) - hk_dot(a, n) * hk_dot(b, n);
}

#endif
