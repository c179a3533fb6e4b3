/* The angle of a hinge and its derivatives. With e = b - a, p = c - a, q = d - a and the normals m = e x p, n = q x e,
 * both of twice the area of their triangle, m x n = -(m.q) e, so that
 *     angle = atan2(-|e| m.q, m.n),
 * which is exact to rounding for all angles, small ones and those near pi included. Of the gradient,
 *     g_c = -|e| m/|m|^2,   g_d = -|e| n/|n|^2:
 * moving c along its normal turns its triangle about the edge with the lever of its height |m|/|e|. a and b balance
 * force and moment: with the feet s = p.e/|e|^2 and t = q.e/|e|^2
 *     g_b = -s g_c - t g_d,   g_a = -(1 - s) g_c - (1 - t) g_d.
 * The Hessian is the derivative of these by e, p, q; that by a is minus the sum of them.
 * Tamstorf and Grinspun, Discrete bending forces and their Jacobians, Graphical Models 75 (2013), sections 3 and 4. */
#include "plugins/common/shells/hinge.h"
#include "plugins/common/space/vector3.h"

#include <string.h>

/* Height over edge length, squared, at which a triangle counts as one without area: the normal of a thinner one is
 * known to four digits or fewer, from differences of coordinates as long as the edge. */
static const double THIN = 1e-24;

typedef struct corners {
  double e[3], p[3], q[3], m[3], n[3];
  double ee, mm, nn; /* squares of e, m, n */
} corners;

static void difference(const double *x, uint32_t from, uint32_t to, double d[3]) {
  hk_subtract(d, x + 3 * (size_t)to, x + 3 * (size_t)from);
}

static corners corners_of(const double *x, const uint32_t member[4]) {
  corners h;
  difference(x, member[0], member[1], h.e);
  difference(x, member[0], member[2], h.p);
  difference(x, member[0], member[3], h.q);
  hk_cross(h.m, h.e, h.p);
  hk_cross(h.n, h.q, h.e);
  h.ee = hk_dot(h.e, h.e), h.mm = hk_dot(h.m, h.m), h.nn = hk_dot(h.n, h.n);
  return h;
}

static bool has_area(const corners *h) { return h->mm > THIN * h->ee * h->ee && h->nn > THIN * h->ee * h->ee; }

hk_hinge_shape hk_hinge_shape_of(const double *x, const uint32_t member[4]) {
  corners h = corners_of(x, member);
  return (hk_hinge_shape){.length = sqrt(h.ee),
                          .area = {sqrt(h.mm) / 2, sqrt(h.nn) / 2},
                          .foot = {hk_dot(h.p, h.e) / h.ee, hk_dot(h.q, h.e) / h.ee}};
}

bool hk_hinge_angle(const double *x, const uint32_t member[4], double *angle, double (*gradient)[3]) {
  corners h = corners_of(x, member);
  *angle = 0;
  if (!has_area(&h)) {
    if (gradient) memset(gradient, 0, 4 * sizeof *gradient);
    return false;
  }
  double length = sqrt(h.ee), s = hk_dot(h.p, h.e) / h.ee, t = hk_dot(h.q, h.e) / h.ee;
  *angle = atan2(-length * hk_dot(h.m, h.q), hk_dot(h.m, h.n));
  for (int r = 0; r < 3 && gradient; r++) {
    double c = gradient[2][r] = -length / h.mm * h.m[r], d = gradient[3][r] = -length / h.nn * h.n[r];
    gradient[1][r] = -s * c - t * d;
    gradient[0][r] = -(1 - s) * c - (1 - t) * d;
  }
  return true;
}

bool hk_hinge_is_open(const double *x, const uint32_t member[4]) {
  corners h = corners_of(x, member);
  return hk_dot(h.m, h.n) > 0;
}

/* ---- Hessian ----------------------------------------------------------------------------------------------------- */

/* (u x)_rc: the matrix of the cross product with u. */
static double skew(const double u[3], int r, int c) {
  return r == c ? 0 : (c - r + 3) % 3 == 1 ? -u[3 - r - c] : u[3 - r - c];
}

/* The derivatives of the gradient of one wing, g = -|e| m/|m|^2: by its own arm u (p or q), and by e. `sign`: 1 for
 * m = e x p, -1 for n = q x e. dm = sign (de x u + e x du), and d(m/|m|^2) = R dm/|m|^2 with R = I - 2 m m^T/|m|^2. */
static void wing(const double e[3], double length, const double u[3], const double m[3], double mm, int sign,
                 double by_arm[9], double by_edge[9]) {
  double f = sign * length / mm;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      double Re = 0, Ru = 0;
      for (int k = 0; k < 3; k++) {
        double R = (r == k) - 2 * m[r] * m[k] / mm;
        Re += R * skew(e, k, c);
        Ru += R * skew(u, k, c);
      }
      by_arm[3 * r + c] = -f * Re;
      by_edge[3 * r + c] = f * Ru - m[r] * e[c] / (length * mm);
    }
}

/* The block of g_b by e: the product rule on -s g_c - t g_d, with ds/de = (p - 2 s e)/|e|^2. */
static void end_block(const corners *h, double length, const double ce[9], const double de[9], double bb[9]) {
  double s = hk_dot(h->p, h->e) / h->ee, t = hk_dot(h->q, h->e) / h->ee;
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      double ds = (h->p[c] - 2 * s * h->e[c]) / h->ee, dt = (h->q[c] - 2 * t * h->e[c]) / h->ee;
      bb[3 * r + c] = -s * ce[3 * r + c] - t * de[3 * r + c] + length * (h->m[r] / h->mm * ds + h->n[r] / h->nn * dt);
    }
}

/* Fills the rows and columns of a, by which a translation changes nothing. */
static void complete(double *H) {
  for (int r = 3; r < 12; r++)
    for (int c = 0; c < 3; c++)
      H[12 * r + c] = H[12 * c + r] = -H[12 * r + c + 3] - H[12 * r + c + 6] - H[12 * r + c + 9];
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) H[12 * r + c] = -H[12 * r + c + 3] - H[12 * r + c + 6] - H[12 * r + c + 9];
}

void hk_hinge_hessian(const double *x, const uint32_t member[4], double *H) {
  corners h = corners_of(x, member);
  memset(H, 0, 144 * sizeof *H);
  if (!has_area(&h)) return;
  double length = sqrt(h.ee), cc[9], ce[9], dd[9], de[9], bb[9];
  wing(h.e, length, h.p, h.m, h.mm, 1, cc, ce);
  wing(h.e, length, h.q, h.n, h.nn, -1, dd, de);
  end_block(&h, length, ce, de, bb);
  for (int r = 0; r < 3; r++)
    for (int c = 0; c < 3; c++) {
      H[12 * (3 + r) + 3 + c] = bb[3 * r + c];
      H[12 * (6 + r) + 6 + c] = cc[3 * r + c];
      H[12 * (9 + r) + 9 + c] = dd[3 * r + c];
      H[12 * (6 + r) + 3 + c] = H[12 * (3 + c) + 6 + r] = ce[3 * r + c];
      H[12 * (9 + r) + 3 + c] = H[12 * (3 + c) + 9 + r] = de[3 * r + c];
    }
  complete(H);
}
