/* Curves by arc length: straight lines, arcs and helices in closed form, polygons by adding up. */
#include "core/scene/scene/scene.h"
#include "core/engine/base/base.h"

static const double pi = 3.14159265358979323846;

static void cross(const double a[3], const double b[3], double into[3]) {
  for (int c = 0; c < 3; c++) into[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static double length_of(const double a[3]) { return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]); }

/* A unit vector across the unit vector `axis`: towards the coordinate axis furthest from it (of equal ones z before x
 * before y, so that what runs along x or y curls in a vertical plane first), turned about it by `phase`. */
static void side_of(const double axis[3], double phase, double side[3]) {
  static const int order[3] = {2, 0, 1};
  const double equal = 1e-9; /* closer than that rounding would choose */
  int least = order[0];
  double across[3], length;
  for (int k = 1; k < 3; k++)
    if (fabs(axis[order[k]]) < fabs(axis[least]) - equal) least = order[k];
  for (int c = 0; c < 3; c++) side[c] = (c == least) - axis[least] * axis[c];
  length = length_of(side);
  cross(axis, side, across);
  for (int c = 0; c < 3; c++) side[c] = (cos(phase) * side[c] + sin(phase) * across[c]) / length;
}

hk_helix hk_helix_about(const double from[3], const double axis[3], double phase, double radius, double pitch) {
  hk_helix h = {{from[0], from[1], from[2]}, {axis[0], axis[1], axis[2]}, {0}, radius, pitch};
  side_of(axis, phase, h.side);
  return h;
}

/* With the tangent T, the normal N and B = T x N the curve turns about torsion T + curvature B. */
hk_helix hk_helix_along(const double from[3], const double tangent[3], double phase, double curvature, double torsion) {
  const double square = curvature * curvature + torsion * torsion, length = sqrt(square);
  hk_helix h = hk_helix_about(from, tangent, phase, curvature / square, 2 * pi * torsion / square);
  double binormal[3];
  cross(tangent, h.side, binormal);
  for (int c = 0; c < 3; c++) h.axis[c] = (torsion * tangent[c] + curvature * binormal[c]) / length;
  return h;
}

/* As the centre is at from + radius side. */
void hk_helix_at(const hk_helix *h, double s, double x[3]) {
  const double rise = h->pitch / (2 * pi), per_turn = sqrt(h->radius * h->radius + rise * rise);
  double other[3], angle = h->radius == 0 ? 0 : s / per_turn, half = sin(angle / 2);
  double along = h->radius == 0 ? s : rise * angle;
  cross(h->axis, h->side, other);
  for (int c = 0; c < 3; c++)
    x[c] = h->from[c] + along * h->axis[c] + h->radius * (2 * half * half * h->side[c] - sin(angle) * other[c]);
}

void hk_helix_tangent(const hk_helix *h, double tangent[3]) {
  const double rise = h->pitch / (2 * pi), per_turn = sqrt(h->radius * h->radius + rise * rise);
  double other[3];
  cross(h->axis, h->side, other);
  for (int c = 0; c < 3; c++)
    tangent[c] = h->radius == 0 ? h->axis[c] : (rise * h->axis[c] - h->radius * other[c]) / per_turn;
}

double hk_polygon_length(const double (*point)[3], size_t points) {
  double sum = 0, d[3];
  for (size_t k = 1; k < points; k++) {
    for (int c = 0; c < 3; c++) d[c] = point[k][c] - point[k - 1][c];
    sum += length_of(d);
  }
  return sum;
}

/* Goes along once: `passed` is the length up to point k. */
void hk_polygon_divide(const double (*point)[3], size_t points, size_t count, double *place) {
  double total = hk_polygon_length(point, points), passed = 0, d[3];
  size_t k = 0;
  for (size_t i = 0; i < count; i++) {
    double wanted = total * (double)i / (double)(count - 1), size = 0;
    for (; k + 1 < points; k++, passed += size) {
      for (int c = 0; c < 3; c++) d[c] = point[k + 1][c] - point[k][c];
      size = length_of(d);
      if (passed + size >= wanted && size > 0) break;
    }
    place[i] = k + 1 < points ? (double)k + fmin(1, (wanted - passed) / size) : (double)(points - 1);
  }
}
