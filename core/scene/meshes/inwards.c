/* A closed mesh whose faces are all moved inwards: where the planes of the faces of a corner meet again, which is the
 * solution of n.d = -distance for all their normals. The normal equations of least squares have it, sum n n^T d =
 * -distance sum n, by Cramer's rule; corners of which no place is as far from all of its faces are refused. */
#include "core/scene/meshes/meshes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double exact = 1e-9, degenerate = 1e-6; /* of the distance; of a determinant of unit normals */

static void cross(const double a[3], const double b[3], double out[3]) {
  for (int c = 0; c < 3; c++) out[c] = a[(c + 1) % 3] * b[(c + 2) % 3] - a[(c + 2) % 3] * b[(c + 1) % 3];
}

static double dot(const double a[3], const double b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* Twice the area times the normal. */
static void area_of(const double *vertex, const uint32_t t[3], double out[3]) {
  double a[3], b[3];
  for (size_t c = 0; c < 3; c++) {
    a[c] = vertex[3 * (size_t)t[1] + c] - vertex[3 * (size_t)t[0] + c];
    b[c] = vertex[3 * (size_t)t[2] + c] - vertex[3 * (size_t)t[0] + c];
  }
  cross(a, b, out);
}

static bool normal_of(const hk_mesh *m, size_t t, double out[3]) {
  area_of(m->vertex, m->triangle[t], out);
  double size = sqrt(dot(out, out));
  for (int c = 0; c < 3; c++) out[c] /= size;
  return size > 0;
}

/* A: vertices x 12, sum n n^T and sum n. False: a triangle has no area. */
static bool add_normals(const hk_mesh *m, double (*A)[12]) {
  bool fine = true;
  for (size_t t = 0; t < m->triangles; t++) {
    double n[3];
    fine &= normal_of(m, t, n);
    for (int c = 0; c < 3; c++)
      for (int i = 0; i < 9; i++) A[m->triangle[t][c]][i] += n[i / 3] * n[i % 3];
    for (int c = 0; c < 3; c++)
      for (int i = 0; i < 3; i++) A[m->triangle[t][c]][9 + i] += n[i];
  }
  return fine;
}

/* d of A d = sum n; false: the faces of the corner do not determine it. */
static bool solve(const double A[12], double d[3]) {
  double across[3][3], size = (A[0] + A[4] + A[8]) / 3;
  for (int r = 0; r < 3; r++) cross(A + 3 * ((r + 1) % 3), A + 3 * ((r + 2) % 3), across[r]);
  double det = dot(A, across[0]);
  if (!(det > degenerate * size * size * size)) return false;
  for (int c = 0; c < 3; c++) d[c] = (A[9] * across[0][c] + A[10] * across[1][c] + A[11] * across[2][c]) / det;
  return true;
}

/* to: the vertices. */
static const char *find_corners(const hk_mesh *m, double (*A)[12], double distance, double *to) {
  const char *refused =
      "the faces of a corner have no place in common further inside: it is for boxes and other bodies "
      "with three planes at each corner";
  for (size_t v = 0; v < m->vertices; v++) {
    if (!solve(A[v], A[v])) return refused;
    for (size_t c = 0; c < 3; c++) to[3 * v + c] = m->vertex[3 * v + c] - distance * A[v][c];
  }
  for (size_t t = 0; t < m->triangles; t++) {
    double n[3], now[3];
    if (!normal_of(m, t, n)) return refused;
    for (int c = 0; c < 3; c++)
      if (!(fabs(dot(n, A[m->triangle[t][c]]) - 1) <= exact)) return refused;
    area_of(to, m->triangle[t], now);
    if (!(dot(now, n) > 0)) return "it is half of the body's least extent or more: make it smaller";
  }
  return NULL;
}

const char *hk_mesh_move_inwards(hk_mesh *m, double distance) {
  double(*A)[12] = calloc(m->vertices + 1, sizeof *A), *to = malloc((3 * m->vertices + 1) * sizeof *to);
  const char *wrong = A && to ? NULL : "no memory for its corners";
  if (!wrong && !add_normals(m, A)) wrong = "a triangle of the body has no area";
  if (!wrong) wrong = find_corners(m, A, distance, to);
  if (!wrong && m->vertices) memcpy(m->vertex, to, 3 * m->vertices * sizeof *to);
  free(A);
  free(to);
  return wrong;
}
