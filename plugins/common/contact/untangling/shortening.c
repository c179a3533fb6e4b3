#include "plugins/common/contact/untangling/shortening.h"
#include "plugins/kit/vector3.h"

#include <string.h>

static const uint32_t NONE = UINT32_MAX;

/* The direction in the planes of two triangles, of length 1, from their common point on the edge into the triangle that
 * has the edge. False: they are parallel. */
static bool into_triangle(const double *x, const uint32_t g[3], const uint32_t e[2], const double normal[3],
                          double out[3]) {
  double p[3], q[3], own[3], along[3], inward[3];
  const double *a = x + 3 * (size_t)e[0];
  uint32_t third = g[0] != e[0] && g[0] != e[1] ? g[0] : g[1] != e[0] && g[1] != e[1] ? g[1] : g[2];
  hk_subtract(p, x + 3 * (size_t)e[1], a);
  hk_subtract(q, x + 3 * (size_t)third, a);
  hk_cross(own, p, q);
  hk_cross(out, own, normal);
  double length = hk_length(out), edge2 = hk_dot(p, p);
  if (!(length > 1e-12 * hk_length(own))) return false; /* the normal has length 1: roundings of a direction */
  hk_copy(along, p);
  for (int c = 0; c < 3; c++) inward[c] = q[c] - hk_dot(q, p) / edge2 * along[c];
  double sign = hk_dot(out, inward) < 0 ? -1 : 1;
  for (int c = 0; c < 3; c++) out[c] *= sign / length;
  return true;
}

/* Where the edge pierces the triangle: at a + s (b - a), with the triangle's weights u. */
static bool pierce(const double *x, const uint32_t e[2], const uint32_t f[3], double normal[3], double *s,
                   double u[3]) {
  const double *a = x + 3 * (size_t)e[0], *p = x + 3 * (size_t)f[0];
  double edge[3], first[3], second[3], from[3], at[3], part[3];
  hk_subtract(edge, x + 3 * (size_t)e[1], a);
  hk_subtract(first, x + 3 * (size_t)f[1], p);
  hk_subtract(second, x + 3 * (size_t)f[2], p);
  hk_cross(normal, first, second);
  double area = hk_length(normal), across = hk_dot(normal, edge);
  if (!(area > 0) || !(fabs(across) > 1e-12 * area * hk_length(edge))) return false;
  hk_subtract(from, p, a);
  *s = fmin(1, fmax(0, hk_dot(normal, from) / across));
  for (int c = 0; c < 3; c++) at[c] = a[c] + *s * edge[c] - p[c];
  hk_cross(part, at, second);
  u[1] = hk_dot(part, normal) / (area * area);
  hk_cross(part, first, at);
  u[2] = hk_dot(part, normal) / (area * area);
  u[0] = 1 - u[1] - u[2];
  for (int c = 0; c < 3; c++) normal[c] /= area;
  return true;
}

/* The point P of edge and plane moves by D - E (D.N)/(E.N) where the edge there moves by D relative to the triangle;
 * the curve becomes shorter by S.dP, S the sum of the directions of its pieces at P. */
bool hk_shortening(const hk_surface_mesh *m, const double *x, const hk_contour_point *p, double w[5],
                   double direction[3]) {
  const uint32_t *e = m->edge[p->edge], *f = m->triangle[p->triangle];
  double normal[3], s, u[3], edge[3];
  memset(direction, 0, 3 * sizeof *direction);
  if (!pierce(x, e, f, normal, &s, u)) return false;
  for (int slot = 0; slot < 2; slot++) {
    double piece[3];
    uint32_t g = m->edge_faces[p->edge][slot];
    if (g != NONE && into_triangle(x, m->triangle[g], e, normal, piece)) hk_add_scaled(direction, 1, piece);
  }
  hk_subtract(edge, x + 3 * (size_t)e[1], x + 3 * (size_t)e[0]);
  hk_add_scaled(direction, -hk_dot(direction, edge) / hk_dot(edge, normal), normal);
  w[0] = 1 - s, w[1] = s;
  for (int k = 0; k < 3; k++) w[2 + k] = -u[k];
  return true;
}
