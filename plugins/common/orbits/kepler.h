/* Two bodies that attract each other, their relative motion x'' = -mu x/|x|^3, moved along its conic section by any
 * time. In universal variables (Stumpff 1962; Danby 1992, Fundamentals of Celestial Mechanics, 6.9), which need no
 * distinction between ellipses, parabolas and hyperbolas, and none of circles: with r0 = |x|, e = x.v,
 * b = 2 mu/r0 - v^2 and G_k = s^k c_k(b s^2), c_k Stumpff's functions, the time is
 *     h = r0 G_1 + e G_2 + mu G_3,   r = dh/ds = r0 G_0 + e G_1 + mu G_2,
 * which rises with s, and
 *     x' = (1 - mu G_2/r0) x + (h - mu G_3) v,   v' = -mu G_1/(r r0) x + (1 - mu G_2/r) v.
 * Rein and Tamayo 2015, MNRAS 452, section 2, have how to do that without a bias in the rounding. */
#ifndef HK_KEPLER_H
#define HK_KEPLER_H

#include <stdbool.h>

/* mu: G (m_1 + m_2), m^3/s^2, at least 0 (straight lines); h: s, of either sign; x: m, v: m/s. The error is some
 * roundings of x and v, and of the phase. False: x is 0, or the result is not finite, and x and v are as they were. */
bool hk_kepler_move(double mu, double h, double x[3], double v[3]);

/* c_k(z) = 1/k! - z/(k + 2)! + z^2/(k + 4)! - ..., k = 0 to 3, of any finite z. */
void hk_stumpff(double z, double c[4]);

#endif
