/* How far a point has gone along a direction of a body: the way of the points a, b, c, d is
 *     s = (b - a).(d - c)/l,
 * in m, with l the distance of c and d at the start. Of a body that has c and d it is how far b is from a along its
 * direction c d; where a and b are at one distance too, l cos of the angle between two directions. Haug, Computer Aided
 * Kinematics and Dynamics of Mechanical Systems I (1989), section 9.4: the products dot-1 and dot-2. */
#ifndef HK_WAY_H
#define HK_WAY_H

#include "core/plugin.h"

/* By x (n x 3, m), or how fast it changes by x and v. `point`: a, b, c, d. */
double hk_way(const double *x, const uint32_t point[4], double l);
double hk_way_rate(const double *x, const double *v, const uint32_t point[4], double l);
/* v.H v with H the Hessian, which is constant: 2 (v_b - v_a).(v_d - v_c)/l. */
double hk_way_bend(const double *v, const uint32_t point[4], double l);
void hk_way_gradient(const double *x, const uint32_t point[4], double l, double gradient[4][3]);
void hk_way_hessian(double l, double *H); /* 12 x 12 by rows, 1/m */
/* Fills l where the script has not given it; HK_BAD_PARAM names a pair without a direction. */
hk_status hk_way_lengths(const hk_view *view, const hk_tuples *points, hk_per_tuple *l);

#endif
