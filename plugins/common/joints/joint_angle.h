/* The angle of a joint, in loops that compilers turn into vectors. */
#ifndef HK_JOINT_ANGLE_H
#define HK_JOINT_ANGLE_H

/* atan(t)/t for t^2 = q up to tan(pi/8)^2: interpolated at the roots of Chebyshev's polynomial, to 1.3e-18. */
static inline __attribute__((always_inline)) double hk_atan_part(double q) {
  static const double c[] = {1.0,
                             -0.33333333333333121163,
                             0.19999999999940891462,
                             -0.14285714279250244942,
                             0.11111110744919658237,
                             -0.090908968090640270761,
                             0.076920453309022249521,
                             -0.066629518136291900881,
                             0.058468782973308725201,
                             -0.050351024566015518428,
                             0.037965257453865936236,
                             -0.017805397205419445228};
  double sum = c[11];
  for (int k = 10; k >= 0; k--) sum = sum * q + c[k];
  return sum;
}

/* atan2(y, x), to 2 roundings; 0 at the origin. atan(t) = pi/4 + atan((t - 1)/(t + 1)) keeps t within tan(pi/8). */
static inline __attribute__((always_inline)) double hk_joint_angle(double y, double x) {
  const double pi = 3.14159265358979323846, eighth = 0.41421356237309503;
  double ay = y < 0 ? -y : y, ax = x < 0 ? -x : x, low = ay < ax ? ay : ax, high = ay < ax ? ax : ay;
  bool steep = low > eighth * high;
  double above = steep ? low - high : low, below = steep ? low + high : high, t = above / (below > 0 ? below : 1);
  double a = t * hk_atan_part(t * t) + (steep ? pi / 4 : 0);
  a = ay > ax ? pi / 2 - a : a;
  a = x < 0 ? pi - a : a;
  return y < 0 ? -a : a;
}

#endif
