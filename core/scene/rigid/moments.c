/* Mass, centre and second moments of solids of density 1, of points, and of what a mesh encloses: for every triangle
 * the tetrahedron between it and a reference point, with the sign of its volume V. With the corners a, b, c seen from
 * there, and s = a + b + c, the tetrahedron's integrals are
 *     V = a.(b x c)/6,   int y = V s/4,   int y y^T = V (a a^T + b b^T + c c^T + s s^T)/20
 * (Tonon, Explicit exact formulas for the 3-D tetrahedron inertia tensor, J. Mathematics and Statistics 1 (2005) 8).
 * The reference point is the mean of the vertices, so that a mesh far from the origin loses no digits. */
#include "core/scene/rigid/rigid.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static hk_moments about_origin(double mass, double x, double y, double z) {
  return (hk_moments){.mass = mass, .second = {mass * x, 0, 0, 0, mass * y, 0, 0, 0, mass * z}};
}

hk_moments hk_moments_of_sphere(double r) {
  double each = r * r / 5;
  return about_origin(4 * pi / 3 * r * r * r, each, each, each);
}

hk_moments hk_moments_of_box(const double size[3]) {
  return about_origin(size[0] * size[1] * size[2], size[0] * size[0] / 12, size[1] * size[1] / 12,
                      size[2] * size[2] / 12);
}

hk_moments hk_moments_of_cylinder(double r, double length) {
  return about_origin(pi * r * r * length, r * r / 4, r * r / 4, length * length / 12);
}

/* The ends are half balls, whose centre of mass lies 3 r/8 from their flat side. */
hk_moments hk_moments_of_capsule(double r, double length) {
  double middle = pi * r * r * length, ends = 4 * pi / 3 * r * r * r, half = length / 2;
  double across = middle * r * r / 4 + ends * r * r / 5;
  double along = middle * length * length / 12 + ends * (r * r / 5 + 3 * r * half / 4 + half * half);
  return (hk_moments){.mass = middle + ends, .second = {across, 0, 0, 0, across, 0, 0, 0, along}};
}

void hk_moments_scale(hk_moments *m, double by) {
  m->mass *= by;
  for (int k = 0; k < 9; k++) m->second[k] *= by;
}

/* ---- points ---- */

hk_moments hk_moments_of_points(size_t count, const double *x, const double *mass) {
  hk_moments m = {0};
  for (size_t i = 0; i < count; i++) m.mass += mass[i];
  for (size_t i = 0; i < count; i++)
    for (size_t c = 0; c < 3; c++) m.center[c] += mass[i] / m.mass * x[3 * i + c];
  for (size_t i = 0; i < count; i++)
    for (size_t p = 0; p < 9; p++)
      m.second[p] += mass[i] * (x[3 * i + p / 3] - m.center[p / 3]) * (x[3 * i + p % 3] - m.center[p % 3]);
  return m;
}

/* R S R^T */
static void turn_second(const double R[9], const double S[9], double to[9]) {
  for (int p = 0; p < 9; p++) {
    to[p] = 0;
    for (int q = 0; q < 9; q++) to[p] += R[p / 3 * 3 + q / 3] * S[q] * R[p % 3 * 3 + q % 3];
  }
}

/* Steiner's theorem: both are moved to the common centre. */
void hk_moments_add(hk_moments *sum, const hk_moments *part, const double x[3], const double R[9]) {
  double all = sum->mass + part->mass, apart[3], S[9];
  turn_second(R, part->second, S);
  for (int c = 0; c < 3; c++) {
    const double *row = R + 3 * c;
    apart[c] = x[c] + row[0] * part->center[0] + row[1] * part->center[1] + row[2] * part->center[2] - sum->center[c];
  }
  double reduced = sum->mass * part->mass / all;
  for (int p = 0; p < 9; p++) sum->second[p] += S[p] + reduced * apart[p / 3] * apart[p % 3];
  for (int c = 0; c < 3; c++) sum->center[c] += part->mass / all * apart[c];
  sum->mass = all;
}

/* ---- inertia ---- */

/* The principal minors of a symmetric matrix are not below 0, within rounding. */
static bool is_positive(const double S[9]) {
  double scale = fabs(S[0]) + fabs(S[4]) + fabs(S[8]), least = -1e-9 * scale;
  double xy = S[0] * S[4] - S[1] * S[1], yz = S[4] * S[8] - S[5] * S[5], zx = S[8] * S[0] - S[2] * S[2];
  double all = S[0] * yz - S[1] * (S[1] * S[8] - S[5] * S[2]) + S[2] * (S[1] * S[5] - S[4] * S[2]);
  bool fine = S[0] >= least && S[4] >= least && S[8] >= least;
  return fine && xy >= least * scale && yz >= least * scale && zx >= least * scale && all >= least * scale * scale;
}

const char *hk_moments_set_inertia(hk_moments *m, const double I[9], char text[HK_RIGID_TEXT]) {
  double S[9], half = (I[0] + I[4] + I[8]) / 2, size = fabs(I[0]) + fabs(I[4]) + fabs(I[8]);
  for (int p = 0; p < 9; p++) {
    if (!isfinite(I[p])) return "the moments of inertia are not finite";
    if (!(fabs(I[p] - I[p % 3 * 3 + p / 3]) <= 1e-9 * size)) return "the matrix of inertia is not symmetric";
    S[p] = (p % 4 == 0 ? half : 0) - (I[p] + I[p % 3 * 3 + p / 3]) / 2;
  }
  if (!is_positive(S)) {
    snprintf(text, HK_RIGID_TEXT,
             "no body has the moments of inertia %g, %g, %g kg m^2: none can be below 0, or above the sum of the two "
             "others",
             I[0], I[4], I[8]);
    return text;
  }
  memcpy(m->second, S, sizeof S);
  return NULL;
}

/* ---- meshes ---- */

typedef struct edge {
  uint32_t low, high, triangle;
  bool upwards; /* the triangle runs from `low` to `high` */
} edge;

static int by_vertices(const void *left, const void *right) {
  const edge *a = left, *b = right;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  if (a->high != b->high) return a->high < b->high ? -1 : 1;
  return (a->triangle > b->triangle) - (a->triangle < b->triangle);
}

static const char *wrong_edge(const edge *e, size_t count, char text[HK_RIGID_TEXT]) {
  unsigned low = e->low + 1, high = e->high + 1;
  if (count == 1)
    snprintf(text, HK_RIGID_TEXT,
             "the surface is open: the edge between vertices %u and %u belongs to one triangle; close the hole", low,
             high);
  else if (count > 2)
    snprintf(text, HK_RIGID_TEXT,
             "the surface encloses no volume of one kind: the edge between vertices %u and %u belongs to %zu triangles",
             low, high, count);
  else
    snprintf(text, HK_RIGID_TEXT,
             "triangles %u and %u at the edge between vertices %u and %u face opposite sides: reverse the corners of "
             "one of them",
             e[0].triangle + 1, e[1].triangle + 1, low, high);
  return text;
}

static const char *check_closed(const hk_mesh *m, char text[HK_RIGID_TEXT]) {
  const char *wrong = NULL;
  size_t edges = 3 * m->triangles, next;
  edge *list = malloc((edges + 1) * sizeof *list);
  if (!list) return "no memory for the edges of the mesh";
  for (size_t k = 0; k < edges; k++) {
    const uint32_t *corner = m->triangle[k / 3];
    uint32_t a = corner[k % 3], b = corner[(k + 1) % 3];
    list[k] = (edge){a < b ? a : b, a < b ? b : a, (uint32_t)(k / 3), a < b};
  }
  qsort(list, edges, sizeof *list, by_vertices);
  for (size_t k = 0; k < edges && !wrong; k = next) {
    for (next = k + 1; next < edges && list[next].low == list[k].low && list[next].high == list[k].high;) next++;
    if (next - k != 2 || list[k].upwards == list[k + 1].upwards) wrong = wrong_edge(list + k, next - k, text);
  }
  free(list);
  return wrong;
}

static void add_tetrahedron(hk_moments *m, const double corner[3][3]) {
  const double *a = corner[0], *b = corner[1], *c = corner[2];
  double V =
      (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])) /
      6;
  double s[3] = {a[0] + b[0] + c[0], a[1] + b[1] + c[1], a[2] + b[2] + c[2]};
  m->mass += V;
  for (int k = 0; k < 3; k++) m->center[k] += V * s[k] / 4;
  for (int p = 0; p < 9; p++) {
    int i = p / 3, j = p % 3;
    m->second[p] += V * (a[i] * a[j] + b[i] * b[j] + c[i] * c[j] + s[i] * s[j]) / 20;
  }
}

const char *hk_moments_of_mesh(const hk_mesh *mesh, hk_moments *m, char text[HK_RIGID_TEXT]) {
  double mean[3] = {0}, size = 0;
  if (mesh->triangles == 0) return "the mesh has no triangles";
  const char *wrong = check_closed(mesh, text);
  if (wrong) return wrong;
  *m = (hk_moments){0};
  for (size_t k = 0; k < 3 * mesh->vertices; k++) mean[k % 3] += mesh->vertex[k] / (double)mesh->vertices;
  for (size_t k = 0; k < 3 * mesh->vertices; k++) size = fmax(size, fabs(mesh->vertex[k] - mean[k % 3]));
  for (size_t t = 0; t < mesh->triangles; t++) {
    double corner[3][3];
    for (size_t k = 0; k < 9; k++)
      corner[k / 3][k % 3] = mesh->vertex[3 * (size_t)mesh->triangle[t][k / 3] + k % 3] - mean[k % 3];
    add_tetrahedron(m, (const double(*)[3])corner);
  }
  if (!(m->mass > 1e-12 * size * size * size)) {
    snprintf(text, HK_RIGID_TEXT, "the volume is %.4g m^3: %s", m->mass,
             m->mass < 0 ? "the triangles face inwards; reverse the order of their corners"
                         : "the surface is flat, and encloses nothing");
    return text;
  }
  for (int c = 0; c < 3; c++) m->center[c] /= m->mass;
  for (int p = 0; p < 9; p++) m->second[p] -= m->mass * m->center[p / 3] * m->center[p % 3];
  for (int c = 0; c < 3; c++) m->center[c] += mean[c];
  return NULL;
}
