/* The service surfaces/1 in runs: what is told of meshes and of plugins that disagree, intersections by particles' ids,
 * pins that are released, and births. Pairs and intersections themselves are tested in tests/plugins/common/contact.
 */
#include "plugins/common/contact/surfaces/surfaces.h"
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* ---- what is refused ---- */

/* Runs a scene with a mesh by hand, and contact with these parameters. */
static void refuse(const char *mesh, const char *contact, const char *said) {
  char text[2048];
  snprintf(text, sizeof text,
           "local s = hooke.scene { duration = 0.1, fps = 10, dt = 0.01, integrator = 'leapfrog' }\n"
           "s:mesh { mass = 1, %s }\n%s\nreturn s\n",
           mesh, contact);
  test_refused(text, "", 1, said);
}

static const char *const contact = "s:corrector('contact', { thickness = 1e-3 })",
                         *const square = "vertices = {{0,0,0}, {1,0,0}, {0,1,0}, {1,1,0}}, faces = {{1,2,3}, {2,4,3}}";

static void bad_meshes_are_named(void **state) {
  (void)state;
  refuse("vertices = {{0,0,0}, {1,0,0}, {0,1,0}}, faces = {{1,2,3}, {3,2,1}}", contact,
         "the triangle 3 2 1 stands in the mesh twice: remove one");
  refuse("vertices = {{0,0,0}, {1,0,0}, {0,1,0}, {0,0,1}, {0,0,-1}}, faces = {{1,2,3}, {1,2,4}, {2,1,5}}", contact,
         "the edge from particle 1 to 2 has more than two triangles (their third corners are 3, 4, 5)");
  refuse("vertices = {{0,0,0}, {1,0,0}, {2,0,0}}, faces = {{1,2,3}}", contact,
         "the triangle 1 2 3 has no area at the start");
}

static void a_thickness_that_is_too_large_is_told_with_the_one_that_fits(void **state) {
  (void)state;
  static const char *const thick = "s:corrector('contact', { thickness = 0.8 })";
  refuse(square, thick, "the thickness of 0.8 m is too large for the mesh: particle");
  refuse(square, thick, "which are neighbours in it, are 0.707107 m apart at the start; a thickness below that fits");
}

/* The line and the name are those of the plugin that asks, not of the service. */
static void errors_name_the_plugin_that_joins(void **state) {
  (void)state;
  refuse(square, "s:corrector('contact', { thickness = 0.8, label = 'cloth' })",
         "bad.lua:3: cloth: the thickness of 0.8 m is too large");
  refuse(square, "s:force('repulsion', { thickness = 2e-3 })\ns:corrector('contact', { thickness = 1e-3 })",
         "bad.lua:4: contact: another plugin");
}

/* 100 in one place are 4950 pairs, which are tried; 20,000 would be 2e8. */
static void a_heap_of_particles_is_refused_before_its_pairs_are_listed(void **state) {
  (void)state;
  static const char *const heap = "for k = 1, 20000 do s:particle { position = { 1e-8 * k, 5, 0 }, mass = 1 } end\n";
  char text[512];
  snprintf(text, sizeof text, "%ss:corrector('contact')", heap);
  refuse(square, text, "20000 particles, among them 5 and 6, start within 0.001 m of each other");
  snprintf(text, sizeof text, "%ss:force('barrier')", heap);
  refuse(square, text, "barrier: 20000 particles, among them 5 and 6");
}

static void plugins_that_disagree_are_told(void **state) {
  (void)state;
  refuse(square, "s:force('repulsion', { thickness = 2e-3 })\ns:corrector('contact', { thickness = 1e-3 })",
         "has a thickness of 0.002 m, this one of 0.001 m: give both the same");
  refuse(square, "s:force('repulsion', { leave = {1} })\ns:corrector('contact', { leave = {2} })",
         "leaves out other particles: give both the same list");
}

static void a_start_that_intersects_names_particles(void **state) {
  (void)state;
  refuse("vertices = {{0,0,0}, {1,0,0}, {0,1,0}, {0.2,0.2,-1}, {0.2,0.2,1}, {3,3,1}}, faces = {{1,2,3}, {4,5,6}}",
         contact, "2 pairs of an edge and a triangle, the first edge 2 3 and triangle 4 5 6");
}

/* ---- the table in a run ---- */

static const hk_surfaces *table_of(test_engine *e) {
  const hk_instances *services = &e->run->plugins.kind[HK_SERVICE];
  for (size_t k = 0; k < services->count; k++)
    if (strcmp(services->item[k]->plugin->name, "surfaces") == 0)
      return services->item[k]->plugin->service->table(services->item[k]->self);
  fail_msg("the run has no surfaces");
  return NULL;
}

/* Two triangles, one 0.01 above the other, at rest; contact has a thickness of 0.001. */
static void open_triangles(test_engine *e) {
  static const uint32_t triangle[2][3] = {{1, 2, 3}, {4, 5, 6}};
  test_engine_open(e);
  for (int k = 0; k < 2; k++) {
    test_particle(e, 0, 0, 0.01 * k, 1);
    test_particle(e, 1, 0, 0.01 * k, 1);
    test_particle(e, 0, 1, 0.01 * k, 1);
  }
  assert_int_equal(hk_scene_add_triangles(e->scene, 2, triangle, &e->error), HK_OK);
  test_plugin(e, HK_CORRECTOR, "contact");
  e->scene->fps = 10;
  e->scene->duration = 10;
  e->options.dt = 0.01;
}

static size_t pairs_now(test_engine *e) {
  const hk_surfaces *s = table_of(e);
  const hk_view *view = hk_run_view(e->run);
  hk_feature_pairs pairs;
  if (s->pairs(s->self, view->x, view->x, 0.02, &pairs) != HK_OK) fail_msg("%s", e->run->error.text);
  return pairs.count;
}

/* Each corner with the triangle, and each edge with those that it crosses or runs along in the plan. */
static void pins_that_are_released_can_meet(void **state) {
  (void)state;
  test_engine e;
  uint32_t ids[6] = {1, 2, 3, 4, 5, 6};
  hk_pin_spec pin = {.kind = HK_PIN_FIXED, .count = 6, .id = ids, .release = 0.1};
  open_triangles(&e);
  assert_int_equal(hk_scene_add_pin(e.scene, &pin, &e.error), HK_OK);
  test_run(&e);
  assert_int_equal(pairs_now(&e), 0);
  test_advance(&e, 0.3);
  assert_true(pairs_now(&e) >= 6 + 9);
  test_engine_close(&e);
}

static void births_join_the_surfaces(void **state) {
  (void)state;
  test_engine e;
  open_triangles(&e);
  test_vector(&e, test_plugin(&e, HK_SOURCE, "fixture:sower"), "position", 0.25, 0.25, 0.02);
  test_run(&e);
  const hk_surfaces *s = table_of(&e);
  const hk_surface_mesh *mesh = s->mesh(s->self);
  size_t before = pairs_now(&e), points = mesh->points;
  uint64_t number = mesh->number;
  test_advance(&e, 0.15);
  mesh = s->mesh(s->self);
  assert_int_equal(mesh->points, points + 1);
  assert_true(mesh->number != number);
  assert_true(mesh->edges == 7 && mesh->parts == 3);
  assert_int_equal(pairs_now(&e), before + 2); /* with either triangle */
  test_engine_close(&e);
}

static void a_report_counts_and_names(void **state) {
  (void)state;
  test_engine e;
  open_triangles(&e);
  test_run(&e);
  const hk_surfaces *s = table_of(&e);
  hk_view view = *hk_run_view(e.run);
  double x[18];
  hk_contact_report report = {0};
  memcpy(x, view.x, sizeof x);
  view.x = x;
  assert_int_equal(s->report(s->self, &view, &report), HK_OK);
  assert_true(report.intersections == 0 && report.first[0] == 0);
  x[2] = 0.02; /* the first corner goes up through the second triangle */
  x[0] = x[1] = 0.1;
  assert_int_equal(s->report(s->self, &view, &report), HK_OK);
  assert_int_equal(report.intersections, 2);
  assert_string_equal(report.first,
                      "edge 1 2 and triangle 4 5 6 at (0.55, 0.05, 0.01) m, all from (0.05, 0.05, 0.01) to (0.55, "
                      "0.55, 0.01) m");
  x[5] = NAN;
  assert_int_equal(s->report(s->self, &view, &report), HK_NOT_FINITE);
  assert_non_null(strstr(e.run->error.text, "particle 2 is at (1, 0, nan) m"));
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(bad_meshes_are_named),
      cmocka_unit_test(a_thickness_that_is_too_large_is_told_with_the_one_that_fits),
      cmocka_unit_test(plugins_that_disagree_are_told),
      cmocka_unit_test(errors_name_the_plugin_that_joins),
      cmocka_unit_test(a_heap_of_particles_is_refused_before_its_pairs_are_listed),
      cmocka_unit_test(a_start_that_intersects_names_particles),
      cmocka_unit_test(pins_that_are_released_can_meet),
      cmocka_unit_test(births_join_the_surfaces),
      cmocka_unit_test(a_report_counts_and_names),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
