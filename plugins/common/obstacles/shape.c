#include "plugins/common/obstacles/shape.h"
#include "plugins/kit/vector3.h"

/* The normal along d, whose length is given; where that is 0, along `otherwise`. */
static void along(double n[3], const double d[3], double length, int otherwise) {
  for (int c = 0; c < 3; c++) n[c] = length > 0 ? d[c] / length : c == otherwise;
}

static double to_sphere(const double p[3], double radius, double n[3]) {
  double r = hk_length(p);
  along(n, p, r, 2);
  return r - radius;
}

static double to_box(const double half[3], const double p[3], double n[3]) {
  double q[3], out[3], best = -INFINITY;
  int nearest = 0;
  for (int c = 0; c < 3; c++) {
    q[c] = fabs(p[c]) - half[c];
    out[c] = copysign(fmax(q[c], 0), p[c]);
    if (q[c] > best) best = q[c], nearest = c;
  }
  double d = hk_length(out);
  for (int c = 0; c < 3; c++) n[c] = d > 0 ? out[c] / d : c == nearest ? copysign(1, p[c]) : 0;
  return d > 0 ? d : best;
}

/* In the plane through the axis: radial and along. */
static double to_cylinder(const double half[3], const double p[3], double n[3]) {
  double rho = sqrt(p[0] * p[0] + p[1] * p[1]), radial = rho - half[0], axial = fabs(p[2]) - half[2];
  double out[2] = {fmax(radial, 0), fmax(axial, 0)}, d = sqrt(out[0] * out[0] + out[1] * out[1]);
  double part[2] = {d > 0 ? out[0] / d : radial > axial, d > 0 ? out[1] / d : radial <= axial};
  for (int c = 0; c < 2; c++) n[c] = part[0] * (rho > 0 ? p[c] / rho : c == 0);
  n[2] = copysign(part[1], p[2]);
  return d > 0 ? d : fmax(radial, axial);
}

static double to_capsule(const double half[3], const double p[3], double n[3]) {
  double straight = fmax(0, half[2] - half[0]), on_axis = fmax(-straight, fmin(straight, p[2]));
  double d[3] = {p[0], p[1], p[2] - on_axis}, r = hk_length(d);
  along(n, d, r, 0);
  return r - half[0];
}

/* From inside, a corner is where several faces meet: each has its own normal, and none leads along the diagonal. */
static double to_nearest_face(const hk_shape *s, const double p[3], double n[3]) {
  double rho = sqrt(p[0] * p[0] + p[1] * p[1]), radial = rho - s->half[0], best = -INFINITY;
  bool box = s->kind == HK_SHAPE_BOX;
  int face = 2;
  for (int c = box ? 0 : 2; c < 3; c++)
    if (fabs(p[c]) - s->half[c] > best) best = fabs(p[c]) - s->half[c], face = c;
  bool wall = !box && radial > best;
  for (int c = 0; c < 3; c++)
    n[c] = wall ? (c == 2 ? 0 : rho > 0 ? p[c] / rho : c == 0) : c == face ? copysign(1, p[c]) : 0;
  return wall ? radial : best;
}

static double outward(const hk_shape *s, const double p[3], double n[3]) {
  if (s->hollow && (s->kind == HK_SHAPE_BOX || s->kind == HK_SHAPE_CYLINDER)) return to_nearest_face(s, p, n);
  switch (s->kind) {
  case HK_SHAPE_SPHERE:
    return to_sphere(p, s->half[0], n);
  case HK_SHAPE_BOX:
    return to_box(s->half, p, n);
  case HK_SHAPE_CYLINDER:
    return to_cylinder(s->half, p, n);
  case HK_SHAPE_CAPSULE:
    return to_capsule(s->half, p, n);
  case HK_SHAPE_MESH:
    return hk_surface_distance(s->surface, p, n);
  case HK_SHAPE_PLANE:
    break;
  }
  hk_copy(n, s->normal);
  return hk_dot(s->normal, p);
}

double hk_shape_distance(const hk_shape *s, const double p[3], double n[3]) {
  double d = outward(s, p, n);
  for (int c = 0; c < 3 && s->hollow; c++) n[c] = -n[c];
  return s->hollow ? -d : d;
}

double hk_shape_size(const hk_shape *s) {
  if (s->kind == HK_SHAPE_MESH) return s->surface->size;
  return s->kind == HK_SHAPE_PLANE ? 0 : 2 * fmax(s->half[0], fmax(s->half[1], s->half[2]));
}
