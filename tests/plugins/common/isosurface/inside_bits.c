/* Fields that are arrays: they give the surface of the same field as a function, for sides of any length, rows of any
 * pattern and values of any scale. */
#include "tests/plugins/common/isosurface/balls.h"

/* From one thread to the other, and to the same field as a function, whose normals alone are others: they are
 * differences over less. The ball leaves the box, of which no side is a multiple of a block. */
static void arrays_and_functions_have_the_same_vertices(void **state) {
  (void)state;
  counted at_corner = {.place = {0.8, -0.9, 0.7}, .radius = 0.75};
  for (size_t n = 30; n < 39; n++) {
    bench b[3];
    hk_isosurface_grid grid = box(n, n + 5, n + 2);
    double *value = sampled(&grid, &at_corner);
    hk_isosurface_field array = {.values = value}, function = {.evaluate = counted_sphere, .self = &at_corner};
    for (int k = 0; k < 3; k++) {
      open_bench(&b[k], k == 1 ? 7 : 1);
      hk_isosurface_options options = {.method = n % 2 ? HK_MARCHING_CUBES : HK_MARCHING_TETRAHEDRA, .close = true};
      assert_int_equal(find(&b[k], grid, k == 2 ? function : array, options), HK_OK);
    }
    assert_true(same(&b[0].surface, &b[1].surface));
    assert_int_equal(count_broken(&b[0].surface), 0);
    assert_int_equal(b[0].surface.vertices, b[2].surface.vertices);
    memcpy(b[2].surface.normal, b[0].surface.normal, b[0].surface.vertices * sizeof *b[0].surface.normal);
    assert_true(same(&b[0].surface, &b[2].surface));
    for (int k = 0; k < 3; k++) close_bench(&b[k]);
    free(value);
  }
}

/* A slab whose rows of values are all alike, so that each row of every block crosses the surface in the same way. */
static void slabs_across_each_axis_are_closed(void **state) {
  (void)state;
  enum { N = 20 };
  double *value = malloc(N * N * N * sizeof *value);
  assert_non_null(value);
  for (int axis = 0; axis < 3; axis++)
    for (int method = 0; method < 2; method++) {
      bench b;
      open_bench(&b, 1);
      for (size_t k = 0; k < N * N * N; k++) {
        size_t at[3] = {k % N, k / N % N, k / N / N};
        value[k] = 4.25 - fabs((double)at[axis] - 9);
      }
      hk_isosurface_grid grid = {{N, N, N}, {0}, {1, 1, 1}};
      hk_isosurface_options options = {.method = (hk_isosurface_method)method, .close = true};
      assert_int_equal(find(&b, grid, (hk_isosurface_field){.values = value}, options), HK_OK);
      assert_int_equal(count_broken(&b.surface), 0);
      assert_true(fabs(surface_volume(&b.surface) - 8.5 * 19 * 19) < 1e-9);
      assert_true(fabs(surface_area(&b.surface) - 2 * 19 * 19 - 4 * 19 * 8.5) < 1e-9);
      close_bench(&b);
    }
  free(value);
}

/* By powers of two, so that nothing but the squares in a normal is rounded otherwise. */
static void the_scale_of_values_changes_no_vertex(void **state) {
  (void)state;
  hk_isosurface_grid grid = box(20, 21, 22);
  double *value = sampled(&grid, &ball);
  const double scale[] = {1, 0x1p990, 0x1p-1000};
  bench b[3];
  for (int k = 0; k < 3; k++) {
    double *scaled = malloc(20 * 21 * 22 * sizeof *scaled);
    assert_non_null(scaled);
    for (size_t i = 0; i < 20 * 21 * 22; i++) scaled[i] = ldexp(rint(ldexp(value[i], 20)), -20) * scale[k];
    open_bench(&b[k], 1);
    assert_int_equal(find(&b[k], grid, (hk_isosurface_field){.values = scaled}, (hk_isosurface_options){.level = 0}),
                     HK_OK);
    assert_true(normals_off(&b[k].surface) < 1e-14);
    assert_int_equal(b[k].surface.vertices, b[0].surface.vertices);
    for (size_t e = 0; e < 3 * b[k].surface.vertices; e++)
      assert_true(fabs(b[k].surface.normal[e / 3][e % 3] - b[0].surface.normal[e / 3][e % 3]) < 1e-14);
    memcpy(b[k].surface.normal, b[0].surface.normal, b[0].surface.vertices * sizeof *b[0].surface.normal);
    assert_true(same(&b[k].surface, &b[0].surface));
    free(scaled);
  }
  for (int k = 0; k < 3; k++) close_bench(&b[k]);
  free(value);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(arrays_and_functions_have_the_same_vertices),
      cmocka_unit_test(slabs_across_each_axis_are_closed),
      cmocka_unit_test(the_scale_of_values_changes_no_vertex),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
