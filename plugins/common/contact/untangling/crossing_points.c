#include "plugins/common/contact/untangling/crossing_points.h"

#include "plugins/kit/vector3.h"

/* Whether p, a point of the triangle's plane, is in it: on the inner side of all sides. */
static bool inside(const double *corner[3], const double n[3], const double p[3]) {
  for (int k = 0; k < 3; k++) {
    double side[3], to[3], across[3];
    hk_subtract(side, corner[(k + 1) % 3], corner[k]);
    hk_subtract(to, p, corner[k]);
    hk_cross(across, side, to);
    if (hk_dot(across, n) < 0) return false;
  }
  return true;
}

static void add_crossing(const double *a, const double *b, const double *corner[3], const hk_contact_points *points) {
  double u[3], v[3], n[3], from[3], along[3], p[3];
  hk_subtract(u, corner[1], corner[0]);
  hk_subtract(v, corner[2], corner[0]);
  hk_cross(n, u, v);
  hk_subtract(from, a, corner[0]);
  hk_subtract(along, b, a);
  double size = hk_length(n), height = hk_dot(from, n), rise = hk_dot(along, n);
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
