/* See barrier_shape.h. A regular triangulation has half as many particles as triangles and a third as many as edges:
 * so a triangle stands for half the mean area of its particles, an edge for a third. */
#include "plugins/common/contact/barrier/barrier_shape.h"
#include "plugins/kit/vector3.h"

#include <string.h>

static const double pi = 3.14159265358979323846;

static double square_between(const double *x, uint32_t i, uint32_t j) {
  double d[3];
  for (size_t c = 0; c < 3; c++) d[c] = x[3 * (size_t)j + c] - x[3 * (size_t)i + c];
  return hk_dot(d, d);
}

static double triangle_area(const double *x, const uint32_t corner[3]) {
  double a[3], b[3], n[3];
  for (size_t c = 0; c < 3; c++) {
    a[c] = x[3 * (size_t)corner[1] + c] - x[3 * (size_t)corner[0] + c];
    b[c] = x[3 * (size_t)corner[2] + c] - x[3 * (size_t)corner[0] + c];
  }
  hk_cross(n, a, b);
  return hk_length(n) / 2;
}

/* One pass over what a particle belongs to. A negative area marks one that is being measured. */
static void add_triangles(const hk_surface_mesh *mesh, const double *x, hk_barrier_shape *shape) {
  for (size_t k = 0; k < mesh->triangles; k++) {
    double third = triangle_area(x, mesh->triangle[k]) / 3;
    for (int c = 0; c < 3; c++) {
      hk_barrier_shape *at = &shape[mesh->triangle[k][c]];
      if (at->area <= 0) at->area -= third;
    }
  }
}

static void add_edge(const hk_surface_mesh *mesh, const double *x, double distance, size_t e, hk_barrier_shape *shape) {
  const uint32_t *edge = mesh->edge[e];
  bool strand = mesh->edge_faces[e][0] == UINT32_MAX && mesh->edge_faces[e][1] == UINT32_MAX;
  double square = square_between(x, edge[0], edge[1]), width = 2 * mesh->radius[edge[0]] + distance;
  for (int c = 0; c < 2; c++) {
    hk_barrier_shape *at = &shape[edge[c]];
    if (at->area > 0) continue;
    if (strand) at->area -= edge[0] == edge[1] ? pi * width * width / 8 : sqrt(square) * width / 2;
  }
}

void hk_barrier_shapes(const hk_surface_mesh *mesh, const double *x, size_t n, double distance,
                       hk_barrier_shape *shape) {
  add_triangles(mesh, x, shape);
  for (size_t e = 0; e < mesh->edges; e++) add_edge(mesh, x, distance, e, shape);
  for (size_t i = 0; i < n; i++)
    if (shape[i].area < 0) shape[i].square = 0;
  for (size_t e = 0; e < mesh->edges; e++)
    for (int c = 0; c < 2; c++) {
      hk_barrier_shape *at = &shape[mesh->edge[e][c]];
      if (at->area < 0) at->square = fmax(at->square, square_between(x, mesh->edge[e][0], mesh->edge[e][1]));
    }
  for (size_t i = 0; i < n; i++) shape[i].area = fabs(shape[i].area);
}

static double mean_area(const uint32_t *vertex, int count, const hk_barrier_shape *shape) {
  double sum = 0;
  for (int c = 0; c < count; c++) sum += shape[vertex[c]].area;
  return sum / count;
}

static double edge_area(const uint32_t edge[2], const hk_barrier_shape *shape) {
  return mean_area(edge, 2, shape) / (edge[0] == edge[1] ? 1 : 3);
}

static double edge_square(const uint32_t edge[2], const hk_barrier_shape *shape) {
  return edge[0] == edge[1] ? 0 : (shape[edge[0]].square + shape[edge[1]].square) / 2;
}

void hk_barrier_measure(hk_barrier_pair *p, const hk_barrier_shape *shape) {
  const uint32_t *v = p->pair.vertex;
  p->limit = 0;
  if (p->pair.kind == HK_POINT_TRIANGLE) {
    p->area = fmin(shape[v[0]].area, mean_area(v + 1, 3, shape) / 2);
    return;
  }
  p->area = fmin(edge_area(v, shape), edge_area(v + 2, shape));
  p->limit = 1e-3 * edge_square(v, shape) * edge_square(v + 2, shape);
}
