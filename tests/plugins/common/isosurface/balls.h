/* A ball as a field, with bounds and faults to order, on a box from -1 to 1; and whether two surfaces are the same. */
#ifndef HK_TEST_BALLS_H
#define HK_TEST_BALLS_H

#include "tests/plugins/common/isosurface/surface_check.h"

typedef struct counted { /* a sphere around `place`, and how often it was asked; on one thread */
  double place[3], radius;
  double hole; /* the field is NAN where x is above */
  bool liar;   /* bounds leave out all blocks above the middle */
  size_t *asked;
} counted;

static inline void counted_sphere(const void *self, const double (*x)[3], size_t count, double *value) {
  const counted *s = self;
  for (size_t k = 0; k < count; k++) {
    double d[3] = {x[k][0] - s->place[0], x[k][1] - s->place[1], x[k][2] - s->place[2]};
    value[k] = s->radius - sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    if (s->hole > 0 && x[k][0] > s->hole) value[k] = NAN;
  }
  if (s->asked) *s->asked += count;
}

/* By the nearest and the farthest place of the box, a rounding wider. */
static inline void sphere_bounds(const void *self, const double low[3], const double high[3], double range[2]) {
  const counted *s = self;
  double nearest = 0, farthest = 0;
  for (int c = 0; c < 3; c++) {
    double below = s->place[c] - low[c], above = high[c] - s->place[c], far = fmax(fabs(below), fabs(above));
    double near = below < 0 ? -below : above < 0 ? -above : 0;
    nearest += near * near, farthest += far * far;
  }
  range[0] = s->radius - sqrt(farthest) - 1e-12, range[1] = s->radius - sqrt(nearest) + 1e-12;
  if (s->liar && low[2] > s->place[2]) range[1] = -1;
}

static inline hk_isosurface_grid box(size_t nx, size_t ny, size_t nz) {
  return (hk_isosurface_grid){
      {nx, ny, nz}, {-1, -1, -1}, {2.0 / (double)(nx - 1), 2.0 / (double)(ny - 1), 2.0 / (double)(nz - 1)}};
}

static const counted ball = {.place = {0.03, -0.02, 0.05}, .radius = 0.7};

static inline hk_status find(bench *b, hk_isosurface_grid grid, hk_isosurface_field field,
                             hk_isosurface_options options) {
  return hk_isosurface_find(&b->surface, &b->instance.host, &grid, &field, &options);
}

static inline bool same(const hk_isosurface *a, const hk_isosurface *b) {
  return a->vertices == b->vertices && a->triangles == b->triangles &&
         memcmp(a->x, b->x, a->vertices * sizeof *a->x) == 0 &&
         memcmp(a->normal, b->normal, a->vertices * sizeof *a->normal) == 0 &&
         memcmp(a->triangle, b->triangle, a->triangles * sizeof *a->triangle) == 0;
}

static inline double *sampled(const hk_isosurface_grid *grid, const counted *s) {
  size_t count = grid->points[0] * grid->points[1] * grid->points[2];
  double *value = malloc(count * sizeof *value);
  assert_non_null(value);
  for (size_t k = 0, n[2] = {grid->points[0], grid->points[1]}; k < count; k++) {
    size_t at[3] = {k % n[0], k / n[0] % n[1], k / n[0] / n[1]};
    double x[1][3];
    for (int c = 0; c < 3; c++) x[0][c] = grid->origin[c] + (double)at[c] * grid->spacing[c];
    counted_sphere(s, (const double(*)[3])x, 1, &value[k]);
  }
  return value;
}

#endif
