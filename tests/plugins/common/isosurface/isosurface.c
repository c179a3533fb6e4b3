/* The search for a surface: the same bits for any number of threads, blocks that bounds leave out, surfaces closed
 * along the box, and a sentence for each thing that cannot be. */
#include "tests/plugins/common/isosurface/balls.h"

/* ---- results ---- */

static void any_number_of_threads_gives_the_same_bits(void **state) {
  (void)state;
  static const int threads[] = {1, 2, 7};
  for (int method = 0; method < 2; method++) {
    bench b[3];
    for (int k = 0; k < 3; k++) {
      open_bench(&b[k], threads[k]);
      assert_int_equal(find(&b[k], box(70, 51, 44), (hk_isosurface_field){.evaluate = counted_sphere, .self = &ball},
                            (hk_isosurface_options){.method = (hk_isosurface_method)method, .steps = 2}),
                       HK_OK);
    }
    assert_true(b[0].surface.vertices > 5000 && same(&b[0].surface, &b[1].surface) &&
                same(&b[0].surface, &b[2].surface));
    for (int k = 0; k < 3; k++) close_bench(&b[k]);
  }
}

/* Sides that are no multiples of blocks, spacings that differ; the largest edge of a grid of 40 cells bounds the error.
 */
static void grids_of_any_sides_hold_the_surface(void **state) {
  (void)state;
  for (size_t n = 12; n < 22; n++) {
    bench b;
    open_bench(&b, 1);
    assert_int_equal(find(&b, box(n, 41, n + 13), (hk_isosurface_field){.evaluate = counted_sphere, .self = &ball},
                          (hk_isosurface_options){.steps = 3}),
                     HK_OK);
    assert_int_equal(count_broken(&b.surface), 0);
    double exact = 4 * M_PI / 3 * 0.343;
    assert_true(fabs(surface_volume(&b.surface) - exact) < 0.04 * exact);
    close_bench(&b);
  }
}

/* A ball of which the box has a part, and a box that is inside everywhere, of which all is the box: the volume is exact
 * to rounding, and so is the area. */
static void surfaces_are_closed_along_the_box(void **state) {
  (void)state;
  counted at_wall = {.place = {1, 0.01, 0.02}, .radius = 0.8}, all = {.radius = 9};
  for (int method = 0; method < 2; method++) {
    bench b;
    long euler[1] = {0};
    hk_isosurface_options options = {.method = (hk_isosurface_method)method, .close = true, .steps = 3};
    open_bench(&b, 1);
    assert_int_equal(
        find(&b, box(41, 41, 41), (hk_isosurface_field){.evaluate = counted_sphere, .self = &at_wall}, options), HK_OK);
    assert_true(count_broken(&b.surface) == 0 && find_components(&b.surface, euler, 1) == 1 && euler[0] == 2);
    double half = 2 * M_PI / 3 * 0.512;
    assert_true(fabs(surface_volume(&b.surface) - half) < 0.01 * half);
    assert_true(fabs(surface_area(&b.surface) - 3 * M_PI * 0.64) < 0.01 * 3 * M_PI * 0.64);
    assert_int_equal(find(&b, box(9, 10, 18), (hk_isosurface_field){.evaluate = counted_sphere, .self = &all}, options),
                     HK_OK);
    assert_true(count_broken(&b.surface) == 0 && find_components(&b.surface, euler, 1) == 1 && euler[0] == 2);
    assert_true(fabs(surface_volume(&b.surface) - 8) < 1e-12 && fabs(surface_area(&b.surface) - 24) < 1e-12);
    close_bench(&b);
  }
}

/* Values that equal the level put vertices onto points of the grid; a margin keeps areas above 0. */
static void a_margin_keeps_triangles_from_vanishing(void **state) {
  (void)state;
  enum { N = 12 };
  double value[N * N * N];
  for (size_t k = 0; k < N * N * N; k++) {
    long x = (long)(k % N) - 6, y = (long)(k / N % N) - 6, z = (long)(k / N / N) - 6;
    value[k] = (double)(4 - labs(x) - labs(y) - labs(z));
  }
  for (int k = 0; k < 2; k++) {
    bench b;
    size_t vanished = 0;
    double n[3];
    open_bench(&b, 1);
    hk_isosurface_grid grid = {{N, N, N}, {0}, {1, 1, 1}};
    assert_int_equal(
        find(&b, grid, (hk_isosurface_field){.values = value}, (hk_isosurface_options){.margin = 0.01 * k}), HK_OK);
    assert_int_equal(count_broken(&b.surface), 0);
    for (size_t t = 0; t < b.surface.triangles; t++) {
      triangle_normal(&b.surface, t, n);
      vanished += !(fabs(n[0]) + fabs(n[1]) + fabs(n[2]) > 1e-6);
    }
    assert_int_equal(vanished > 0, k == 0);
    close_bench(&b);
  }
}

/* ---- work and memory ---- */

static void bounds_spare_evaluations_and_change_no_bit(void **state) {
  (void)state;
  size_t asked[2] = {0};
  bench b[2];
  for (int k = 0; k < 2; k++) {
    counted s = ball;
    s.asked = &asked[k];
    open_bench(&b[k], 1);
    hk_isosurface_field field = {.evaluate = counted_sphere, .bounds = k ? sphere_bounds : NULL, .self = &s};
    assert_int_equal(find(&b[k], box(120, 120, 120), field, (hk_isosurface_options){.level = 0}), HK_OK);
  }
  assert_true(same(&b[0].surface, &b[1].surface));
  assert_true(2 * asked[1] < asked[0]);
  for (int k = 0; k < 2; k++) close_bench(&b[k]);
}

/* 1024^3 values would be 8.6 GB. Four bytes for each of 129^3 blocks are 8.6 MB, and a small ball takes the rest. */
static void memory_grows_with_the_surface(void **state) {
  (void)state;
  bench b;
  counted small = {.place = {0.1, 0.2, 0.3}, .radius = 0.02};
  open_bench(&b, 1);
  hk_isosurface_field field = {.evaluate = counted_sphere, .bounds = sphere_bounds, .self = &small};
  assert_int_equal(find(&b, box(1024, 1024, 1024), field, (hk_isosurface_options){.most_bytes = 20000000}), HK_OK);
  assert_int_equal(count_broken(&b.surface), 0);
  close_bench(&b);
}

static void a_missing_allocation_is_said_and_changes_nothing(void **state) {
  (void)state;
  bench b;
  hk_isosurface_field field = {.evaluate = counted_sphere, .self = &ball};
  open_bench(&b, 1);
  assert_int_equal(find(&b, box(20, 20, 20), field, (hk_isosurface_options){.level = 0.1}), HK_OK);
  size_t before = b.surface.vertices;
  hk_status status = HK_NO_MEMORY;
  long k = 0;
  for (; status != HK_OK; k++) {
    b.shared.allocations_left = k;
    status = find(&b, box(20, 20, 20), field, (hk_isosurface_options){.level = 0});
    if (status == HK_OK) break;
    assert_int_equal(status, HK_NO_MEMORY);
    assert_non_null(strstr(b.error.text, "isosurface: no memory for"));
    assert_int_equal(b.surface.vertices, before);
  }
  assert_int_equal(k, 7); /* blocks, those at the surface, cases, values, vertices, normals, triangles */
  close_bench(&b);
}

/* ---- sentences ---- */

typedef struct wrong {
  hk_isosurface_grid grid;
  hk_isosurface_field field;
  hk_isosurface_options options;
  hk_status status;
  const char *says;
} wrong;

static void check_wrong(const wrong *w, size_t count) {
  for (size_t k = 0; k < count; k++) {
    bench b;
    open_bench(&b, 2);
    hk_status status = find(&b, w[k].grid, w[k].field, w[k].options);
    if (status != w[k].status || !strstr(b.error.text, w[k].says))
      fail_msg("%zu: status %d, '%s' instead of '%s'", k, (int)status, b.error.text, w[k].says);
    assert_true(!b.surface.x && b.surface.vertices == 0);
    close_bench(&b);
  }
}

static const hk_isosurface_field sphere_field = {.evaluate = counted_sphere, .self = &ball};

static void wrong_grids_and_options_are_said(void **state) {
  (void)state;
  hk_isosurface_grid flat = box(20, 20, 20), thin = flat, far = flat, none = flat;
  flat.points[1] = 1, thin.spacing[2] = 0, far.origin[0] = 1e18, none.origin[2] = NAN;
  hk_isosurface_field both = sphere_field, neither = {0};
  both.values = ball.place;
  const wrong w[] = {
      {flat, sphere_field, {.level = 0}, HK_BAD_PARAM, "a grid of 1 points along y"},
      {thin, sphere_field, {.level = 0}, HK_BAD_PARAM, "points along z from -1 m, 0 m apart"},
      {far, sphere_field, {.level = 0}, HK_BAD_PARAM, "points along x from 1e+18 m"},
      {none, sphere_field, {.level = 0}, HK_BAD_PARAM, "points along z from nan m"},
      {box(9, 9, 9), both, {.level = 0}, HK_BAD_PARAM, "by values or by a function"},
      {box(9, 9, 9), neither, {.level = 0}, HK_BAD_PARAM, "by values or by a function"},
      {box(9, 9, 9), sphere_field, {.level = INFINITY}, HK_BAD_PARAM, "a level of inf"},
      {box(9, 9, 9), sphere_field, {.margin = 0.6}, HK_BAD_PARAM, "a margin of 0.6"},
      {box(9, 9, 9), sphere_field, {.method = (hk_isosurface_method)2}, HK_BAD_PARAM, "method 2 is neither"},
      {box(200, 200, 200), sphere_field, {.most_bytes = 50000}, HK_NO_MEMORY, "blocks of the box need 0.0703 MB"},
      {box(200, 200, 200), sphere_field, {.most_bytes = 200000}, HK_NO_MEMORY, "blocks at the surface need"},
      {box(1000000000, 1000000000, 1000000000), sphere_field, {.level = 0}, HK_NO_MEMORY, "blocks of the box"},
  };
  check_wrong(w, sizeof w / sizeof *w);
}

static void fields_that_have_no_surface_are_said(void **state) {
  (void)state;
  counted large = {.radius = 1.1}, hole = {.radius = 0.7, .hole = 0.35}, liar = {.radius = 0.7, .liar = true};
  double values[27];
  for (int k = 0; k < 27; k++) values[k] = k == 13 ? 1 : k == 17 ? INFINITY : -1;
  hk_isosurface_grid small = {{3, 3, 3}, {0}, {1, 1, 1}};
  hk_isosurface_options high = {.level = 2}, zero = {.level = 0};
  hk_isosurface_field outside = {.evaluate = counted_sphere, .bounds = sphere_bounds, .self = &ball};
  hk_isosurface_field leaving = {.evaluate = counted_sphere, .self = &large};
  hk_isosurface_field holed_field = {.evaluate = counted_sphere, .self = &hole}, array = {.values = values};
  hk_isosurface_field lying = {.evaluate = counted_sphere, .bounds = sphere_bounds, .self = &liar};
  const wrong w[] = {
      {box(9, 9, 9), sphere_field, high, HK_BAD_PARAM, "no surface in the box: the field is from -1.08992 to 0.638356"},
      {box(9, 9, 9), outside, high, HK_BAD_PARAM, "the bounds of the field exclude a level of 2 everywhere"},
      {box(9, 9, 9), leaving, zero, HK_BAD_PARAM, "the surface leaves the box: at (-0.25, -0.25, -1)"},
      {box(21, 21, 21), holed_field, zero, HK_NOT_FINITE, "the field is nan at (0.4, -1, -1), point (14, 0, 0)"},
      {small, array, zero, HK_NOT_FINITE, "the field is inf at (2, 2, 1), point (2, 2, 1)"},
      {box(60, 60, 60), lying, zero, HK_FAILED, "the field contradicts itself around the block"},
  };
  check_wrong(w, sizeof w / sizeof *w);
}

/* NAN at no point of the grid, but where vertices are looked for. */
static void holed(const void *self, const double (*x)[3], size_t count, double *value) {
  counted_sphere(self, x, count, value);
  for (size_t k = 0; k < count; k++) {
    double steps = (x[k][2] + 1) * 10;
    if (fabs(steps - round(steps)) > 0.05) value[k] = NAN;
  }
}

static void a_hole_between_points_is_said(void **state) {
  (void)state;
  const wrong w[] = {{box(21, 21, 21),
                      {.evaluate = holed, .self = &ball},
                      {.steps = 2},
                      HK_NOT_FINITE,
                      "the field is not finite at ("}};
  check_wrong(w, 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(any_number_of_threads_gives_the_same_bits),
      cmocka_unit_test(grids_of_any_sides_hold_the_surface),
      cmocka_unit_test(surfaces_are_closed_along_the_box),
      cmocka_unit_test(a_margin_keeps_triangles_from_vanishing),
      cmocka_unit_test(bounds_spare_evaluations_and_change_no_bit),
      cmocka_unit_test(memory_grows_with_the_surface),
      cmocka_unit_test(a_missing_allocation_is_said_and_changes_nothing),
      cmocka_unit_test(wrong_grids_and_options_are_said),
      cmocka_unit_test(fields_that_have_no_surface_are_said),
      cmocka_unit_test(a_hole_between_points_is_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
