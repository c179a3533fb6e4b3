/* Orthonormal directions by other parameters of the active points: the second one at right angles to the first, and
 * along the cross product with the common normal, which is better known than the difference of nearly parallel vectors.
 */
#include "plugins/common/contact/geometry/nearest_frame.h"
#include "plugins/kit/vector3.h"

#include <string.h>

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

static void divide_vector(double a[3], double by) {
  for (int c = 0; c < 3; c++) a[c] /= by;
}

/* Any unit vector at right angles to a, which is one. */
static void any_across(const double a[3], double b[3]) {
  int least = fabs(a[0]) < fabs(a[1]) ? 0 : 1;
  if (fabs(a[2]) < fabs(a[least])) least = 2;
  hk_cross(b, a, (double[]){least == 0, least == 1, least == 2});
  divide_vector(b, hk_length(b));
}

/* That of d without what it has along a unit vector; where nothing is left any at right angles to that. */
static void normal_of(const double d[3], const double along[3], double n[3]) {
  hk_copy(n, d);
  hk_add_scaled(n, -hk_dot(d, along), along);
  double length = hk_length(n);
  if (length > 0)
    divide_vector(n, length);
  else
    any_across(along, n);
}

static void two_directions(hk_nearest_frame *f, const double d[3], double e[2][3]) {
  double n[3], length = hk_length(e[0]), mixed = hk_dot(e[0], e[1]) / (length * length);
  hk_cross(n, e[0], e[1]);
  double area = hk_length(n), height = area / length, sign = hk_dot(n, d) < 0 ? -1 : 1;
  for (int i = 0; i < 4; i++) f->dw[1][i] = (f->dw[1][i] - mixed * f->dw[0][i]) / height;
  for (int i = 0; i < 4; i++) f->dw[0][i] /= length;
  hk_copy(f->axis[1], e[0]);
  divide_vector(f->axis[1], length);
  divide_vector(n, area);
  hk_cross(f->axis[2], n, f->axis[1]);
  for (int c = 0; c < 3; c++) f->axis[0][c] = sign * n[c];
}

static void one_direction(hk_nearest_frame *f, const double d[3], const double e[3]) {
  double length = hk_length(e);
  for (int i = 0; i < 4; i++) f->dw[0][i] /= length;
  hk_copy(f->axis[1], e);
  divide_vector(f->axis[1], length);
  normal_of(d, f->axis[1], f->axis[0]);
  hk_cross(f->axis[2], f->axis[0], f->axis[1]);
}

static void no_direction(hk_nearest_frame *f, const double d[3]) {
  double length = hk_length(d);
  f->axis[0][0] = 1, f->axis[0][1] = f->axis[0][2] = 0;
  if (length > 0) {
    hk_copy(f->axis[0], d);
    divide_vector(f->axis[0], length);
  }
  any_across(f->axis[0], f->axis[1]);
  hk_cross(f->axis[2], f->axis[0], f->axis[1]);
}

hk_nearest_frame hk_nearest_frame_of(const hk_nearest *near, const double x[12]) {
  hk_nearest_frame f;
  double e[2][3];
  f.count = hk_nearest_directions(near, x, f.dw, e);
  if (f.count == 2) two_directions(&f, near->d, e);
  if (f.count == 1) one_direction(&f, near->d, e[0]);
  if (f.count == 0) no_direction(&f, near->d);
  f.distance = hk_dot(near->d, f.axis[0]);
  return f;
}
