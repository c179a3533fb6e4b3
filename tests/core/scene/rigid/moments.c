/* Moments: of meshes exactly those of the solid, wherever it lies and however it is turned; of round shapes the limit
 * of their facets; of parts by Steiner's theorem. What encloses nothing, and moments that no body has, are refused. */
#include "core/scene/rigid/rigid.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double pi = 3.141592653589793, still[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};

static void near(double found, double expected, double within) {
  if (!(fabs(found - expected) <= within)) fail_msg("%.17g, expected %.17g", found, expected);
}

static void alike(const hk_moments *a, const hk_moments *b, double within) {
  near(a->mass, b->mass, within * b->mass);
  for (int c = 0; c < 3; c++) near(a->center[c], b->center[c], within * (1 + fabs(b->center[c])));
  for (int p = 0; p < 9; p++) near(a->second[p], b->second[p], within * (b->second[0] + b->second[4] + b->second[8]));
}

static hk_moments of_mesh(hk_mesh *m) {
  hk_moments found;
  char text[HK_RIGID_TEXT];
  const char *wrong = hk_moments_of_mesh(m, &found, text);
  if (wrong) fail_msg("%s", wrong);
  hk_mesh_clear(m);
  return found;
}

/* Far from the origin the vertices themselves are rounded, by 1e-16 of 1e4 m. */
static void a_box_has_its_moments_at_any_place(void **state) {
  (void)state;
  const double size[3] = {1, 2, 0.5};
  hk_moments box = hk_moments_of_box(size);
  near(box.second[4], 1 * 4.0 / 12, 1e-15);
  for (int far = 0; far < 2; far++) {
    hk_mesh m = {0};
    assert_null(hk_mesh_add_box(&m, size));
    for (size_t k = 0; k < 3 * m.vertices; k++) m.vertex[k] += far ? 1e4 : 0;
    for (int c = 0; c < 3; c++) box.center[c] = far ? 1e4 : 0;
    hk_moments found = of_mesh(&m);
    alike(&found, &box, far ? 1e-11 : 1e-14);
  }
}

/* A tetrahedron with three edges along the axes: V = 1/6, int x^2 = 1/60 and int x y = 1/120, about the corner. */
static void a_tetrahedron_has_its_textbook_moments(void **state) {
  (void)state;
  hk_mesh m = {0};
  const double x[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const uint32_t face[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  for (int k = 0; k < 4; k++) assert_null(hk_mesh_add_vertex(&m, x[k]));
  for (int k = 0; k < 4; k++) assert_null(hk_mesh_add_face(&m, face[k], 3));
  hk_moments found = of_mesh(&m);
  near(found.mass, 1.0 / 6, 1e-16);
  near(found.center[0], 0.25, 1e-15);
  near(found.second[0], 1.0 / 60 - 1.0 / 96, 1e-16);
  near(found.second[1], 1.0 / 120 - 1.0 / 96, 1e-16);
}

/* Facets lie inside by the detail, which falls by 4: so do the errors of the moments. */
static void facets_come_to_the_round_shapes(void **state) {
  (void)state;
  const hk_moments exact[3] = {hk_moments_of_sphere(0.5), hk_moments_of_capsule(0.5, 1.2),
                               hk_moments_of_cylinder(0.5, 0.7)};
  near(exact[0].mass, pi / 6, 1e-15);
  for (int shape = 0; shape < 3; shape++)
    for (int fine = 0; fine < 2; fine++) {
      hk_mesh m = {0};
      double detail = fine ? 1e-4 : 1e-3;
      assert_null(shape == 0   ? hk_mesh_add_sphere(&m, 0.5, detail)
                  : shape == 1 ? hk_mesh_add_capsule(&m, 0.5, 1.2, detail)
                               : hk_mesh_add_cylinder(&m, 0.5, 0.7, detail));
      hk_moments found = of_mesh(&m);
      alike(&found, &exact[shape], 6 * detail);
      assert_true(found.mass < exact[shape].mass);
    }
}

/* Two halves of a box, one of them upside down, are the box. */
static void parts_add_up(void **state) {
  (void)state;
  const double turned[9] = {-1, 0, 0, 0, 1, 0, 0, 0, -1}, half[3] = {1, 2, 0.5};
  hk_moments part = hk_moments_of_box(half), sum = {0}, whole = hk_moments_of_box((const double[3]){2, 2, 0.5});
  part.center[0] = 0.25; /* in a frame of its own */
  hk_moments_add(&sum, &part, (const double[3]){0.25, 0, 0}, still);
  hk_moments_add(&sum, &part, (const double[3]){-0.25, 0, 0}, turned);
  alike(&sum, &whole, 1e-14);
}

static void points_have_the_moments_of_their_masses(void **state) {
  (void)state;
  hk_moments m = hk_moments_of_points(2, (const double[]){1, 0, 0, 4, 0, 0}, (const double[]){1, 2});
  near(m.center[0], 3, 1e-15);
  near(m.second[0], 1 * 4 + 2 * 1, 1e-14);
}

static void refuse(hk_mesh *m, const char *expected) {
  hk_moments found;
  char text[HK_RIGID_TEXT];
  const char *wrong = hk_moments_of_mesh(m, &found, text);
  if (!wrong || !strstr(wrong, expected)) fail_msg("%s, expected %s", wrong ? wrong : "nothing", expected);
  hk_mesh_clear(m);
}

static void what_encloses_nothing_is_refused_with_its_edge(void **state) {
  (void)state;
  const double size[3] = {1, 1, 1};
  hk_mesh m = {0};
  assert_null(hk_mesh_add_box(&m, size));
  m.triangles--;
  refuse(&m, "is open: the edge between vertices");
  assert_null(hk_mesh_add_box(&m, size));
  for (size_t t = 0; t < m.triangles; t++) {
    uint32_t a = m.triangle[t][0];
    m.triangle[t][0] = m.triangle[t][1], m.triangle[t][1] = a;
  }
  refuse(&m, "face inwards");
  assert_null(hk_mesh_add_box(&m, size));
  uint32_t a = m.triangle[3][0];
  m.triangle[3][0] = m.triangle[3][1], m.triangle[3][1] = a;
  refuse(&m, "face opposite sides");
  assert_null(hk_mesh_add_box(&m, size));
  for (size_t i = 0; i < m.vertices; i++) m.vertex[3 * i + 2] = 0;
  refuse(&m, "is flat");
  refuse(&m, "no triangles");
}

static const char *set(double x, double y, double z, hk_moments *m) {
  static char text[HK_RIGID_TEXT];
  return hk_moments_set_inertia(m, (const double[9]){x, 0, 0, 0, y, 0, 0, 0, z}, text);
}

static void moments_that_no_body_has_are_refused(void **state) {
  (void)state;
  hk_moments m = {.mass = 1};
  assert_null(set(1, 2, 3, &m)); /* flat: the largest is the sum of the others */
  near(m.second[8], 0, 1e-15);
  assert_null(set(0, 2, 2, &m));
  assert_non_null(set(1, 1, 2.1, &m));
  assert_non_null(set(-1, 1, 1, &m));
  assert_non_null(set(NAN, 1, 1, &m));
  char text[HK_RIGID_TEXT];
  assert_non_null(hk_moments_set_inertia(&m, (const double[9]){2, 1, 0, 0, 2, 0, 0, 0, 2}, text));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_box_has_its_moments_at_any_place),
      cmocka_unit_test(a_tetrahedron_has_its_textbook_moments),
      cmocka_unit_test(facets_come_to_the_round_shapes),
      cmocka_unit_test(parts_add_up),
      cmocka_unit_test(points_have_the_moments_of_their_masses),
      cmocka_unit_test(what_encloses_nothing_is_refused_with_its_edge),
      cmocka_unit_test(moments_that_no_body_has_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
