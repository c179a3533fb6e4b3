/* Nearest points and derivatives of the squared distance of a pair.
 *
 * Nearest points: those of the lines, or of the point and the plane, where they lie within both features; otherwise the
 * best of the pairs of a corner and an edge, which no degeneracy harms. Both are the point of a plane, b e + c f, that
 * is nearest to a point r: with the normal n = e x f, b = (r x f).n/|n|^2 and c = (e x r).n/|n|^2. Of a triangle e and
 * f are two sides, of two edges e is one and f the other, for all differences of their points.
 *
 * Derivatives: with the parameters q of the active points (none, one or two), d(q) = sum_i w_i(q) x_i is linear in q
 * and |d|^2 is least at d.d_k = 0, where d_k = dd/dq_k. By the envelope theorem the gradient by x_i is 2 w_i d, and
 *     H = 2 (w w^T (x) I - sum_kl (G^-1)_kl u_k u_l^T),
 *     G_kl = d_k.d_l,   u_k = dw/dq_k (x) d + w (x) d_k,
 * one formula for all kinds and sets of active points. */
#include "plugins/common/collision/distance.h"
#include "plugins/common/space/vector3.h"

#include <string.h>

/* The squared sine of the angle between two edges below which their common normal is nothing but rounding: it is known
 * to 1e-16 over that sine. */
static const double NO_NORMAL = 1e-28;
/* Up to here a nearest point may be so far off along the edges that corners are compared with it. */
static const double POOR_NORMAL = 1e-12;
/* Weights are off by 1e-16 over the sine. Below this square of it one is computed anew from the other, so that d is at
 * right angles to one edge: then its length is off by no more than 1e-16 of the lengths of the pair. */
static const double GOOD_NORMAL = 1e-2;

static void keep_nearer(hk_nearest *best, const hk_nearest *other) {
  if (other->squared < best->squared) *best = *other;
}

/* The corner x_i with the edge x_j x_k; `sign`: 1 where the corner belongs to the first feature. */
static void try_corner(hk_nearest *best, const double *x, int i, int j, int k, double sign) {
  double r[3], e[3];
  hk_subtract(r, x + 3 * i, x + 3 * j);
  hk_subtract(e, x + 3 * k, x + 3 * j);
  double ee = hk_dot(e, e), re = hk_dot(r, e), s = re <= 0 ? 0 : re >= ee ? 1 : re / ee;
  hk_nearest n = {.kind = best->kind, .active = 1U << i | (s < 1 ? 1U << j : 0) | (s > 0 ? 1U << k : 0)};
  n.w[i] = sign, n.w[j] = -sign * (1 - s), n.w[k] = -sign * s;
  if (s == 1) hk_subtract(r, x + 3 * i, x + 3 * k);
  for (int c = 0; c < 3; c++) n.d[c] = sign * (s == 1 ? r[c] : r[c] - s * e[c]);
  n.squared = hk_dot(n.d, n.d);
  keep_nearer(best, &n);
}

/* A point r, and that nearest to it of a plane, b e + c f. */
typedef struct plane {
  double r[3], e[3], f[3];
  double b, c;
  bool poor; /* POOR_NORMAL */
} plane;

/* Whether e and f span a plane: then b and c. */
static bool nearest_in_plane(plane *p) {
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
  for (int k = 0; k < 3; k++) try_corner(&best, x, 0, 1 + k, 1 + (k + 1) % 3, 1);
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
  for (int k = 0; k < 2; k++) {
    try_corner(&best, x, k, 2, 3, 1);
    try_corner(&best, x, 2 + k, 0, 1, -1);
  }
  return best;
}

hk_nearest hk_nearest_of_pair(hk_pair_kind kind, const double x[12]) {
  return kind == HK_POINT_TRIANGLE ? point_triangle(x) : edge_edge(x);
}

/* ---- Derivatives ------------------------------------------------------------------------------------------------- */

void hk_distance_gradient(const hk_nearest *near, double g[12]) {
  for (int i = 0; i < 4; i++)
    for (int c = 0; c < 3; c++) g[3 * i + c] = 2 * near->w[i] * near->d[c];
}

/* The directions in which the nearest points may move: from the first active point of a feature to each other one.
 * dw: sign at those two. Returns their number. */
static int directions(const hk_nearest *near, const double *x, double dw[2][4], double d[2][3]) {
  int count = 0, split = near->kind == HK_POINT_TRIANGLE ? 1 : 2, first = -1;
  memset(dw, 0, 8 * sizeof **dw);
  for (int i = 0; i < 4; i++) {
    if (i == split) first = -1;
    if (!(near->active >> i & 1)) continue;
    if (first < 0) {
      first = i;
      continue;
    }
    double sign = i < split ? 1 : -1;
    dw[count][first] = -sign, dw[count][i] = sign;
    for (int c = 0; c < 3; c++) d[count][c] = sign * (x[3 * i + c] - x[3 * first + c]);
    count++;
  }
  return count;
}

/* The inverse of G, or of its only entry. */
static void invert_gram(double d[2][3], int count, double inverse[2][2]) {
  double n[3], a = count > 0 ? hk_dot(d[0], d[0]) : 1, b = 0, c = 1, det = a;
  if (count == 2) {
    hk_cross(n, d[0], d[1]);
    b = hk_dot(d[0], d[1]), c = hk_dot(d[1], d[1]), det = hk_dot(n, n);
  }
  inverse[0][0] = c / det, inverse[1][1] = a / det;
  inverse[0][1] = inverse[1][0] = -b / det;
}

void hk_distance_hessian(const hk_nearest *near, const double x[12], double H[144]) {
  double dw[2][4], d[2][3], inverse[2][2], u[2][12];
  int count = directions(near, x, dw, d);
  invert_gram(d, count, inverse);
  for (int k = 0; k < count; k++)
    for (int i = 0; i < 12; i++) u[k][i] = dw[k][i / 3] * near->d[i % 3] + near->w[i / 3] * d[k][i % 3];
  for (int i = 0; i < 12; i++)
    for (int j = 0; j < 12; j++) {
      double h = i % 3 == j % 3 ? near->w[i / 3] * near->w[j / 3] : 0;
      for (int k = 0; k < count; k++)
        for (int l = 0; l < count; l++) h -= inverse[k][l] * u[k][i] * u[l][j];
      H[12 * i + j] = 2 * h;
    }
}
