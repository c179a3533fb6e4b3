/* Surfaces whose topology, area and volume are known. Each field is positive inside and smooth near the surface. */
#ifndef HK_TEST_SHAPES_H
#define HK_TEST_SHAPES_H

#include "tests/plugins/common/isosurface/surface_check.h"

typedef struct shape {
  const char *name;
  double (*value)(const double x[3], double gradient[3]);
  double half; /* the box is a cube of twice this side around a place off its middle */
  size_t components;
  long euler;
  double volume, area; /* area 0: there is no closed form */
} shape;

/* From the field of one place to many. */
static inline void shape_evaluate(const void *self, const double (*x)[3], size_t count, double *value) {
  double unused[3];
  for (size_t k = 0; k < count; k++) value[k] = ((const shape *)self)->value(x[k], unused);
}

static inline hk_isosurface_grid shape_grid(const shape *s, size_t points) {
  double h = 2 * s->half / (double)(points - 1);
  hk_isosurface_grid grid = {{points, points, points}, {0}, {h, h, h}};
  for (int c = 0; c < 3; c++) grid.origin[c] = -s->half + 0.01 * s->half * (c + 1);
  return grid;
}

static inline double sphere_value(const double x[3], double g[3]) {
  for (int c = 0; c < 3; c++) g[c] = -2 * x[c];
  return 1 - x[0] * x[0] - x[1] * x[1] - x[2] * x[2];
}

/* Around the z axis, of radii 1 and 0.4. */
static inline double torus_value(const double x[3], double g[3]) {
  double r = hypot(x[0], x[1]), d = r - 1, scale = r > 0 ? -2 * d / r : 0;
  g[0] = scale * x[0], g[1] = scale * x[1], g[2] = -2 * x[2];
  return 0.16 - d * d - x[2] * x[2];
}

/* Oblate: half axes 1, 1 and 0.6. */
static inline double ellipsoid_value(const double x[3], double g[3]) {
  g[0] = -2 * x[0], g[1] = -2 * x[1], g[2] = -2 * x[2] / 0.36;
  return 1 - x[0] * x[0] - x[1] * x[1] - x[2] * x[2] / 0.36;
}

static inline double quartic_value(const double x[3], double g[3]) {
  double sum = 0;
  for (int c = 0; c < 3; c++) sum += x[c] * x[c] * x[c] * x[c], g[c] = -4 * x[c] * x[c] * x[c];
  return 1 - sum;
}

/* Gaussian blobs at x = 0.8 and -0.8 that have grown together. */
enum { BLOBS = 2 };
static const double blob_place = 0.8, blob_level = 0.6;

static inline double blobs_value(const double x[3], double g[3]) {
  double sum = -blob_level;
  g[0] = g[1] = g[2] = 0;
  for (int k = 0; k < BLOBS; k++) {
    double d[3] = {x[0] - (k ? blob_place : -blob_place), x[1], x[2]};
    double each = exp(-d[0] * d[0] - d[1] * d[1] - d[2] * d[2]);
    for (int c = 0; c < 3; c++) g[c] -= 2 * d[c] * each;
    sum += each;
  }
  return sum;
}

/* The blobs are a body of revolution around x: rho^2 = log(g(x) / level). Returns rho^2 and its derivative. */
static inline double blobs_profile(double x, double *slope) {
  double a = exp(-(x - blob_place) * (x - blob_place)), b = exp(-(x + blob_place) * (x + blob_place));
  *slope = -2 * ((x - blob_place) * a + (x + blob_place) * b) / (a + b);
  return log((a + b) / blob_level);
}

/* Simpson's rule along the axis: volume pi rho^2, area 2 pi sqrt(rho^2 + (rho rho')^2). */
static inline void blobs_integrals(double *volume, double *area) {
  double low = 0, high = 3, slope;
  for (int k = 0; k < 60; k++) {
    double middle = (low + high) / 2;
    *(blobs_profile(middle, &slope) > 0 ? &low : &high) = middle;
  }
  *volume = *area = 0;
  enum { PARTS = 2000 };
  for (int k = 0; k <= PARTS; k++) {
    double square = blobs_profile(low * k / PARTS, &slope), weight = k == 0 || k == PARTS ? 1 : k % 2 ? 4 : 2;
    weight *= 2 * low / PARTS / 3; /* of both halves */
    *volume += weight * M_PI * square;
    *area += weight * M_PI * sqrt(fmax(4 * square + slope * slope, 0));
  }
}

enum { SHAPES = 5 };

static inline void fill_shapes(shape s[SHAPES]) {
  double e = 0.8; /* eccentricity of the ellipsoid */
  s[0] = (shape){"sphere", sphere_value, 1.3, 1, 2, 4 * M_PI / 3, 4 * M_PI};
  s[1] = (shape){"torus", torus_value, 1.6, 1, 0, 2 * M_PI * M_PI * 0.16, 4 * M_PI * M_PI * 0.4};
  s[2] =
      (shape){"ellipsoid", ellipsoid_value, 1.2, 1, 2, 4 * M_PI / 3 * 0.6, 2 * M_PI * (1 + (1 - e * e) / e * atanh(e))};
  s[3] = (shape){"quartic", quartic_value, 1.2, 1, 2, 8 * pow(tgamma(1.25), 3) / tgamma(1.75), 0};
  s[4] = (shape){"blobs", blobs_value, 2.1, 1, 2, 0, 0};
  blobs_integrals(&s[4].volume, &s[4].area);
}

#endif
