/* Neighbours are listed once, from the triangles: of a closed surface each edge a to b is in one triangle in this
 * direction. */
#include "plugins/common/particle_surface/mesh_smoothing.h"
#include "plugins/common/particle_surface/particle_average.h"
#include "plugins/common/particle_surface/particle_field.h"

#include <string.h>

enum { GRAIN = 256 };

static const double full = 13, support = 4; /* neighbours of a particle in a full liquid; radii */

/* ---- weights ---- */

typedef struct counting {
  const hk_particle_field *near;
  double *weight; /* n */
} counting;

static void count_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const counting *t = context;
  const hk_particle_field *f = t->near;
  double scale = 1 / (f->o.reach * f->o.reach);
  (void)chunk;
  for (size_t i = begin; i < end; i++) {
    size_t block = hk_particle_field_block(f, f->x[i]);
    double sum = -1; /* itself */
    for (size_t n = f->start[block]; n < f->start[block + 1]; n++) {
      const double *a = f->x[i], *b = f->x[f->list[n]];
      double d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
      double w = 1 - (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) * scale;
      sum += w > 0 ? w : 0;
    }
    double part = sum < full ? fmax(sum, 0) / full : 1;
    t->weight[i] = part * part * (3 - 2 * part);
  }
}

hk_status hk_smoothing_weights(const hk_host *host, const double (*x)[3], size_t n, double radius,
                               const hk_isosurface *s, double *weight) {
  hk_particle_surface_options o = {.radius = radius, .reach = support * radius};
  hk_particle_field near = {.host = host, .x = x, .n = n, .o = o};
  counting t = {&near, host->allocate(host, n * sizeof *t.weight)};
  hk_particle_values values = {x, n, t.weight, 1};
  hk_status status =
      t.weight ? HK_OK : host->fail(host, HK_NO_MEMORY, "surface of particles: no memory for %zu particles", n);
  if (status == HK_OK) status = hk_particle_field_open(&near);
  if (status == HK_OK) host->parallel_for(host, n, GRAIN, count_chunk, &t);
  hk_particle_field_close(&near);
  if (status == HK_OK) status = hk_particle_average(host, &values, &o, (const double(*)[3])s->x, s->vertices, weight);
  host->release(host, t.weight);
  return status;
}

/* ---- rounds ---- */

typedef struct smoothing {
  size_t *start;       /* vertices + 1 */
  uint32_t *neighbour; /* 3 triangles: those of vertex v from start[v] to start[v + 1] - 1 */
  const double *weight;
  double (*from)[3], (*to)[3], (*spare)[3];
} smoothing;

static void list_neighbours(smoothing *t, const hk_isosurface *s) {
  size_t sum = 0;
  memset(t->start, 0, (s->vertices + 2) * sizeof *t->start);
  for (size_t k = 0; k < 3 * s->triangles; k++) t->start[s->triangle[k / 3][k % 3] + 1]++;
  for (size_t v = 0; v < s->vertices; v++) {
    size_t count = t->start[v + 1];
    t->start[v + 1] = sum;
    sum += count;
  }
  for (size_t k = 0; k < 3 * s->triangles; k++)
    t->neighbour[t->start[s->triangle[k / 3][k % 3] + 1]++] = s->triangle[k / 3][(k + 1) % 3];
}

static void move_chunk(void *context, size_t begin, size_t end, size_t chunk) {
  const smoothing *t = context;
  (void)chunk;
  for (size_t v = begin; v < end; v++) {
    double sum[3] = {0}, part = t->weight[v], count = (double)(t->start[v + 1] - t->start[v]);
    for (size_t k = t->start[v]; k < t->start[v + 1]; k++)
      for (int c = 0; c < 3; c++) sum[c] += t->from[t->neighbour[k]][c];
    for (int c = 0; c < 3; c++) t->to[v][c] = t->from[v][c] + part * (sum[c] / count - t->from[v][c]);
  }
}

static void make_normals(hk_isosurface *s) {
  memset(s->normal, 0, s->vertices * sizeof *s->normal);
  for (size_t k = 0; k < s->triangles; k++) {
    const double *a = s->x[s->triangle[k][0]], *b = s->x[s->triangle[k][1]], *c = s->x[s->triangle[k][2]];
    double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    double area[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    for (int e = 0; e < 9; e++) s->normal[s->triangle[k][e / 3]][e % 3] += area[e % 3];
  }
  for (size_t v = 0; v < s->vertices; v++) {
    double *n = s->normal[v], size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int c = 0; c < 3; c++) n[c] = size > 0 ? n[c] / size : c == 2;
  }
}

hk_status hk_mesh_smooth(hk_isosurface *s, const hk_host *host, const double *weight, unsigned rounds) {
  smoothing t = {.weight = weight, .from = s->x};
  if (rounds == 0 || s->vertices == 0) return HK_OK;
  t.start = host->allocate(host, (s->vertices + 2) * sizeof *t.start);
  t.neighbour = host->allocate(host, 3 * s->triangles * sizeof *t.neighbour);
  t.spare = t.to = host->allocate(host, s->vertices * sizeof *t.to);
  bool fine = t.start && t.neighbour && t.spare;
  if (fine) list_neighbours(&t, s);
  for (unsigned round = 0; round < rounds && fine; round++) {
    double(*last)[3] = t.from;
    host->parallel_for(host, s->vertices, GRAIN, move_chunk, &t);
    t.from = t.to, t.to = last;
  }
  if (fine && t.from != s->x) memcpy(s->x, t.from, s->vertices * sizeof *s->x);
  if (fine && s->normal) make_normals(s);
  host->release(host, t.start);
  host->release(host, t.neighbour);
  host->release(host, t.spare);
  if (fine) return HK_OK;
  return host->fail(host, HK_NO_MEMORY, "surface of particles: no memory to smooth %zu vertices", s->vertices);
}
