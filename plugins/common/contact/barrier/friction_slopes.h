/* How what friction depends on, of a contact, changes with the positions of its four points: the weights w of the
 * nearest points, the normal force l = -2 m E' |d|, and the velocity across the normal, u = W - n (n.W), W = sum_i w_i
 * v_i.
 *
 * The nearest points lie at d.d_k = 0, for the directions d_k in which they may move, by which w changes at c_k
 * (geometry/nearest_frame.h). With G_kl = d_k.d_l the parameters of the directions follow a move of the points by
 *     dq = -G^-1 (c_k (x) d + w (x) d_k).dx,   dw = sum_k c_k dq_k,   d(d) = sum_i w_i dx_i + sum_k d_k dq_k. */
#ifndef HK_FRICTION_SLOPES_H
#define HK_FRICTION_SLOPES_H

#include "plugins/common/contact/barrier/barrier_pair.h"

/* Derivatives by the 12 coordinates, 3 of each point. */
typedef struct hk_friction_slopes {
  double w[4][12]; /* 1/m */
  double u[3][12]; /* 1/s */
  double load[12]; /* N/m */
} hk_friction_slopes;

/* Of a pair that acts, whose value is that of the positions of the view. */
void hk_friction_slopes_of(const hk_barrier_pair *, const hk_barrier_value *, const hk_view *, hk_friction_slopes *);

#endif
