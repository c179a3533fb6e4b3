/* Closed shapes: every edge lies between two triangles that pass it in opposite directions, volume and area come to
 * those of the true shape with the square of the detail, and tetrahedra have a skin that encloses their volume. */
#include "core/scene/meshes/meshes.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

static const double pi = 3.141592653589793;

static const double *corner(const hk_mesh *m, size_t t, int c) { return m->vertex + 3 * (size_t)m->triangle[t][c]; }

/* Twice the area vector of a triangle. */
static void area_of(const hk_mesh *m, size_t t, double n[3]) {
  const double *a = corner(m, t, 0), *b = corner(m, t, 1), *c = corner(m, t, 2);
  for (int k = 0; k < 3; k++) {
    int i = (k + 1) % 3, j = (k + 2) % 3;
    n[k] = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
  }
}

/* By the theorem of Gauss, a sixth of the sum of a.(b x c); positive where normals point outwards. */
static double volume(const hk_mesh *m) {
  double sum = 0, n[3];
  for (size_t t = 0; t < m->triangles; t++) {
    const double *a = corner(m, t, 0);
    area_of(m, t, n);
    sum += (a[0] * n[0] + a[1] * n[1] + a[2] * n[2]) / 6;
  }
  return sum;
}

static double area(const hk_mesh *m) {
  double sum = 0, n[3];
  for (size_t t = 0; t < m->triangles; t++) {
    area_of(m, t, n);
    sum += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
  }
  return sum;
}

static int passes(const hk_mesh *m, uint32_t from, uint32_t to) {
  int count = 0;
  for (size_t t = 0; t < m->triangles; t++)
    for (int c = 0; c < 3; c++) count += m->triangle[t][c] == from && m->triangle[t][(c + 1) % 3] == to;
  return count;
}

static void expect_closed(const hk_mesh *m) {
  for (size_t t = 0; t < m->triangles; t++)
    for (int c = 0; c < 3; c++) {
      uint32_t from = m->triangle[t][c], to = m->triangle[t][(c + 1) % 3];
      assert_int_equal(passes(m, from, to), 1);
      assert_int_equal(passes(m, to, from), 1);
    }
}

typedef const char *shape(hk_mesh *, double detail);
static const char *sphere(hk_mesh *m, double detail) { return hk_mesh_add_sphere(m, 2, detail); }
static const char *capsule(hk_mesh *m, double detail) { return hk_mesh_add_capsule(m, 1, 3, detail); }
static const char *cylinder(hk_mesh *m, double detail) { return hk_mesh_add_cylinder(m, 1, 3, detail); }

/* Inscribed facets that are `detail` radii inside lose at most this part of a length, so 3 times of a volume. */
static void expect_shape(shape *add, double true_volume, double true_area) {
  double missing[2];
  const double detail[2] = {0.02, 0.005};
  for (int k = 0; k < 2; k++) {
    hk_mesh m = {0};
    assert_null(add(&m, detail[k]));
    expect_closed(&m);
    missing[k] = 1 - volume(&m) / true_volume;
    assert_true(missing[k] > 0 && missing[k] <= 3 * detail[k]);
    assert_true(area(&m) < true_area && area(&m) > (1 - 3 * detail[k]) * true_area);
    hk_mesh_clear(&m);
  }
  assert_true(missing[1] < 0.5 * missing[0]);
}

static void round_shapes_are_closed_and_come_to_the_true_ones(void **state) {
  (void)state;
  expect_shape(sphere, 4 / 3.0 * pi * 8, 16 * pi);
  expect_shape(capsule, 4 / 3.0 * pi + 3 * pi, 4 * pi + 6 * pi);
  expect_shape(cylinder, 3 * pi, 2 * pi + 6 * pi);
}

static void a_box_is_exact(void **state) {
  (void)state;
  hk_mesh m = {0};
  assert_null(hk_mesh_add_box(&m, (const double[]){1, 2, 3}));
  expect_closed(&m);
  assert_true(fabs(volume(&m) - 6) <= 1e-14); /* some roundings of numbers of order 1 */
  assert_true(fabs(area(&m) - 22) <= 1e-13);
  hk_mesh_clear(&m);
}

/* A cube of six tetrahedra around its diagonal, each given left-handed or right-handed in turn. */
static void the_skin_of_tetrahedra_encloses_their_volume(void **state) {
  (void)state;
  static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  hk_mesh m = {0};
  for (uint32_t k = 0; k < 8; k++) assert_null(hk_mesh_add_vertex(&m, (const double[]){k & 1, k >> 1 & 1, k >> 2 & 1}));
  assert_null(hk_mesh_add_vertex(&m, (const double[]){5, 5, 5}));
  for (int t = 0; t < 6; t++) {
    uint32_t c[4] = {0, 1u << order[t][0], (1u << order[t][0]) | (1u << order[t][1]), 7};
    assert_null(hk_mesh_add_tetrahedron(&m, c));
    assert_true(fabs(hk_mesh_volume(&m, (size_t)t) - 1 / 6.0) <= 1e-15);
  }
  size_t wrong[2];
  assert_null(hk_mesh_add_skin(&m, wrong));
  assert_int_equal(m.triangles, 12);
  expect_closed(&m);
  assert_true(fabs(volume(&m) - 1) <= 1e-14);
  assert_null(hk_mesh_drop_loose(&m));
  assert_int_equal(m.vertices, 8);
  hk_mesh_clear(&m);
}

static void what_is_no_mesh_is_refused_and_changes_nothing(void **state) {
  (void)state;
  hk_mesh m = {0};
  for (int k = 0; k < 4; k++) assert_null(hk_mesh_add_vertex(&m, (const double[]){k, 0, 0}));
  assert_non_null(hk_mesh_add_face(&m, (const uint32_t[]){0, 1, 1}, 3));
  assert_non_null(hk_mesh_add_tetrahedron(&m, (const uint32_t[]){0, 1, 2, 3})); /* without volume */
  assert_int_equal(m.vertices, 4);
  assert_int_equal(m.triangles + m.tetrahedra, 0);
  hk_mesh_clear(&m);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(round_shapes_are_closed_and_come_to_the_true_ones),
      cmocka_unit_test(a_box_is_exact),
      cmocka_unit_test(the_skin_of_tetrahedra_encloses_their_volume),
      cmocka_unit_test(what_is_no_mesh_is_refused_and_changes_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
