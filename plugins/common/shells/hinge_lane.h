/* One hinge in loops over many that compilers turn into vectors, and by itself: the same operations, so the same bits.
 * With e = b - a, p = c - a, q = d - a and the normals m = e x p, n = q x e, both of twice the area of their triangle,
 * m x n = -(m.q) e, so that
 *     angle = atan2(-|e| m.q, m.n),
 * which is exact to rounding for all angles, small ones and those near pi included. Of the gradient,
 *     g_c = -|e| m/|m|^2,   g_d = -|e| n/|n|^2:
 * moving c along its normal turns its triangle about the edge with the lever of its height |m|/|e|. a and b balance
 * force and moment: with the feet s = p.e/|e|^2 and t = q.e/|e|^2
 *     g_b = -s g_c - t g_d,   g_a = -(1 - s) g_c - (1 - t) g_d. */
#ifndef HK_HINGE_LANE_H
#define HK_HINGE_LANE_H

#include "plugins/common/joints/joint_angle.h"

#include <math.h>
#include <stdbool.h>

#define HK_HINGE_INLINE static inline __attribute__((always_inline))

/* Height over edge length, squared, at which a triangle counts as one without area: the normal of a thinner one is
 * known to four digits or fewer, from differences of coordinates as long as the edge. */
#define HK_HINGE_THIN 1e-24

typedef struct hk_hinge_lane {
  double m[3], n[3];
  double ee, mm, nn; /* squares of e, m, n; of a hinge without area 1 in their place */
  double length;     /* |e| */
  double s, t;       /* feet */
  bool fine;         /* both triangles have an area */
} hk_hinge_lane;

HK_HINGE_INLINE double hk_hinge_dot(const double a[3], const double b[3]) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

HK_HINGE_INLINE hk_hinge_lane hk_hinge_measure(const double e[3], const double p[3], const double q[3]) {
  hk_hinge_lane h = {.m = {e[1] * p[2] - e[2] * p[1], e[2] * p[0] - e[0] * p[2], e[0] * p[1] - e[1] * p[0]},
                     .n = {q[1] * e[2] - q[2] * e[1], q[2] * e[0] - q[0] * e[2], q[0] * e[1] - q[1] * e[0]}};
  double ee = hk_hinge_dot(e, e), mm = hk_hinge_dot(h.m, h.m), nn = hk_hinge_dot(h.n, h.n),
         least = HK_HINGE_THIN * ee * ee;
  h.fine = (mm > least) & (nn > least);
  h.ee = h.fine ? ee : 1, h.mm = h.fine ? mm : 1, h.nn = h.fine ? nn : 1;
  h.length = sqrt(h.ee);
  h.s = hk_hinge_dot(p, e) / h.ee, h.t = hk_hinge_dot(q, e) / h.ee;
  return h;
}

HK_HINGE_INLINE double hk_hinge_lane_angle(const hk_hinge_lane *h, const double q[3]) {
  return hk_joint_angle(-h->length * hk_hinge_dot(h->m, q), hk_hinge_dot(h->m, h->n));
}

/* The angle plus the multiple of 2 pi that is nearest to `near`, of less than 2^51 turns. */
HK_HINGE_INLINE double hk_hinge_unwrap(double angle, double near) {
  const double turn = 6.283185307179586, round = 6755399441055744.; /* 1.5 2^52: adding it rounds to integers */
  return angle + turn * (((near - angle) / turn + round) - round);
}

#endif
