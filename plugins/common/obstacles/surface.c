#include "plugins/common/obstacles/surface.h"
#include "plugins/kit/vector3.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- taking the lists ---- */

static hk_status allocate(hk_surface *s, const hk_host *host) {
  s->vertex = host->allocate(host, 3 * s->vertices * sizeof *s->vertex);
  s->face = host->allocate(host, s->faces * sizeof *s->face);
  s->face_normal = host->allocate(host, s->faces * sizeof *s->face_normal);
  s->edge_normal = host->allocate(host, s->faces * sizeof *s->edge_normal);
  s->vertex_normal = host->allocate(host, s->vertices * sizeof *s->vertex_normal);
  s->box = host->allocate(host, s->faces * sizeof *s->box);
  bool fine = s->vertex && s->face && s->face_normal && s->edge_normal && s->vertex_normal && s->box;
  return fine ? HK_OK : host->fail(host, HK_NO_MEMORY, "no memory for a surface of %zu triangles", s->faces);
}

static hk_status take_faces(hk_surface *s, const hk_host *host, const double *corner, const char *file) {
  for (size_t k = 0; k < 3 * s->faces; k++) {
    if (!(corner[k] >= 1 && corner[k] <= (double)s->vertices && corner[k] == floor(corner[k])))
      return host->fail(host, HK_BAD_PARAM, "faces: %s: triangle %zu names vertex %g of %zu", file, k / 3 + 1,
                        corner[k], s->vertices);
    s->face[k / 3][k % 3] = (uint32_t)corner[k] - 1;
  }
  return HK_OK;
}

/* ---- is it closed? ---- */

typedef struct side {
  uint32_t low, high; /* corners */
  uint32_t face, edge;
  bool rising; /* from low to high */
} side;

static int by_corners(const void *left, const void *right) {
  const side *a = left, *b = right;
  if (a->low != b->low) return a->low < b->low ? -1 : 1;
  if (a->high != b->high) return a->high < b->high ? -1 : 1;
  return (a->face > b->face) - (a->face < b->face);
}

static void list_sides(const hk_surface *s, side *sides) {
  for (size_t k = 0; k < 3 * s->faces; k++) {
    uint32_t a = s->face[k / 3][k % 3], b = s->face[k / 3][(k + 1) % 3];
    sides[k] = (side){a < b ? a : b, a < b ? b : a, (uint32_t)(k / 3), (uint32_t)(k % 3), a < b};
  }
  qsort(sides, 3 * s->faces, sizeof *sides, by_corners);
}

/* An edge has two faces, which run along it in opposite directions. */
static size_t find_open(const hk_surface *s, const side *sides, char *text, size_t room) {
  size_t open = 0, used = 0, count = 3 * s->faces;
  for (size_t k = 0, next; k < count; k = next) {
    for (next = k + 1; next < count && sides[next].low == sides[k].low && sides[next].high == sides[k].high;) next++;
    if (next - k == 2 && sides[k].rising != sides[k + 1].rising) continue;
    if (open++ < 5)
      used += (size_t)snprintf(text + used, room - used, "%s%u-%u (%zu %s)", used ? ", " : "", sides[k].low + 1,
                               sides[k].high + 1, next - k,
                               next - k == 1   ? "face"
                               : next - k == 2 ? "faces that face opposite ways"
                                               : "faces");
  }
  return open;
}

/* ---- normals ---- */

static double between(const double u[3], const double v[3]) {
  double cross[3];
  hk_cross(cross, u, v);
  return atan2(hk_length(cross), hk_dot(u, v));
}

static const double *corner(const hk_surface *s, size_t f, unsigned c) {
  return s->vertex + 3 * (size_t)s->face[f][c % 3];
}

static bool find_face_normal(hk_surface *s, size_t f) {
  double u[3], v[3], *n = s->face_normal[f];
  hk_subtract(u, corner(s, f, 1), corner(s, f, 0));
  hk_subtract(v, corner(s, f, 2), corner(s, f, 0));
  hk_cross(n, u, v);
  double length = hk_length(n);
  for (int c = 0; c < 3; c++) n[c] /= length;
  return length > 0;
}

static void add_to_corners(hk_surface *s, size_t f) {
  for (unsigned c = 0; c < 3; c++) {
    double u[3], v[3];
    hk_subtract(u, corner(s, f, c + 1), corner(s, f, c));
    hk_subtract(v, corner(s, f, c + 2), corner(s, f, c));
    hk_add_scaled(s->vertex_normal[s->face[f][c]], between(u, v), s->face_normal[f]);
  }
}

static void find_edge_normals(hk_surface *s, const side *sides) {
  for (size_t k = 0; k < 3 * s->faces; k += 2)
    for (int q = 0; q < 2; q++)
      for (int c = 0; c < 3; c++)
        s->edge_normal[sides[k + (size_t)q].face][sides[k + (size_t)q].edge][c] =
            s->face_normal[sides[k].face][c] + s->face_normal[sides[k + 1].face][c];
}

/* Six times the volume: negative where faces are clockwise, seen from outside. */
static double volume(const hk_surface *s) {
  double sum = 0, cross[3];
  for (size_t f = 0; f < s->faces; f++) {
    hk_cross(cross, corner(s, f, 1), corner(s, f, 2));
    sum += hk_dot(corner(s, f, 0), cross);
  }
  return sum;
}

static void turn_inside_out(hk_surface *s) {
  for (size_t f = 0; f < s->faces; f++) {
    uint32_t kept = s->face[f][1];
    s->face[f][1] = s->face[f][2];
    s->face[f][2] = kept;
  }
}

static void find_boxes(hk_surface *s) {
  hk_box all = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
  for (size_t f = 0; f < s->faces; f++)
    for (int c = 0; c < 3; c++) {
      double x = corner(s, f, 0)[c], y = corner(s, f, 1)[c], z = corner(s, f, 2)[c];
      s->box[f].low[c] = fmin(x, fmin(y, z));
      s->box[f].high[c] = fmax(x, fmax(y, z));
      all.low[c] = fmin(all.low[c], s->box[f].low[c]);
      all.high[c] = fmax(all.high[c], s->box[f].high[c]);
    }
  for (int c = 0; c < 3; c++) s->size = fmax(s->size, all.high[c] - all.low[c]);
}

static hk_status find_normals(hk_surface *s, const hk_host *host, side *sides, const char *file) {
  char text[400] = "";
  list_sides(s, sides);
  size_t open = find_open(s, sides, text, sizeof text);
  if (open)
    return host->fail(host, HK_BAD_PARAM,
                      "%s is not closed, so it has no inside: %zu edges, between vertices %s%s; close "
                      "the holes and turn all faces outward",
                      file, open, text, open > 5 ? ", ..." : "");
  if (s->faces < 4) return host->fail(host, HK_BAD_PARAM, "%s: %zu triangles enclose nothing", file, s->faces);
  if (volume(s) < 0) {
    turn_inside_out(s);
    list_sides(s, sides);
  }
  for (size_t f = 0; f < s->faces; f++)
    if (!find_face_normal(s, f)) return host->fail(host, HK_BAD_PARAM, "%s: triangle %zu has no area", file, f + 1);
  for (size_t f = 0; f < s->faces; f++) add_to_corners(s, f);
  find_edge_normals(s, sides);
  return HK_OK;
}

hk_status hk_surface_open(hk_surface *s, const hk_host *host, const hk_numbers *vertices, const hk_numbers *faces,
                          const char *file) {
  *s = (hk_surface){.vertices = vertices->count / 3, .faces = faces->count / 3};
  if (s->vertices < 3 || s->faces < 1 || vertices->count % 3 || faces->count % 3 || s->faces > UINT32_MAX / 3)
    return host->fail(host, HK_BAD_PARAM,
                      "%s: %zu coordinates and %zu corners are no closed surface: `vertices` takes x1, "
                      "y1, z1, x2, ..., `faces` three vertices a triangle, from 1",
                      file, vertices->count, faces->count);
  s->trees = host->query(host, HK_BVH_INTERFACE);
  if (!s->trees) return HK_FAILED;
  hk_status status = allocate(s, host);
  if (status != HK_OK) return status;
  memcpy(s->vertex, vertices->value, 3 * s->vertices * sizeof *s->vertex);
  status = take_faces(s, host, faces->value, file);
  side *sides = status == HK_OK ? host->allocate(host, 3 * s->faces * sizeof *sides) : NULL;
  if (status == HK_OK && !sides) return host->fail(host, HK_NO_MEMORY, "no memory for a surface");
  if (status == HK_OK) status = find_normals(s, host, sides, file);
  host->release(host, sides);
  if (status != HK_OK) return status;
  find_boxes(s);
  return s->trees->build(s->trees->self, s->box, s->faces, &s->tree);
}

/* ---- distance ---- */

typedef struct nearest {
  const hk_surface *s;
  const double *p;
  double at[3];
  const double *normal; /* of the face, edge or corner */
} nearest;

/* The point of a triangle nearest to p (Ericson 2005, Real-Time Collision Detection, 5.1.5), and what it lies on. */
static const double *nearest_point(const hk_surface *s, uint32_t f, const double p[3], double at[3]) {
  const double *a = corner(s, f, 0), *b = corner(s, f, 1), *c = corner(s, f, 2);
  double ab[3], ac[3], d[3];
  hk_subtract(ab, b, a);
  hk_subtract(ac, c, a);
  hk_subtract(d, p, a);
  double d1 = hk_dot(ab, d), d2 = hk_dot(ac, d);
  hk_copy(at, a);
  if (d1 <= 0 && d2 <= 0) return s->vertex_normal[s->face[f][0]];
  hk_subtract(d, p, b);
  double d3 = hk_dot(ab, d), d4 = hk_dot(ac, d);
  if (d3 >= 0 && d4 <= d3) return hk_copy(at, b), s->vertex_normal[s->face[f][1]];
  double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return hk_add_scaled(at, d1 / (d1 - d3), ab), s->edge_normal[f][0];
  hk_subtract(d, p, c);
  double d5 = hk_dot(ab, d), d6 = hk_dot(ac, d);
  if (d6 >= 0 && d5 <= d6) return hk_copy(at, c), s->vertex_normal[s->face[f][2]];
  double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return hk_add_scaled(at, d2 / (d2 - d6), ac), s->edge_normal[f][2];
  double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    double bc[3];
    hk_subtract(bc, c, b);
    hk_copy(at, b);
    return hk_add_scaled(at, (d4 - d3) / ((d4 - d3) + (d5 - d6)), bc), s->edge_normal[f][1];
  }
  hk_add_scaled(at, vb / (va + vb + vc), ab);
  hk_add_scaled(at, vc / (va + vb + vc), ac);
  return s->face_normal[f];
}

static double try_face(void *context, uint32_t f, double best2) {
  nearest *found = context;
  double at[3], d[3];
  const double *normal = nearest_point(found->s, f, found->p, at);
  hk_subtract(d, found->p, at);
  double d2 = hk_dot(d, d);
  if (!(d2 < best2)) return INFINITY;
  found->normal = normal;
  hk_copy(found->at, at);
  return d2;
}

/* On the surface, where the direction to it is lost in rounding, the normal of the feature stands for it. */
double hk_surface_distance(const hk_surface *s, const double p[3], double n[3]) {
  nearest found = {.s = s, .p = p};
  double d[3], length = sqrt(hk_bvh_nearest(s->tree, p, INFINITY, try_face, &found));
  hk_subtract(d, p, found.at);
  double sign = hk_dot(d, found.normal) < 0 ? -1 : 1;
  bool on_it = length < 1e-9 * s->size;
  double scale = on_it ? 1 / hk_length(found.normal) : sign / length;
  for (int c = 0; c < 3; c++) n[c] = scale * (on_it ? found.normal[c] : d[c]);
  return sign * length;
}
