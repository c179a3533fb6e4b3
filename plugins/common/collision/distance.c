/* Nearest points and derivatives of the squared distance of a pair.
 *
 * Nearest points: those of the lines, or of the point and the plane, where they lie within both features; otherwise the
 * best of the pairs of a corner and an edge, which no degeneracy harms. The former by the common normal n: for the
 * point p and the triangle a b c, with r = p - a, the weights of b and c are (r x ac).n/|n|^2 and (ab x r).n/|n|^2; for
 * edges u and v that start r apart, s = -(r x v).n/|n|^2 and t = -(r x u).n/|n|^2.
 *
 * Derivatives: with the parameters q of the active points (none, one or two), d(q) = sum_i w_i(q) x_i is linear in q
 * and |d|^2 is least at d.d_k = 0, where d_k = dd/dq_k. By the envelope theorem the gradient by x_i is 2 w_i d, and H =
 * 2 (w w^T (x) I - sum_kl (G^-1)_kl u_k u_l^T),   G_kl = d_k.d_l,   u_k = dw/dq_k (x) d + w (x) d_k, one formula for
 * all kinds and sets of active points. */
#include "plugins/common/collision/distance.h"
#include "plugins/common/space/vector3.h"

#include <string.h>

/* |n|^2 over the fourth power of a length at which a common normal is nothing but rounding errors: those of n are some
 * 1e-16 of the length's square. */
static const double NO_NORMAL = 1e-28;
/* The same ratio above which nearest points in the interior need not be compared with those on edges: n is then known
 * to 10 digits. */
static const double SOUND_NORMAL = 1e-12;

static hk_nearest far_away(hk_pair_kind kind) { return (hk_nearest){.kind = kind, .squared = INFINITY}; }

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

static hk_nearest point_triangle(const double *x) {
  double r[3], e[3], f[3], n[3], m[3];
  hk_subtract(r, x, x + 3);
  hk_subtract(e, x + 6, x + 3);
  hk_subtract(f, x + 9, x + 3);
  hk_cross(n, e, f);
  hk_nearest best = far_away(HK_POINT_TRIANGLE);
  double nn = hk_dot(n, n), length = fmax(hk_dot(e, e), hk_dot(f, f));
  if (nn > NO_NORMAL * length * length) {
    hk_cross(m, r, f);
    double b = hk_dot(m, n) / nn;
    hk_cross(m, e, r);
    double c = hk_dot(m, n) / nn, a = 1 - b - c;
    if (a > 0 && b > 0 && c > 0) {
      best.active = 15;
      memcpy(best.w, (double[]){1, -a, -b, -c}, sizeof best.w);
      for (int k = 0; k < 3; k++) best.d[k] = r[k] - b * e[k] - c * f[k];
      best.squared = hk_dot(best.d, best.d);
      if (nn > SOUND_NORMAL * length * length) return best;
    }
  }
  for (int k = 0; k < 3; k++) try_corner(&best, x, 0, 1 + k, 1 + (k + 1) % 3, 1);
  return best;
}

static hk_nearest edge_edge(const double *x) {
  double r[3], u[3], v[3], n[3], m[3];
  hk_subtract(r, x, x + 6);
  hk_subtract(u, x + 3, x);
  hk_subtract(v, x + 9, x + 6);
  hk_cross(n, u, v);
  hk_nearest best = far_away(HK_EDGE_EDGE);
  double nn = hk_dot(n, n), length = hk_dot(u, u) * hk_dot(v, v);
  if (nn > NO_NORMAL * length) {
    hk_cross(m, r, v);
    double s = -hk_dot(m, n) / nn;
    hk_cross(m, r, u);
    double t = -hk_dot(m, n) / nn;
    if (s > 0 && s < 1 && t > 0 && t < 1) {
      best.active = 15;
      memcpy(best.w, (double[]){1 - s, s, t - 1, -t}, sizeof best.w);
      for (int k = 0; k < 3; k++) best.d[k] = r[k] + s * u[k] - t * v[k];
      best.squared = hk_dot(best.d, best.d);
      if (nn > SOUND_NORMAL * length) return best;
    }
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
