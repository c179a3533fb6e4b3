/* Orientation of points: first in doubles with a bound of all rounding errors, as Shewchuk 1997 ("Adaptive precision
 * floating-point arithmetic and fast robust geometric predicates"), and where that leaves the sign open the determinant
 * as a sum of products of coordinates, each an integer times a power of two, in one long fixed-point number that holds
 * it without rounding (Kulisch and Miranker 1986, "The arithmetic of the digital computer"). Unlike expansions in
 * floating point it has no range in which it fails, and no compiler's contraction can harm it. */
#include "plugins/common/contact/geometry/orientation.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

__extension__ typedef unsigned __int128 wide;

/* ---- The exact sum ----------------------------------------------------------------------------------------------- */

/* A coordinate: sign * m * 2^e, m < 2^53. */
typedef struct number {
  uint64_t m;
  int e;
  bool negative;
} number;

/* 24 products of three numbers of 53 bits span 159 + 5 bits and thrice the range of exponents, 2045; one limb more for
 * the product that is shifted across, and one for the sign. */
enum { LIMB = 64, LIMBS = (159 + 5 + 3 * 2045) / LIMB + 3 };

typedef struct sum {
  uint64_t limb[LIMBS]; /* in two's complement, times 2^base */
  int limbs, base;
} sum;

static number number_of(double x) {
  uint64_t bits;
  memcpy(&bits, &x, sizeof bits);
  int biased = (int)(bits >> 52 & 0x7ff);
  uint64_t fraction = bits & ((UINT64_C(1) << 52) - 1);
  return (number){.m = biased ? fraction | UINT64_C(1) << 52 : fraction,
                  .e = biased ? biased - 1075 : -1074,
                  .negative = bits >> 63};
}

/* Makes room for products of one coordinate each of the columns of n rows. */
static void open_sum(sum *s, number (*row)[3], int n) {
  int base = 0, range = 0;
  for (int c = 0; c < 3; c++) {
    int low = 2000, high = -2000;
    for (int k = 0; k < n; k++)
      if (row[k][c].m != 0) {
        low = row[k][c].e < low ? row[k][c].e : low;
        high = row[k][c].e > high ? row[k][c].e : high;
      }
    if (high >= low) base += low, range += high - low;
  }
  s->base = base;
  s->limbs = (159 + 5 + range) / LIMB + 3;
  memset(s->limb, 0, (size_t)s->limbs * sizeof *s->limb);
}

static void add_limbs(uint64_t *to, const uint64_t part[4], int left, bool negative) {
  uint64_t carry = negative; /* -x is the complement of x, plus one */
  for (int k = 0; k < left; k++) {
    uint64_t p = k < 4 ? part[k] : 0;
    wide w = (wide)to[k] + (negative ? ~p : p) + carry;
    to[k] = (uint64_t)w;
    carry = (uint64_t)(w >> LIMB);
  }
}

/* s += a b c, or -= */
static void add_product(sum *s, const number *a, const number *b, const number *c, bool minus) {
  if (a->m == 0 || b->m == 0 || c->m == 0) return;
  wide ab = (wide)a->m * b->m, low = (wide)(uint64_t)ab * c->m, high = (ab >> LIMB) * c->m + (low >> LIMB);
  uint64_t part[4] = {(uint64_t)low, (uint64_t)high, (uint64_t)(high >> LIMB), 0};
  int at = a->e + b->e + c->e - s->base, first = at / LIMB, shift = at % LIMB;
  for (int k = 3; k >= 0 && shift; k--) part[k] = part[k] << shift | (k > 0 ? part[k - 1] >> (LIMB - shift) : 0);
  add_limbs(s->limb + first, part, s->limbs - first, (a->negative ^ b->negative ^ c->negative) != minus);
}

/* The determinant of three rows. */
static void add_determinant(sum *s, const number a[3], const number b[3], const number c[3], bool minus) {
  for (int k = 0; k < 3; k++) {
    int l = (k + 1) % 3, m = (k + 2) % 3;
    add_product(s, &a[k], &b[l], &c[m], minus);
    add_product(s, &a[k], &b[m], &c[l], !minus);
  }
}

static int sign_of_sum(const sum *s) {
  if (s->limb[s->limbs - 1] >> 63) return -1;
  for (int k = 0; k < s->limbs; k++)
    if (s->limb[k] != 0) return 1;
  return 0;
}

/* ---- Filters ----------------------------------------------------------------------------------------------------- */

/* Units of rounding, 2^-53, that a determinant may be off, as a part of the same sum with all signs positive: in three
 * dimensions 3 for the differences, 2 for the minor, 1 for the product, 2 for the sum, in two dimensions 2, 1 and 1;
 * the rest is for that sum's own rounding. */
static const double BOUND3 = 10 * 0x1p-53, BOUND2 = 5 * 0x1p-53;
/* A product that underflows is off by 2^-1075 at most. */
static const double UNDERFLOW = 0x1p-1070;

__attribute__((noinline)) static int exact2d(const double *a, const double *b, const double *c) {
  const double *point[3] = {a, b, c};
  number row[3][3];
  for (int k = 0; k < 3; k++) {
    if (!isfinite(point[k][0]) || !isfinite(point[k][1])) return 0;
    row[k][0] = number_of(point[k][0]), row[k][1] = number_of(point[k][1]), row[k][2] = number_of(1);
  }
  sum s;
  open_sum(&s, row, 3);
  add_determinant(&s, row[0], row[1], row[2], false);
  return sign_of_sum(&s);
}

int hk_orient2d(const double a[2], const double b[2], const double c[2]) {
  double left = (b[0] - a[0]) * (c[1] - a[1]), right = (b[1] - a[1]) * (c[0] - a[0]);
  double det = left - right, bound = BOUND2 * (fabs(left) + fabs(right)) + UNDERFLOW;
  return fabs(det) > bound ? (det > 0) - (det < 0) : exact2d(a, b, c);
}

/* Whether all points have one coordinate in common, as in a sheet that lies flat. */
static bool in_a_plane_of_axes(const double *const point[4]) {
  for (int c = 0; c < 3; c++)
    if (point[0][c] == point[1][c] && point[0][c] == point[2][c] && point[0][c] == point[3][c]) return true;
  return false;
}

__attribute__((noinline)) static int exact3d(const double *a, const double *b, const double *c, const double *d) {
  const double *point[4] = {a, b, c, d};
  number row[4][3];
  for (int k = 0; k < 12; k++) {
    if (!isfinite(point[k / 3][k % 3])) return 0;
    row[k / 3][k % 3] = number_of(point[k / 3][k % 3]);
  }
  if (in_a_plane_of_axes(point)) return 0;
  sum s;
  open_sum(&s, row, 4);
  add_determinant(&s, row[1], row[2], row[3], false);
  add_determinant(&s, row[0], row[2], row[3], true);
  add_determinant(&s, row[0], row[1], row[3], false);
  add_determinant(&s, row[0], row[1], row[2], true);
  return sign_of_sum(&s);
}

/* (u x v).w of the differences from a. */
int hk_orient3d(const double a[3], const double b[3], const double c[3], const double d[3]) {
  double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2], vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2],
         wx = d[0] - a[0], wy = d[1] - a[1], wz = d[2] - a[2];
  double vw = vx * wy, wv = vy * wx, wu = wx * uy, uw = wy * ux, uv = ux * vy, vu = uy * vx;
  double det = uz * (vw - wv) + vz * (wu - uw) + wz * (uv - vu);
  uz = fabs(uz), vz = fabs(vz), wz = fabs(wz);
  double all = uz * (fabs(vw) + fabs(wv)) + vz * (fabs(wu) + fabs(uw)) + wz * (fabs(uv) + fabs(vu));
  double bound = BOUND3 * all + UNDERFLOW * (1 + uz + vz + wz);
  return fabs(det) > bound ? (det > 0) - (det < 0) : exact3d(a, b, c, d);
}
