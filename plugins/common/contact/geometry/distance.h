/* Two kinds of pairs of features by which surfaces come into contact, a point with a triangle and an edge with an edge:
 * how far apart they are, where they are nearest, and the derivatives of the squared distance.
 *
 * A pair is four points x[12], 3 coordinates each, in m:
 *     HK_POINT_TRIANGLE   the point x0; the triangle x1 x2 x3
 *     HK_EDGE_EDGE        the edge x0 x1; the edge x2 x3
 * Its nearest points differ by d = sum_i w_i x_i (that of the first feature minus that of the second; the weights of
 * the first feature sum to 1, those of the second to -1), so that callers need not distinguish the kinds: the gradient
 * of the squared distance by x_i is 2 w_i d, the relative velocity of the nearest points is sum_i w_i v_i, and a force
 * f on the first feature there is w_i f on point i.
 *
 * Degenerate input has an answer as well: edges without length, triangles without area, parallel edges and coincident
 * points give a right distance and one pair of nearest points (of several, the same for the same bits of input).
 * Coordinates are finite and below 1e75 m; lengths below 1e-75 m count as zero. Of coordinates that are not finite
 * nothing is promised but an end: `squared` is infinite or not a number. */
#ifndef HK_DISTANCE_H
#define HK_DISTANCE_H

#include <stdbool.h>
#include <stddef.h>

typedef enum hk_pair_kind { HK_POINT_TRIANGLE, HK_EDGE_EDGE } hk_pair_kind;

typedef struct hk_nearest {
  hk_pair_kind kind;
  unsigned active; /* bit i: the nearest points lie on the part of the feature that x_i spans: an interior, or, with
                    * fewer points, an edge or a corner. Then w_i is not 0 but for rounding; of the others it is 0. */
  double w[4];
  double d[3];    /* m, sum_i w_i x_i */
  double squared; /* m^2, |d|^2: at least the true one, but for rounding */
} hk_nearest;

hk_nearest hk_nearest_of_pair(hk_pair_kind kind, const double x[12]);

/* g[3 i + c] = d(squared)/dx_ic, m. It is continuous but where the nearest points are not unique (parallel edges). */
void hk_distance_gradient(const hk_nearest *, double g[12]);

/* H = d^2 E/dx^2 of an energy E(squared) with the derivatives E1 = dE/d(squared) and E2 = d^2E/d(squared)^2; with 1 and
 * 0 that of the squared distance. 12 x 12, row-major, symmetric, with `active` held: at the border between two sets of
 * active points it jumps, as the true one does. Where the active edges are parallel, or the active triangle has no
 * area, the set is smaller and H is finite. With `definite` its negative eigenvalues are set to 0. */
void hk_distance_energy_hessian(const hk_nearest *, const double x[12], double E1, double E2, bool definite,
                                double H[144]);

/* The factor in [0, 1] by which an energy of an edge-edge pair is multiplied so that it is smooth where the edges
 * become parallel: with c = |(x1 - x0) x (x3 - x2)|^2, m^4, it is (2 - c/limit) c/limit below the limit and 1 from
 * there on (Li and others 2020, section 5 and equation 24, who take limit = 1e-3 |x1 - x0|^2 |x3 - x2|^2 of the shape
 * at rest). limit > 0. The gradient g, m^-1, and the Hessian H, 12 x 12, may be NULL. */
double hk_edge_mollifier(const double x[12], double limit, double g[12], double H[144]);

#endif
