/* Collocation at the Gauss-Radau points of Everhart's method of order 15, for x'' = a(x, v, y, t) and y' = f(x, v, y,
 * t).
 *
 * In a step of length h, with s = (time since its begin)/h, slopes are polynomials of degree 7,
 *   a(s) = B_0 + B_1 s + ... + B_7 s^7,
 * which are the forces at s = 0 and at seven nodes, the inner Radau points (roots of (P_7 + P_8)(2s - 1), Abramowitz
 * and Stegun 25.4.31). Positions and velocities follow by integration, in Rein and Spiegel's equations 8 and 9 (2015,
 * MNRAS 446, 1424; their b_j is B_{j+1}): v(s) = v + h s sum B_j s^j/(j+1),   x(s) = x + h s v + h^2 s^2 sum B_j
 * s^j/((j+1)(j+2)), and channels and the work as velocities do. A sweep evaluates the forces at one node after the
 * other, and every one improves the polynomial by Newton's divided differences G_1 .. G_7 (their equations 5 to 7).
 *
 * Slopes are the numbers (a, dy), `length` = size - 3n of them; B holds 8 rows of that length, G 7. */
#ifndef HK_RADAU_H
#define HK_RADAU_H

#include "core/plugin.h"

enum { HK_RADAU_NODES = 7, HK_RADAU_ROWS = HK_RADAU_NODES + 1 };

extern const double hk_radau_node[HK_RADAU_ROWS]; /* 0 first, then s of each node, rising */

/* The state at s = hk_radau_node[k] into `to`, shaped as X, of a step of h from X; `lost`: see hk_radau_finish. Without
 * it the forces of all nodes of a step would be those of a state that is off by the same rounding. */
void hk_radau_place(const double *B, const hk_system *, double h, int k, const double *X, const double *lost,
                    double *to);
/* The same at any s, and the slope there, of which there are `length` numbers. */
void hk_radau_place_at(const double *B, const hk_system *, double h, double s, const double *X, const double *lost,
                       double *to);
double hk_radau_slope(const double *B, size_t length, size_t e, double s); /* number e of the slope at s */
/* Takes the slope found at node k = 1 .. 7 into B and G. */
void hk_radau_refine(double *B, double *G, size_t length, int k, const double *slope);
/* G of the polynomial B. */
void hk_radau_divide(const double *B, size_t length, double *G);
/* Moves X to the end of the step, in compensated sums (Kahan 1965, CACM 8): `lost`, shaped as X, is what rounding took
 * from X so far. */
void hk_radau_finish(const double *B, const hk_system *, double h, double *X, double *lost);
/* What the polynomial `last` of a step before (rows 1 to 7; row 0 is not given) foretells of one that follows it and is
 * q times as long: rows 1 to 7 of B (Rein and Spiegel 2015, equation 13, with the binomial coefficients). */
void hk_radau_foretell(const double *last, size_t length, double q, double *B);

#endif
