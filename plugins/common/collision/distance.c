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
 * one formula for all kinds and sets of active points. The parameters are chosen so that G is the unit matrix: then
 *     H = 2 (w w^T (x) (I - sum_k d_k d_k^T) - sum_k (p_k p_k^T + p_k (w (x) d_k)^T + (w (x) d_k) p_k^T)),
 *     p_k = dw/dq_k (x) d. */
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

/* A corner and an edge, by their row in the table of pairs of a kind, and the nearest point at s on the edge. */
typedef struct corner {
  int row;
  double s, squared;
} corner;

typedef unsigned char row_of_corner[3];
static const row_of_corner triangle_rows[3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}},
                           edge_rows[4] = {{0, 2, 3}, {1, 2, 3}, {2, 0, 1}, {3, 0, 1}};

/* From x_i to the edge x_j x_k. Compiled without branches: which row is the best is random. */
static void try_corner(corner *best, const double *x, const row_of_corner *rows, int row) {
  double r[3], e[3];
  hk_subtract(r, x + 3 * rows[row][0], x + 3 * rows[row][1]);
  hk_subtract(e, x + 3 * rows[row][2], x + 3 * rows[row][1]);
  double s = hk_dot(r, e) / hk_dot(e, e); /* of an edge without length not a number: 0 */
  s = s > 0 ? s : 0;
  s = s < 1 ? s : 1;
  hk_add_scaled(r, -s, e);
  double squared = hk_dot(r, r);
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
  corner near = {.squared = INFINITY};
  for (int row = 0; row < 3; row++) try_corner(&near, x, triangle_rows, row);
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
  for (int row = 0; row < 4; row++) try_corner(&near, x, edge_rows, row);
  keep_corner(&best, x, edge_rows, &near);
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

int hk_nearest_directions(const hk_nearest *near, const double x[12], double dw[2][4], double d[2][3]) {
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

/* Makes the directions orthonormal, d_k.d_l = 1 or 0, by other parameters: with the normal, which is better known than
 * the difference of two vectors that are nearly parallel. */
static void make_orthonormal(double dw[2][4], double d[2][3], int count) {
  double n[3], mixed = 0, height = 1;
  if (count == 2) {
    hk_cross(n, d[0], d[1]);
    mixed = hk_dot(d[0], d[1]) / hk_dot(d[0], d[0]);
    height = hk_length(n) / hk_length(d[0]);
    for (int i = 0; i < 4; i++) dw[1][i] = (dw[1][i] - mixed * dw[0][i]) / height;
    hk_cross(d[1], n, d[0]);
  }
  double length = count > 0 ? hk_length(d[0]) : 1, second = count > 1 ? hk_length(d[1]) : 1;
  for (int i = 0; i < 4; i++) dw[0][i] /= length;
  for (int c = 0; c < 3; c++) d[0][c] /= length, d[1][c] /= second;
}

/* The 3 x 3 block of points i and j. `turn`: sum_k dw_k(i) d_k, by which d turns. */
static void block(const hk_nearest *near, double dw[2][4], double across[3][3], double turn[4][3], int i, int j,
                  double B[3][3]) {
  double wi = near->w[i], wj = near->w[j], shift = dw[0][i] * dw[0][j] + dw[1][i] * dw[1][j];
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++)
      B[r][c] = 2 * (wi * wj * across[r][c] - near->d[r] * (shift * near->d[c] + wj * turn[i][c]) -
                     wi * turn[j][r] * near->d[c]);
}

void hk_distance_hessian(const hk_nearest *near, const double x[12], double H[144]) {
  double dw[2][4], d[2][3] = {{0}}, across[3][3], turn[4][3], B[3][3];
  int count = hk_nearest_directions(near, x, dw, d);
  make_orthonormal(dw, d, count);
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) across[r][c] = (r == c) - d[0][r] * d[0][c] - d[1][r] * d[1][c];
  for (int i = 0; i < 4; i++)
    for (int c = 0; c < 3; c++) turn[i][c] = dw[0][i] * d[0][c] + dw[1][i] * d[1][c];
  for (int i = 0; i < 4; i++)
    for (int j = i; j < 4; j++) {
      block(near, dw, across, turn, i, j, B);
      for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++) H[12 * (3 * i + r) + 3 * j + c] = H[12 * (3 * j + c) + 3 * i + r] = B[r][c];
    }
}
