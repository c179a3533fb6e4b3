/* The angle of a hinge and its derivatives, with the formulas and names of hinge_lane.h. The Hessian is the derivative
 * of the gradient by e, p, q; that by a is minus the sum of them. Tamstorf and Grinspun, Discrete bending forces and
 * their Jacobians, Graphical Models 75 (2013), sections 3 and 4. */
#include "plugins/common/shells/hinge.h"
#include "plugins/common/shells/hinge_lane.h"
#include "plugins/kit/vector3.h"

#include <string.h>

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

static bool has_area(const corners *h) {
  return h->mm > HK_HINGE_THIN * h->ee * h->ee && h->nn > HK_HINGE_THIN * h->ee * h->ee;
}

hk_hinge_shape hk_hinge_shape_of(const double *x, const uint32_t member[4]) {
  corners h = corners_of(x, member);
  return (hk_hinge_shape){.length = sqrt(h.ee),
                          .area = {sqrt(h.mm) / 2, sqrt(h.nn) / 2},
                          .foot = {hk_dot(h.p, h.e) / h.ee, hk_dot(h.q, h.e) / h.ee}};
}

bool hk_hinge_angle(const double *x, const uint32_t member[4], double *angle, double (*gradient)[3]) {
  double d[3][3];
  for (int m = 0; m < 3; m++) difference(x, member[0], member[m + 1], d[m]);
  hk_hinge_lane h = hk_hinge_measure(d[0], d[1], d[2]);
  *angle = h.fine ? hk_hinge_lane_angle(&h, d[2]) : 0;
  for (int r = 0; r < 3 && gradient; r++) {
    double on = h.fine ? -h.length : 0, c = gradient[2][r] = on / h.mm * h.m[r],
           d_r = gradient[3][r] = on / h.nn * h.n[r];
    gradient[1][r] = -h.s * c - h.t * d_r;
    gradient[0][r] = -(1 - h.s) * c - (1 - h.t) * d_r;
  }
  return h.fine;
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
