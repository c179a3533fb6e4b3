#include "plugins/common/normals/corner_normals.h"

#include <math.h>
#include <string.h>

static const float crease = 0.766f; /* cos 40 degrees */

hk_status hk_corner_normals_reserve(hk_corner_normals *c, const hk_host *host, size_t vertices, size_t faces) {
  if (vertices < c->vertices && faces < c->faces) return HK_OK;
  hk_corner_normals_free(c, host);
  c->vertices = vertices + vertices / 2 + 1, c->faces = faces + faces / 2 + 1;
  c->start = host->allocate(host, (c->vertices + 1) * sizeof *c->start);
  c->user = host->allocate(host, 3 * c->faces * sizeof *c->user);
  c->face = host->allocate(host, c->faces * sizeof *c->face);
  if (c->start && c->user && c->face) return HK_OK;
  c->vertices = c->faces = 0;
  return host->fail(host, HK_NO_MEMORY, "no memory for the normals of %zu triangles", faces);
}

void hk_corner_normals_free(hk_corner_normals *c, const hk_host *host) {
  host->release(host, c->start);
  host->release(host, c->user);
  host->release(host, c->face);
  *c = (hk_corner_normals){0};
}

static void list_users(hk_corner_normals *c, size_t vertices, const uint32_t (*face)[3], size_t faces) {
  memset(c->start, 0, (vertices + 1) * sizeof *c->start);
  for (size_t k = 0; k < 3 * faces; k++) c->start[face[k / 3][k % 3] + 1]++;
  for (size_t v = 0; v < vertices; v++) c->start[v + 1] += c->start[v];
  for (size_t k = 3 * faces; k-- > 0;) c->user[--c->start[face[k / 3][k % 3] + 1]] = (uint32_t)k;
  for (size_t v = 0; v < vertices; v++) c->start[v] = c->start[v + 1];
  c->start[vertices] = (uint32_t)(3 * faces);
}

static void face_normal(const float (*x)[3], const uint32_t face[3], float n[3]) {
  const float *a = x[face[0]], *b = x[face[1]], *c = x[face[2]];
  float u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  n[0] = u[1] * v[2] - u[2] * v[1], n[1] = u[2] * v[0] - u[0] * v[2], n[2] = u[0] * v[1] - u[1] * v[0];
}

static float dot(const float a[3], const float b[3]) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/* To the order of 1: squares of small areas underflow. */
static void shorten(float n[3]) {
  float most = fmaxf(fabsf(n[0]), fmaxf(fabsf(n[1]), fabsf(n[2])));
  for (int c = 0; most > 0 && c < 3; c++) n[c] /= most;
}

void hk_corner_normals_find(hk_corner_normals *c, const float (*x)[3], size_t vertices, const uint32_t (*face)[3],
                            size_t faces, float (*normal)[3]) {
  list_users(c, vertices, face, faces);
  for (size_t k = 0; k < faces; k++) face_normal(x, face[k], c->face[k]);
  for (size_t k = 0; k < 3 * faces; k++) {
    const float *own = c->face[k / 3];
    uint32_t v = face[k / 3][k % 3];
    memset(normal[k], 0, sizeof normal[k]);
    for (uint32_t u = c->start[v]; u < c->start[v + 1]; u++) {
      const float *other = c->face[c->user[u] / 3];
      bool same = c->user[u] / 3 == k / 3, smooth = dot(own, other) > crease * sqrtf(dot(own, own) * dot(other, other));
      for (int d = 0; (same || smooth) && d < 3; d++) normal[k][d] += other[d];
    }
    shorten(normal[k]);
  }
}
