/* Tetrahedra of a mesh, and its skin: the faces that one tetrahedron alone has. A face of two is inside; both see it
 * from their own side, so that its corners run the other way in each. */
#include "core/scene/meshes/meshes.h"

#include <stdlib.h>
#include <string.h>

/* Volume over the cube of the longest edge below which a tetrahedron is flat: less than four digits of it would be
 * known. */
static const double FLAT = 1e-12;

static const double *place(const hk_mesh *m, uint32_t corner) { return m->vertex + 3 * (size_t)corner; }

static double square(const hk_mesh *m, uint32_t a, uint32_t b) {
  double sum = 0;
  for (int c = 0; c < 3; c++) sum += (place(m, b)[c] - place(m, a)[c]) * (place(m, b)[c] - place(m, a)[c]);
  return sum;
}

static double volume_of(const hk_mesh *m, const uint32_t corner[4]) {
  double d[3][3], sum = 0;
  for (int k = 0; k < 3; k++)
    for (int c = 0; c < 3; c++) d[k][c] = place(m, corner[k + 1])[c] - place(m, corner[0])[c];
  for (int c = 0; c < 3; c++)
    sum += d[0][c] * (d[1][(c + 1) % 3] * d[2][(c + 2) % 3] - d[1][(c + 2) % 3] * d[2][(c + 1) % 3]);
  return sum / 6;
}

double hk_mesh_volume(const hk_mesh *m, size_t k) { return volume_of(m, m->tetrahedron[k]); }

const char *hk_mesh_add_tetrahedron(hk_mesh *m, const uint32_t corner[4]) {
  double longest = 0, volume = volume_of(m, corner);
  for (int a = 0; a < 4; a++)
    for (int b = 0; b < a; b++) {
      if (corner[a] == corner[b]) return "a tetrahedron names a vertex twice";
      longest = fmax(longest, square(m, corner[a], corner[b]));
    }
  if (!(fabs(volume) > FLAT * longest * sqrt(longest)))
    return "a tetrahedron has no volume: its corners lie in a plane";
  if (!hk_mesh_grow(&m->tetrahedron, &m->tetrahedron_capacity, m->tetrahedra + 1, sizeof *m->tetrahedron))
    return "no memory";
  uint32_t *into = m->tetrahedron[m->tetrahedra++];
  memcpy(into, corner, sizeof *m->tetrahedron);
  if (volume < 0) into[0] = corner[1], into[1] = corner[0];
  return NULL;
}

/* ---- skin -------------------------------------------------------------------------------------------------------- */

typedef struct face {
  uint32_t corner[3], sorted[3]; /* outwards; rising */
  size_t tetrahedron;
} face;

static void sort3(uint32_t a[3]) {
  for (int k = 0; k < 3; k++) {
    int p = k == 1 ? 1 : 0;
    uint32_t low = a[p] < a[p + 1] ? a[p] : a[p + 1], high = a[p] < a[p + 1] ? a[p + 1] : a[p];
    a[p] = low, a[p + 1] = high;
  }
}

static int by_corners(const void *left, const void *right) {
  const face *f = left, *g = right;
  for (int k = 0; k < 3; k++)
    if (f->sorted[k] != g->sorted[k]) return f->sorted[k] < g->sorted[k] ? -1 : 1;
  return (f->tetrahedron > g->tetrahedron) - (f->tetrahedron < g->tetrahedron);
}

static void list_faces(const hk_mesh *m, face *list) {
  static const int OUTWARDS[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  for (size_t k = 0; k < 4 * m->tetrahedra; k++) {
    face *f = &list[k];
    f->tetrahedron = k / 4;
    for (int c = 0; c < 3; c++) f->corner[c] = m->tetrahedron[k / 4][OUTWARDS[k % 4][c]];
    memcpy(f->sorted, f->corner, sizeof f->sorted);
    sort3(f->sorted);
  }
  qsort(list, 4 * m->tetrahedra, sizeof *list, by_corners);
}

static bool same_face(const face *f, const face *g) { return memcmp(f->sorted, g->sorted, sizeof f->sorted) == 0; }

/* Whether the corners run the same way. */
static bool same_side(const face *f, const face *g) {
  for (int k = 0; k < 3; k++)
    if (f->corner[0] == g->corner[k]) return f->corner[1] == g->corner[(k + 1) % 3];
  return false;
}

static const char *add_outer(hk_mesh *m, const face *list, size_t faces, size_t tetrahedra[2]) {
  for (size_t k = 0, next; k < faces; k = next) {
    for (next = k + 1; next < faces && same_face(&list[k], &list[next]); next++) {
      tetrahedra[0] = list[next - 1].tetrahedron, tetrahedra[1] = list[next].tetrahedron;
      if (same_side(&list[next - 1], &list[next])) return "they overlap: both lie on the same side of a face";
      if (next > k + 1) return "a face of theirs belongs to a third one";
    }
    if (next == k + 1) memcpy(m->triangle[m->triangles++], list[k].corner, sizeof *m->triangle);
  }
  return NULL;
}

const char *hk_mesh_add_skin(hk_mesh *m, size_t tetrahedra[2]) {
  size_t faces = 4 * m->tetrahedra;
  face *list = malloc((faces + 1) * sizeof *list);
  const char *wrong = "no memory for the faces";
  tetrahedra[0] = tetrahedra[1] = 0;
  if (list && hk_mesh_grow(&m->triangle, &m->triangle_capacity, m->triangles + faces, sizeof *m->triangle)) {
    list_faces(m, list);
    wrong = add_outer(m, list, faces, tetrahedra);
  }
  free(list);
  return wrong;
}

const char *hk_mesh_drop_loose(hk_mesh *m) {
  uint32_t *next = calloc(m->vertices + 1, sizeof *next), kept = 0;
  if (!next) return "no memory";
  for (size_t k = 0; k < 4 * m->tetrahedra; k++) next[m->tetrahedron[k / 4][k % 4]] = 1;
  for (size_t i = 0; i < m->vertices; i++) {
    if (!next[i]) continue;
    memmove(m->vertex + 3 * (size_t)kept, m->vertex + 3 * i, 3 * sizeof *m->vertex);
    next[i] = kept++;
  }
  for (size_t k = 0; k < 4 * m->tetrahedra; k++) m->tetrahedron[k / 4][k % 4] = next[m->tetrahedron[k / 4][k % 4]];
  m->vertices = kept;
  free(next);
  return NULL;
}
