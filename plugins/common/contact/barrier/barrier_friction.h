/* Coulomb friction of a barrier's contacts, smoothed below a speed (Li and others 2020, Incremental Potential Contact,
 * section 5, equation 15): with the normal n, the weights w of the nearest points and the normal force l, all of the
 * present positions, and u = sum_i w_i v_i less its part along n,
 *     F_i = -w_i mu l f(|u|/e) u/|u|,   f(y) = 2y - y^2 below 1, 1 above.
 * The paper takes n, w and l from the step before and repeats the step until they agree. Here they are part of the
 * equation that a step solves, so that what slides loses mu times the impulse along the normal, whatever the steps:
 * with l of the step before, a card on a slope of tan 1/2 at mu = 0.4 was 9.4 % off after 30 steps of 1/60 s. It costs
 * the symmetry of -dF/dx; without its unsymmetric terms Newton's method still converges, as l is known once the gap is.
 */
#ifndef HK_BARRIER_FRICTION_H
#define HK_BARRIER_FRICTION_H

#include "plugins/common/contact/barrier/barrier_contacts.h"

typedef struct hk_barrier_friction {
  double coefficient, speed; /* mu; e, m/s */
} hk_barrier_friction;

/* Of the contacts at the positions of the view. The first two return the power, W. */
double hk_friction_add(const hk_barrier_friction *, hk_barrier_contacts *, const hk_view *, double *F);
double hk_friction_power(const hk_barrier_friction *, hk_barrier_contacts *, const hk_view *);
/* Adds D, symmetric and definite, and, where no symmetric or definite blocks are wanted, K, which is unsymmetric. Where
 * definite ones are, D has mu l f/|u| along u as well, the slope of a quadratic that is nowhere below the potential of
 * the friction (Huber 1981, Robust Statistics, 7.8): no step goes beyond where it turns, and searches succeed. */
void hk_friction_blocks(const hk_barrier_friction *, hk_barrier_contacts *, const hk_view *, const hk_blocks *into);

/* ---- the slopes that K is made of ----
 *
 * How what friction depends on, of a contact, changes with the positions of its four points: the weights w of the
 * nearest points, the normal force l = -2 m E' |d|, and the velocity across the normal, u = W - n (n.W), W = sum_i w_i
 * v_i.
 *
 * The nearest points lie at d.d_k = 0, for the directions d_k in which they may move, by which w changes at c_k
 * (geometry/nearest_frame.h). With G_kl = d_k.d_l the parameters of the directions follow a move of the points by
 *     dq = -G^-1 (c_k (x) d + w (x) d_k).dx,   dw = sum_k c_k dq_k,   d(d) = sum_i w_i dx_i + sum_k d_k dq_k. */

/* Derivatives by the 12 coordinates, 3 of each point. */
typedef struct hk_friction_slopes {
  double w[4][12]; /* 1/m */
  double u[3][12]; /* 1/s */
  double load[12]; /* N/m */
} hk_friction_slopes;

/* Of a pair that acts, whose value is that of the positions of the view. */
void hk_friction_slopes_of(const hk_barrier_pair *, const hk_barrier_value *, const hk_view *, hk_friction_slopes *);

#endif
