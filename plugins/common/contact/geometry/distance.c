/* Nearest points: those of the lines, or of the point and the plane, where they lie within both features; otherwise the
 * best of the pairs of a corner and an edge, which no degeneracy harms. Both are the point of a plane, b e + c f, that
 * is nearest to a point r: with the normal n = e x f, b = (r x f).n/|n|^2 and c = (e x r).n/|n|^2. Of a triangle e and
 * f are two sides, of two edges e is one and f the other, for all differences of their points. */
#include "plugins/common/contact/geometry/distance.h"
#include "plugins/kit/vector3.h"

#include <string.h>

/* The squared sine of the angle between two edges below which their common normal is nothing but rounding: it is known
 * to 1e-16 over that sine. */
static const double NO_NORMAL = 1e-28;
/* Up to here a nearest point may be so far off along the edges that corners are compared with it. */
static const double POOR_NORMAL = 1e-12;
/* Weights are off by 1e-16 over the sine. Below this square of it one is computed anew from the other, so that d is at
 * right angles to one edge: then its length is off by no more than 1e-16 of the lengths of the pair. */
static const double GOOD_NORMAL = 1e-2;

/* A corner and an edge, by their row in the table of pairs of a kind, and the nearest point at s on the edge. */
typedef struct corner {
  int row;
  double s, squared;
} corner;

typedef unsigned char row_of_corner[3];
static const row_of_corner triangle_rows[3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}},
                           edge_rows[4] = {{0, 2, 3}, {1, 2, 3}, {2, 0, 1}, {3, 0, 1}};

/* From a corner, r from the edge's first point, to the edge e. Without branches, as which row is the best is random,
 * and inlined, so that r and e stay in registers: together half of the time. */
static inline __attribute__((always_inline)) void try_corner(corner *best, const double r[3], const double e[3],
                                                             int row) {
  double s = hk_dot(r, e) / hk_dot(e, e), d[3]; /* of an edge without length not a number: 0 */
  s = s > 0 ? s : 0;
  s = s < 1 ? s : 1;
  for (int c = 0; c < 3; c++) d[c] = r[c] - s * e[c];
  double squared = hk_dot(d, d);
  bool nearer = squared < best->squared;
  best->row = nearer ? row : best->row;
  best->s = nearer ? s : best->s;
  best->squared = nearer ? squared : best->squared;
}

static void keep_corner(hk_nearest *best, const double *x, const row_of_corner *rows, const corner *c) {
  if (!(c->squared < best->squared)) return;
  int i = rows[c->row][0], j = rows[c->row][1], k = rows[c->row][2];
  double s = c->s, sign = best->kind == HK_POINT_TRIANGLE || i < 2 ? 1 : -1;
  best->active = 1U << i | (unsigned)(s < 1) << j | (unsigned)(s > 0) << k;
  best->squared = c->squared;
  memset(best->w, 0, sizeof best->w);
  best->w[i] = sign, best->w[j] = -sign * (1 - s), best->w[k] = -sign * s;
  for (int m = 0; m < 3; m++) {
    double from = x[3 * j + m];
    best->d[m] = sign * (x[3 * i + m] - from - s * (x[3 * k + m] - from));
  }
}

/* A point r, and that nearest to it of a plane, b e + c f. */
typedef struct plane {
  double r[3], e[3], f[3];
  double b, c;
  bool poor; /* POOR_NORMAL */
} plane;

/* Whether e and f span a plane: then b and c. */
static inline __attribute__((always_inline)) bool nearest_in_plane(plane *p) {
  double n[3], m[3], ee = hk_dot(p->e, p->e), size = ee * hk_dot(p->f, p->f);
  hk_cross(n, p->e, p->f);
  double nn = hk_dot(n, n);
  p->poor = !(nn > POOR_NORMAL * size);
  if (!(nn > NO_NORMAL * size)) return false;
  hk_cross(m, p->r, p->f);
  p->b = hk_dot(m, n) / nn;
  hk_cross(m, p->e, p->r);
  p->c = hk_dot(m, n) / nn;
  if (nn < GOOD_NORMAL * size) p->b = (hk_dot(p->r, p->e) - p->c * hk_dot(p->f, p->e)) / ee;
  return true;
}

/* The interior of both features, with these weights. */
static void keep_interior(hk_nearest *best, const plane *p, double w0, double w1, double w2, double w3) {
  best->active = 15;
  best->w[0] = w0, best->w[1] = w1, best->w[2] = w2, best->w[3] = w3;
  for (int k = 0; k < 3; k++) best->d[k] = p->r[k] - p->b * p->e[k] - p->c * p->f[k];
  best->squared = hk_dot(best->d, best->d);
}

static hk_nearest point_triangle(const double *x) {
  plane p;
  hk_nearest best = {.kind = HK_POINT_TRIANGLE, .squared = INFINITY};
  hk_subtract(p.r, x, x + 3);
  hk_subtract(p.e, x + 6, x + 3);
  hk_subtract(p.f, x + 9, x + 3);
  if (nearest_in_plane(&p) && p.b > 0 && p.c > 0 && 1 - p.b - p.c > 0) {
    keep_interior(&best, &p, 1, -(1 - p.b - p.c), -p.b, -p.c);
    if (!p.poor) return best;
  }
  corner near = {.squared = INFINITY};
  double second[3], last[3];
  hk_subtract(second, x, x + 6);
  hk_subtract(last, x + 9, x + 6);
  try_corner(&near, p.r, p.e, 0);
  try_corner(&near, p.r, p.f, 1);
  try_corner(&near, second, last, 2);
  keep_corner(&best, x, triangle_rows, &near);
  return best;
}

/* With the first edge reversed d = x0 - x2 - b (x0 - x1) - c (x3 - x2). */
static hk_nearest edge_edge(const double *x) {
  plane p;
  hk_nearest best = {.kind = HK_EDGE_EDGE, .squared = INFINITY};
  hk_subtract(p.r, x, x + 6);
  hk_subtract(p.e, x, x + 3);
  hk_subtract(p.f, x + 9, x + 6);
  if (nearest_in_plane(&p) && p.b > 0 && p.b < 1 && p.c > 0 && p.c < 1) {
    keep_interior(&best, &p, 1 - p.b, p.b, -(1 - p.c), -p.c);
    if (!p.poor) return best;
  }
  corner near = {.squared = INFINITY};
  double end[3], back[3], other[3], edge[3];
  hk_subtract(end, x + 3, x + 6);
  hk_subtract(back, x + 6, x);
  hk_subtract(other, x + 9, x);
  hk_subtract(edge, x + 3, x);
  try_corner(&near, p.r, p.f, 0);
  try_corner(&near, end, p.f, 1);
  try_corner(&near, back, edge, 2);
  try_corner(&near, other, edge, 3);
  keep_corner(&best, x, edge_rows, &near);
  return best;
}

hk_nearest hk_nearest_of_pair(hk_pair_kind kind, const double x[12]) {
  return kind == HK_POINT_TRIANGLE ? point_triangle(x) : edge_edge(x);
}

/* By the envelope theorem: at the nearest points |d|^2 does not change with the weights. */
void hk_distance_gradient(const hk_nearest *near, double g[12]) {
  for (int i = 0; i < 4; i++)
    for (int c = 0; c < 3; c++) g[3 * i + c] = 2 * near->w[i] * near->d[c];
}
