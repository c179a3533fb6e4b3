/* Random fields of 3 x 3 x 3 values, `side`^3 of them in one grid, apart by layers of outside. */
#ifndef HK_TEST_RANDOM_FIELDS_H
#define HK_TEST_RANDOM_FIELDS_H

#include "tests/plugins/common/isosurface/surface_check.h"

/* Integers from -2 to 2, of which a fifth equal the level, or numbers from -1 to 1. */
static inline void fill_random(double *value, size_t points, bool integers, uint64_t seed[4]) {
  for (size_t k = 0; k < points * points * points; k++) {
    bool apart = k % points % 4 == 0 || k / points % points % 4 == 0 || k / (points * points) % 4 == 0;
    double u = hk_random_uniform(seed);
    value[k] = apart ? -1 : integers ? floor(5 * u) - 2 : 2 * u - 1;
  }
}

/* Each vertex of each surface has one closed ring of triangles, and a normal, also where the gradient vanishes. */
static inline void check_random_fields(hk_isosurface_method method, bool integers, size_t side, uint64_t number) {
  size_t points = 4 * side + 1;
  double *value = malloc(points * points * points * sizeof *value);
  uint64_t seed[4];
  bench b;
  const hk_host *host = open_bench(&b, 1);
  assert_non_null(value);
  hk_random_seed(seed, number);
  fill_random(value, points, integers, seed);
  hk_isosurface_grid grid = {{points, points, points}, {0}, {1, 1, 1}};
  hk_isosurface_field field = {.values = value};
  hk_isosurface_options options = {.method = method};
  assert_int_equal(hk_isosurface_find(&b.surface, host, &grid, &field, &options), HK_OK);
  assert_int_equal(count_broken(&b.surface), 0);
  assert_true(normals_off(&b.surface) < 1e-14);
  assert_true(b.surface.triangles > 20 * side * side * side);
  free(value);
  close_bench(&b);
}

#endif
