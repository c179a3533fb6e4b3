/* Vertices and faces of a mesh; faces of more than three corners are cut into triangles by clipping ears: a corner is
 * cut off whose triangle turns the way the face does and has no other corner in it. Of a convex face that is the fan
 * around its first corner. Meisters, Polygons have ears, American Mathematical Monthly 82 (1975). */
#include "core/scene/meshes/meshes.h"

#include <stdlib.h>
#include <string.h>

void hk_mesh_clear(hk_mesh *m) {
  free(m->vertex);
  free(m->triangle);
  free(m->tetrahedron);
  *m = (hk_mesh){0};
}

bool hk_mesh_grow(void *array, size_t *capacity, size_t count, size_t size) {
  void *memory;
  memcpy(&memory, array, sizeof memory);
  if (count <= *capacity) return true;
  void *bigger = realloc(memory, (2 * count + 256) * size);
  if (!bigger) return false;
  memcpy(array, &bigger, sizeof bigger);
  *capacity = 2 * count + 256;
  return true;
}

const char *hk_mesh_add_vertex(hk_mesh *m, const double x[3]) {
  if (m->vertices == UINT32_MAX) return "there are more vertices than a mesh can have";
  if (!hk_mesh_grow(&m->vertex, &m->vertex_capacity, m->vertices + 1, 3 * sizeof *m->vertex)) return "no memory";
  memcpy(m->vertex + 3 * m->vertices++, x, 3 * sizeof *x);
  return NULL;
}

/* A face laid into the plane of the two coordinates in which it is largest, so that it runs against the clock. */
typedef struct polygon {
  size_t count;
  uint32_t corner[HK_FACE_CORNERS];
  double at[HK_FACE_CORNERS][2];
} polygon;

/* Newell's normal: the areas of the projections along the axes. */
static void normal_of(const hk_mesh *m, const uint32_t *corner, size_t count, double normal[3]) {
  for (int c = 0; c < 3; c++) normal[c] = 0;
  const double *base = m->vertex + 3 * (size_t)corner[0];
  for (size_t k = 0; k < count; k++) {
    const double *p = m->vertex + 3 * (size_t)corner[k], *q = m->vertex + 3 * (size_t)corner[(k + 1) % count];
    for (int c = 0, d = 1, e = 2; c < 3; c++, d = (d + 1) % 3, e = (e + 1) % 3)
      normal[c] += (p[d] - base[d]) * (q[e] - base[e]) - (p[e] - base[e]) * (q[d] - base[d]);
  }
}

static void lay(polygon *p, const hk_mesh *m, const uint32_t *corner, size_t count) {
  double normal[3];
  int axis = 0;
  normal_of(m, corner, count, normal);
  for (int c = 1; c < 3; c++)
    if (fabs(normal[c]) > fabs(normal[axis])) axis = c;
  int first = (axis + 1) % 3, second = (axis + 2) % 3;
  p->count = count;
  memcpy(p->corner, corner, count * sizeof *corner);
  for (size_t k = 0; k < count; k++) {
    const double *x = m->vertex + 3 * (size_t)corner[k];
    p->at[k][0] = x[normal[axis] < 0 ? second : first];
    p->at[k][1] = x[normal[axis] < 0 ? first : second];
  }
}

/* Twice the area of the triangle, positive against the clock. */
static double turn(const double a[2], const double b[2], const double c[2]) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static bool is_ear(const polygon *p, size_t k) {
  size_t before = (k + p->count - 1) % p->count, after = (k + 1) % p->count;
  const double *a = p->at[before], *b = p->at[k], *c = p->at[after];
  if (!(turn(a, b, c) > 0)) return false;
  for (size_t q = 0; q < p->count; q++)
    if (q != before && q != k && q != after && turn(a, b, p->at[q]) >= 0 && turn(b, c, p->at[q]) >= 0 &&
        turn(c, a, p->at[q]) >= 0)
      return false;
  return true;
}

static void add_triangle(hk_mesh *m, uint32_t a, uint32_t b, uint32_t c) {
  memcpy(m->triangle[m->triangles++], (uint32_t[]){a, b, c}, sizeof *m->triangle);
}

static void cut_off(polygon *p, size_t k, hk_mesh *m) {
  size_t before = (k + p->count - 1) % p->count, after = (k + 1) % p->count, behind = --p->count - k;
  add_triangle(m, p->corner[before], p->corner[k], p->corner[after]);
  memmove(p->corner + k, p->corner + k + 1, behind * sizeof *p->corner);
  memmove(p->at + k, p->at + k + 1, behind * sizeof *p->at);
}

static bool cut(polygon *p, hk_mesh *m) {
  while (p->count > 3) {
    size_t k = 1, tried = 0;
    for (; tried < p->count && !is_ear(p, k); tried++) k = (k + 1) % p->count;
    if (tried == p->count) return false;
    cut_off(p, k, m);
  }
  add_triangle(m, p->corner[0], p->corner[1], p->corner[2]);
  return true;
}

const char *hk_mesh_add_face(hk_mesh *m, const uint32_t *corner, size_t count) {
  polygon p;
  size_t triangles = m->triangles;
  if (count < 3) return "a face needs three corners";
  if (count > HK_FACE_CORNERS) return "a face has more than 256 corners";
  for (size_t k = 0; k < count; k++)
    for (size_t l = 0; l < k; l++)
      if (corner[k] == corner[l]) return "a face names a vertex twice";
  if (!hk_mesh_grow(&m->triangle, &m->triangle_capacity, m->triangles + count, sizeof *m->triangle)) return "no memory";
  lay(&p, m, corner, count);
  if (cut(&p, m)) return NULL;
  m->triangles = triangles;
  return "a face of more than three corners crosses itself or has no area: cut it into triangles";
}
