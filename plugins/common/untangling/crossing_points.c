#include "plugins/common/untangling/crossing_points.h"

#include <math.h>

static void difference(const double *a, const double *b, double d[3]) {
  for (int c = 0; c < 3; c++) d[c] = a[c] - b[c];
}

static void cross(const double a[3], const double b[3], double n[3]) {
  for (int c = 0; c < 3; c++) n[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Whether p, a point of the triangle's plane, is in it: on the inner side of all sides. */
static bool inside(const double *corner[3], const double n[3], const double p[3]) {
  for (int k = 0; k < 3; k++) {
    double side[3], to[3], across[3];
    difference(corner[(k + 1) % 3], corner[k], side);
    difference(p, corner[k], to);
    cross(side, to, across);
    if (dot(across, n) < 0) return false;
  }
  return true;
}

static void add_crossing(const double *a, const double *b, const double *corner[3], const hk_contact_points *points) {
  double u[3], v[3], n[3], from[3], along[3], p[3];
  difference(corner[1], corner[0], u);
  difference(corner[2], corner[0], v);
  cross(u, v, n);
  difference(a, corner[0], from);
  difference(b, a, along);
  double size = sqrt(dot(n, n)), height = dot(from, n), rise = dot(along, n);
  double part = -height / rise; /* of the edge, up to the plane */
  if (!(size > 0) || !(part >= 0 && part <= 1)) return;
  for (int c = 0; c < 3; c++) p[c] = a[c] + part * along[c];
  if (!inside(corner, n, p)) return;
  for (int c = 0; c < 3; c++) n[c] /= size;
  points->add(points->context, p, n);
}

void hk_crossing_points(const hk_contours *contours, const hk_surface_mesh *mesh, const double *x,
                        const hk_contact_points *points) {
  for (size_t k = 0; k < contours->points; k++) {
    const uint32_t *e = mesh->edge[contours->point[k].edge], *t = mesh->triangle[contours->point[k].triangle];
    const double *corner[3] = {x + 3 * (size_t)t[0], x + 3 * (size_t)t[1], x + 3 * (size_t)t[2]};
    add_crossing(x + 3 * (size_t)e[0], x + 3 * (size_t)e[1], corner, points);
  }
}
