/* Continuous collision detection: whether, and from when on, a pair of features (distance.h) that moves linearly comes
 * nearer than a gap. Points with radii, capsules and sheets with a thickness are pairs with the sum of their radii, or
 * half thicknesses, as the gap. */
#ifndef HK_CCD_H
#define HK_CCD_H

#include "plugins/common/contact/geometry/distance.h"

/* The points move from x0[12] at t = 0 to x1[12] at t = 1, x(t) = (1 - t) x0 + t x1 in exact arithmetic. gap >= 0, m;
 * tolerance >= 0, m.
 *
 * false: the distance is greater than the gap at all times in [0, 1]. *t is 1.
 * true:  the distance is greater than the gap at all times in [0, *t]; where *t is 0 perhaps not even there. At *t it
 * is at most gap + tolerance, or the bound of the steps that are made was reached first (hk_ccd_cost).
 *
 * The first holds with all rounding errors of this computation counted in, for any finite input: tiny and huge,
 * degenerate, without motion, touching at either end. A pair that is within the gap at the start is a hit at t = 0,
 * also if it separates: who wants to let it go on asks with a gap smaller than its distance. Input that is not finite,
 * or so large that differences overflow, is a hit at t = 0.
 *
 * A tolerance below 2.5e-14 of the largest difference of coordinates (between the two features, at either end) means
 * that one. Steps grow with the logarithm of it: a tenth of the gap, or of the distance at the start, is cheap. Who
 * computes positions at *t rounds them: keep a gap of some units in the last place of the coordinates. */
bool hk_ccd(hk_pair_kind kind, const double x0[12], const double x1[12], double gap, double tolerance, double *t);

/* The same, and what it took, for tests and measurements. */
typedef struct hk_ccd_cost {
  unsigned steps; /* nearest points computed */
  bool gave_up;   /* a hit because the bound of the steps was reached */
} hk_ccd_cost;
bool hk_ccd_counted(hk_pair_kind kind, const double x0[12], const double x1[12], double gap, double tolerance,
                    double *t, hk_ccd_cost *cost);

#endif
