/* The lists of surfaces of small meshes against what one counts by hand, and what bad meshes are told. */
#include "tests/support/surface_scenes.h"

#include "plugins/common/contact/candidates/start_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* A square of two triangles, 0 to 3, a strand 4 5 6 that hangs from particle 3, and 7, alone. */
static test_surfaces *square_and_strand(void) {
  test_surfaces *s = test_surfaces_open(1, 1, 32);
  test_surfaces_sheet(s, 1, (double[]){0, 0, 0});
  test_surfaces_strand(s, 2, (double[]){1, 1, -0.2}, (double[]){0, 0, -0.2});
  test_surfaces_edge(s, 4, 3);
  test_surfaces_edge(s, 0, 3); /* a spring across the square is no strand */
  test_surfaces_particle(s, 5, 5, 5);
  return s;
}

static void edges_are_listed_once_with_their_triangles(void **state) {
  (void)state;
  static const uint32_t edge[8][2] = {{0, 1}, {0, 2}, {1, 2}, {1, 3}, {2, 3}, {3, 4}, {4, 5}, {5, 6}};
  static const uint32_t face[8][2] = {{0, UINT32_MAX}, {0, UINT32_MAX}, {0, 1}, {1, UINT32_MAX}, {1, UINT32_MAX}};
  test_surfaces *s = square_and_strand();
  test_surfaces_list(s);
  const hk_surface_mesh *m = &s->lists.mesh;
  assert_int_equal(m->edges, 9);
  assert_int_equal(s->lists.surface_edges, 5);
  assert_int_equal(s->lists.strand_edges, 3);
  for (int e = 0; e < 8; e++) {
    assert_memory_equal(m->edge[e], edge[e], sizeof edge[e]);
    for (int k = 0; k < 2; k++) assert_int_equal(m->edge_faces[e][k], e < 5 ? face[e][k] : UINT32_MAX);
  }
  assert_true(m->edge[8][0] == 7 && m->edge[8][1] == 7); /* the isolated particle */
  assert_int_equal(m->points, 8);
  assert_int_equal(m->triangles, 2);
  test_surfaces_close(s);
}

static void parts_are_what_edges_connect_and_radii_theirs(void **state) {
  (void)state;
  test_surfaces *s = square_and_strand();
  uint32_t body = test_surfaces_sheet(s, 1, (double[]){3, 0, 0});
  for (uint32_t i = body; i < body + 4; i++) test_surfaces_hold(s, i);
  test_surfaces_hold(s, 0); /* a corner of the square: it is no body for that */
  test_surfaces_list(s);
  const hk_surface_mesh *m = &s->lists.mesh;
  assert_int_equal(m->parts, 3);
  for (uint32_t i = 0; i < 12; i++) {
    assert_int_equal(m->part[i], i < 7 ? 0 : i == 7 ? 1 : 2);
    assert_true(m->radius[i] == (i < 4 ? 0.005 : i < 8 ? 0.004 : 0.01));
  }
  test_surfaces_close(s);
}

static void what_is_left_out_takes_its_features_along(void **state) {
  (void)state;
  test_surfaces *s = square_and_strand();
  s->left[0] = s->left[5] = true;
  test_surfaces_list(s);
  const hk_surface_mesh *m = &s->lists.mesh;
  assert_int_equal(m->triangles, 1);
  assert_int_equal(m->edges, 5);  /* three of the triangle, 3-4, the isolated particle */
  assert_int_equal(m->points, 5); /* 1 2 3 4 7: 6 has nothing left */
  assert_true(m->part[0] == UINT32_MAX && m->part[5] == UINT32_MAX && m->part[6] == UINT32_MAX);
  test_surfaces_close(s);
}

/* ---- bad meshes ---- */

static void refuse(test_surfaces *s, const char *said) {
  hk_status status = hk_surface_lists_build(&s->lists, test_surfaces_host(s), &s->view, &s->request, s->left);
  assert_int_equal(status, HK_BAD_PARAM);
  if (!strstr(s->error.text, said)) fail_msg("\"%s\" is not in \"%s\"", said, s->error.text);
  assert_int_equal(s->lists.mesh.edges, 0);
  test_surfaces_close(s);
}

static void bad_triangles_are_named(void **state) {
  (void)state;
  test_surfaces *s = square_and_strand();
  test_surfaces_triangle(s, 2, 0, 1);
  refuse(s, "the triangle 3 1 2 stands in the mesh twice");
  s = square_and_strand();
  test_surfaces_triangle(s, 7, 1, 2);
  refuse(s, "the edge from particle 2 to 3 has more than two triangles (their third corners are 1, 4, 8)");
  s = square_and_strand();
  test_surfaces_triangle(s, 7, 7, 2);
  refuse(s, "the triangle 8 8 3 names a particle twice");
}

/* ---- thickness ---- */

static hk_status check_thickness(test_surfaces *s, double thickness, double radius) {
  s->request = (hk_surface_request){.thickness = thickness, .radius = radius};
  s->error = (hk_error){0};
  test_surfaces_list(s);
  return hk_start_check(&s->search, test_surfaces_host(s), &s->view, &s->request, &s->pairs);
}

static void expect_told(const test_surfaces *s, const char *said) {
  if (!strstr(s->error.text, said)) fail_msg("\"%s\" is not in \"%s\"", said, s->error.text);
}

/* In a sheet of squares with sides of 0.25 the nearest neighbours are a corner and the triangle across the diagonal,
 * 0.25/sqrt 2 apart. */
static void the_largest_thickness_that_fits_is_told(void **state) {
  (void)state;
  test_surfaces *s = test_surfaces_open(2, 1, 100);
  test_surfaces_sheet(s, 4, (double[]){0, 0, 0});
  assert_int_equal(check_thickness(s, 0.176, 0), HK_OK);
  assert_int_equal(check_thickness(s, 0.177, 0), HK_BAD_PARAM);
  expect_told(s, "are 0.176777 m apart");
  assert_int_equal(check_thickness(s, 3, 0), HK_BAD_PARAM); /* whatever else is near as well */
  expect_told(s, "are 0.176777 m apart");
  test_surfaces_close(s);
}

static void the_largest_radius_of_strands_is_told(void **state) {
  (void)state;
  test_surfaces *s = test_surfaces_open(1, 1, 100);
  test_surfaces_strand(s, 5, (double[]){0, 0, 0}, (double[]){0, 0.5, 0});
  assert_int_equal(check_thickness(s, 0, 0.2499), HK_OK);
  assert_int_equal(check_thickness(s, 0, 0.26), HK_BAD_PARAM);
  expect_told(s, "a radius below 0.25 m fits");
  test_surfaces_close(s);
}

/* Layers that are too near, but no neighbours, can be moved apart; a body that is pinned touches itself in peace. */
static void what_can_move_apart_does_not_limit_the_thickness(void **state) {
  (void)state;
  test_surfaces *s = test_surfaces_open(1, 1, 200);
  test_surfaces_sheet(s, 4, (double[]){0, 0, 0});
  test_surfaces_sheet(s, 4, (double[]){0, 0, 0.01});
  assert_int_equal(check_thickness(s, 0.17, 0), HK_OK);
  uint32_t body = test_surfaces_sheet(s, 8, (double[]){0, 0, 1});
  for (uint32_t i = body; i < s->model.n; i++) test_surfaces_hold(s, i);
  s->request.body_thickness = 0.17;
  assert_int_equal(check_thickness(s, 0.17, 0), HK_OK);
  test_surfaces_close(s);
}

static void triangles_without_area_are_named(void **state) {
  (void)state;
  test_surfaces *s = square_and_strand();
  test_surfaces_triangle(s, 4, 5, 6);
  assert_int_equal(check_thickness(s, 0.001, 0.001), HK_BAD_PARAM);
  expect_told(s, "the triangle 5 6 7 has no area at the start");
  test_surfaces_close(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(edges_are_listed_once_with_their_triangles),
      cmocka_unit_test(parts_are_what_edges_connect_and_radii_theirs),
      cmocka_unit_test(what_is_left_out_takes_its_features_along),
      cmocka_unit_test(bad_triangles_are_named),
      cmocka_unit_test(the_largest_thickness_that_fits_is_told),
      cmocka_unit_test(the_largest_radius_of_strands_is_told),
      cmocka_unit_test(what_can_move_apart_does_not_limit_the_thickness),
      cmocka_unit_test(triangles_without_area_are_named),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
