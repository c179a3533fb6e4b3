/* A host without a plugin, and what is asked of every surface: each vertex has one closed ring of triangles around it,
 * by which each edge is in exactly two triangles of opposite direction; Euler's number of each component; area and
 * volume. */
#ifndef HK_TEST_SURFACE_CHECK_H
#define HK_TEST_SURFACE_CHECK_H

#include "plugins/common/isosurface/isosurface.h"
#include "core/engine/host/host.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef struct bench {
  hk_instance instance;
  hk_plugin plugin;
  hk_shared shared;
  hk_error error;
  hk_isosurface surface;
} bench;

static inline const hk_host *open_bench(bench *b, int threads) {
  *b = (bench){.plugin = {.kind = HK_SERVICE}};
  b->shared = (hk_shared){
      .error = &b->error, .threads = hk_threads_create(threads), .allocations_left = -1, .lanes = hk_processor_lanes()};
  assert_non_null(b->shared.threads);
  b->instance =
      (hk_instance){.host = hk_host_table, .shared = &b->shared, .plugin = &b->plugin, .label = "surface", .where = ""};
  return &b->instance.host;
}

static inline void close_bench(bench *b) {
  hk_isosurface_free(&b->surface, &b->instance.host);
  hk_memory_clear(&b->instance.blocks);
  hk_threads_destroy(b->shared.threads);
}

/* ---- topology ---- */

typedef struct rings { /* of vertex v: the triangles (v, from, to) with numbers from begin[v] to begin[v + 1] */
  size_t *begin;
  uint32_t (*edge)[2];
} rings;

static inline rings find_rings(const hk_isosurface *s) {
  rings r = {calloc(s->vertices + 2, sizeof *r.begin), malloc(3 * s->triangles * sizeof *r.edge)};
  assert_true(r.begin && r.edge);
  for (size_t k = 0; k < 3 * s->triangles; k++) {
    assert_true(s->triangle[k / 3][k % 3] < s->vertices);
    r.begin[s->triangle[k / 3][k % 3] + 2]++;
  }
  for (size_t v = 2; v < s->vertices + 2; v++) r.begin[v] += r.begin[v - 1];
  for (size_t k = 0; k < 3 * s->triangles; k++) {
    const uint32_t *t = s->triangle[k / 3];
    size_t at = r.begin[t[k % 3] + 1]++;
    r.edge[at][0] = t[(k + 1) % 3], r.edge[at][1] = t[(k + 2) % 3];
  }
  return r;
}

/* The vertices around which triangles do not form one closed ring. */
static inline size_t count_broken(const hk_isosurface *s) {
  rings r = find_rings(s);
  size_t broken = 0;
  for (size_t v = 0; v < s->vertices; v++) {
    size_t first = r.begin[v], end = r.begin[v + 1], length = 0, at = first, next = end;
    bool good = end >= first + 3;
    for (size_t k = first; k < end; k++) good = good && r.edge[k][0] != v && r.edge[k][1] != r.edge[k][0];
    while (good && length < end - first) {
      size_t matches = 0;
      for (size_t k = first; k < end; k++)
        if (r.edge[k][0] == r.edge[at][1]) next = k, matches++;
      good = matches == 1;
      at = next, length++;
      if (at == first) break;
    }
    broken += !good || at != first || length != end - first;
  }
  free(r.begin);
  free(r.edge);
  return broken;
}

static inline uint32_t root_of(uint32_t *parent, uint32_t v) {
  while (parent[v] != v) v = parent[v] = parent[parent[v]];
  return v;
}

/* V - E + F of each component goes to euler, in the order of their first vertices; returns how many there are. */
static inline size_t find_components(const hk_isosurface *s, long *euler, size_t most) {
  uint32_t *parent = malloc(s->vertices * sizeof *parent);
  long *twice = calloc(s->vertices, sizeof *twice); /* 2 V - F, as E = 3/2 F */
  size_t count = 0;
  assert_true(parent && twice);
  for (uint32_t v = 0; v < s->vertices; v++) parent[v] = v;
  for (size_t k = 0; k < s->triangles; k++)
    for (int c = 1; c < 3; c++) {
      uint32_t a = root_of(parent, s->triangle[k][0]), b = root_of(parent, s->triangle[k][c]);
      parent[a > b ? a : b] = a > b ? b : a;
    }
  for (size_t v = 0; v < s->vertices; v++) twice[root_of(parent, (uint32_t)v)] += 2;
  for (size_t k = 0; k < s->triangles; k++) twice[root_of(parent, s->triangle[k][0])]--;
  for (size_t v = 0; v < s->vertices; v++)
    if (parent[v] == v && count++ < most) euler[count - 1] = twice[v] / 2;
  free(parent);
  free(twice);
  return count;
}

/* ---- geometry ---- */

static inline void triangle_normal(const hk_isosurface *s, size_t k, double n[3]) { /* as long as twice its area */
  const double *a = s->x[s->triangle[k][0]], *b = s->x[s->triangle[k][1]], *c = s->x[s->triangle[k][2]];
  double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
  n[0] = u[1] * v[2] - u[2] * v[1], n[1] = u[2] * v[0] - u[0] * v[2], n[2] = u[0] * v[1] - u[1] * v[0];
}

static inline double surface_area(const hk_isosurface *s) {
  double sum = 0, n[3];
  for (size_t k = 0; k < s->triangles; k++) {
    triangle_normal(s, k, n);
    sum += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
  }
  return sum;
}

static inline double surface_volume(const hk_isosurface *s) {
  double sum = 0, n[3];
  for (size_t k = 0; k < s->triangles; k++) {
    const double *a = s->x[s->triangle[k][0]];
    triangle_normal(s, k, n);
    sum += (a[0] * n[0] + a[1] * n[1] + a[2] * n[2]) / 6;
  }
  return sum;
}

/* Of the lengths of normals from 1; INFINITY: one is not finite. Rounding is 4e-16. */
static inline double normals_off(const hk_isosurface *s) {
  double most = 0;
  for (size_t v = 0; v < s->vertices; v++) {
    const double *n = s->normal[v];
    double off = fabs(sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) - 1);
    most = off <= most ? most : off < INFINITY ? off : INFINITY;
  }
  return most;
}

#endif
