/* Where f = level on an edge from an inside end at t = 0 to an outside end at t = 1, by a bracketed Muller's method
 * (Muller 1956, Mathematical Tables and Other Aids to Computation 10): the zero of the parabola through the ends of the
 * bracket and the end before the last move, which has exactly one there, as the ends differ in sign. */
#ifndef HK_EDGE_ROOT_H
#define HK_EDGE_ROOT_H

#include "core/plugin.h"

/* Between `low`, where f is not below the level, and `high`, where it is; `third` is the end before the last move, NAN
 * at the beginning. Values are f - level. */
typedef struct hk_edge_root {
  double low, high, third, at_low, at_high, at_third; /* t, and the values there */
  double best, at_best;                               /* the nearest to the level up to now */
} hk_edge_root;

/* The part of the way from a to b where a line between their values is 0: a >= 0 > b. */
static inline double hk_zero_between(double a, double b) { return a / (a - b); }

static inline hk_edge_root hk_edge_root_open(double at_low, double at_high, double t) {
  return (hk_edge_root){0, 1, NAN, at_low, at_high, NAN, t, INFINITY};
}

/* f(low + u) = at_low + slope u + bend u (u - width). */
static inline double hk_edge_root_guess(const hk_edge_root *r) {
  double width = r->high - r->low, slope = (r->at_high - r->at_low) / width;
  double bend = ((r->at_third - r->at_low) / (r->third - r->low) - slope) / (r->third - r->high);
  double b = slope - bend * width, root = sqrt(b * b - 4 * bend * r->at_low);
  double t = r->low + (b < 0 ? 2 * r->at_low / (root - b) : -(b + root) / (2 * bend));
  if (!(t >= r->low && t <= r->high)) t = r->low + width * hk_zero_between(r->at_low, r->at_high);
  return t;
}

/* Takes the value at t; returns where to look next. */
static inline double hk_edge_root_move(hk_edge_root *r, double t, double value) {
  if (fabs(value) < fabs(r->at_best)) r->best = t, r->at_best = value;
  if (value >= 0)
    r->third = r->low, r->at_third = r->at_low, r->low = t, r->at_low = value;
  else
    r->third = r->high, r->at_third = r->at_high, r->high = t, r->at_high = value;
  return r->at_low > 0 ? hk_edge_root_guess(r) : r->low;
}

#endif
