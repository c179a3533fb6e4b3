/* What has molten or broken leaves the surface of a scene: its triangles, edges, and what rests on them. */
#include "tests/support/melting.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { CELLS = MELTING_SIDE - 1, TRIANGLES = 2 * CELLS * CELLS, EDGES = 2 * MELTING_SIDE * CELLS };

static const double softens = 280, range = 10, growth = 40; /* K; K; K/s */

static void open_sheet(test_engine *e, const char *force) {
  test_engine_open(e);
  melting_sheet(e, force, softens, range);
  melting_warms(e, growth);
  for (uint32_t id = 1; id <= MELTING_SIDE * MELTING_SIDE; id++) test_pin(e, HK_PIN_FIXED, id, NULL);
  e->options.integrator = "leapfrog";
  e->options.dt = 1e-3;
  e->scene->fps = 100;
  e->scene->duration = 10;
}

/* Column i is at 230 + 10 i + 40 t K. The triangles of the cells between columns i and i + 1 have two corners in the
 * second or in the first: they have molten after 1.5 - 0.25 (i + 2/3) and 1.5 - 0.25 (i + 1/3) s, in the last column of
 * cells after 0.58 and 0.67 s, in the one before after 0.83 s. Of its edges go first the four of the last column of
 * particles and that to the corner which is in no triangle then, and then all that lead there. */
static void molten_triangles_leave_the_surface(void **state) {
  (void)state;
  test_engine e;
  open_sheet(&e, "melting_membrane");
  test_run(&e);
  const hk_model *m = hk_run_view(e.run)->model;
  assert_int_equal(m->triangles.count, TRIANGLES);
  assert_int_equal(m->edges.count, EDGES);
  test_advance(&e, 0.62);
  assert_int_equal(m->triangles.count, TRIANGLES - CELLS);
  assert_int_equal(m->edges.count, EDGES - CELLS - 1);
  test_advance(&e, 0.75);
  assert_int_equal(m->triangles.count, TRIANGLES - 2 * CELLS);
  assert_int_equal(m->edges.count, EDGES - CELLS - MELTING_SIDE);
  for (size_t k = 0; k < m->edges.count; k++)
    for (int c = 0; c < 2; c++) assert_true(m->id[hk_tuple(&m->edges, k)[c]] < melting_sheet_at(CELLS, 0));
  test_advance(&e, 2);
  assert_int_equal(m->triangles.count + m->edges.count, 0);
  test_engine_close(&e);
}

/* The springs of the last column are gone after 0.5 s, and with them the triangles of which they are sides; the others
 * still hold the rest. */
static void a_triangle_without_a_side_is_no_surface(void **state) {
  (void)state;
  test_engine e;
  open_sheet(&e, "melting_springs");
  test_run(&e);
  test_advance(&e, 0.55);
  const hk_model *m = hk_run_view(e.run)->model;
  assert_int_equal(m->triangles.count, TRIANGLES - CELLS);
  assert_int_equal(m->edges.count, EDGES - CELLS);
  test_engine_close(&e);
}

/* What is warm at the start is in no surface from the first frame on. */
static void what_is_gone_at_the_start_was_never_there(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  melting_sheet(&e, "melting_membrane", softens - 30, range);
  test_run(&e);
  const hk_model *m = hk_run_view(e.run)->model;
  assert_int_equal(m->triangles.count, TRIANGLES - 2 * CELLS);
  test_engine_close(&e);
}

/* A weight that lies on the last column of cells falls when they have molten, by either way of contact. */
static void what_lies_on_it_falls_through(void **state) {
  (void)state;
  static const char *const forces[] = {"repulsion", "barrier", NULL};
  for (int k = 0; k < 3; k++) {
    test_engine e;
    open_sheet(&e, "melting_membrane");
    if (k == 1) e.options.integrator = "backward_euler"; /* which the stiffness of a barrier asks for */
    uint32_t weight = test_particle(&e, 0.34, 0.22, 0.02, 0.01);
    test_vector(&e, test_plugin(&e, HK_FORCE, "gravity"), "g", 0, 0, -9.81);
    hk_plugin_spec *spec = test_plugin(&e, forces[k] ? HK_FORCE : HK_CORRECTOR, forces[k] ? forces[k] : "contact");
    if (k == 0) test_number(&e, spec, "radius", 0.005), test_number(&e, spec, "thickness", 0.01);
    if (k == 0) test_number(&e, spec, "reach", 0.005), test_number(&e, spec, "stiffness", 1e3);
    test_run(&e);
    test_advance(&e, 0.55);
    if (!(test_position(&e, weight)[2] > -0.001 && test_position(&e, weight)[2] < 0.021))
      fail_msg("%d: at %g m", k, test_position(&e, weight)[2]);
    test_advance(&e, 0.9);
    if (!(test_position(&e, weight)[2] < -0.1))
      fail_msg("%s: at %g m", forces[k] ? forces[k] : "contact", test_position(&e, weight)[2]);
    test_engine_close(&e);
  }
}

/* Hinges of the scene's triangles end with them, and the energy balance knows it. */
static void hinges_of_the_surface_end_with_it(void **state) {
  (void)state;
  test_engine e;
  hk_summary s;
  test_engine_open(&e);
  melting_sheet(&e, "melting_membrane", softens, range);
  melting_warms(&e, growth);
  for (uint32_t id = 1; id <= 2 * MELTING_SIDE; id++) test_pin(&e, HK_PIN_FIXED, id, NULL);
  test_vector(&e, test_plugin(&e, HK_FORCE, "gravity"), "g", 0, 0, -9.81);
  test_number(&e, test_plugin(&e, HK_FORCE, "quadratic_bending"), "rigidity", 0.01);
  e.options.integrator = "leapfrog";
  e.options.dt = 1e-4;
  e.scene->fps = 100;
  e.scene->duration = 10;
  test_run(&e);
  test_advance(&e, 0.75);
  const uint32_t last = melting_sheet_at(CELLS, 2);
  double v = test_velocity(&e, last)[2];
  test_advance(&e, 0.8);
  hk_run_summary(e.run, &s);
  print_message("falls by %.6g m/s in 0.05 s, drift %.2g\n", v - test_velocity(&e, last)[2], s.energy_drift);
  assert_true(fabs(test_velocity(&e, last)[2] - v + 9.81 * 0.05) < 1e-9);
  assert_true(fabs(s.energy_drift) < 1e-3);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(molten_triangles_leave_the_surface),
      cmocka_unit_test(a_triangle_without_a_side_is_no_surface),
      cmocka_unit_test(what_is_gone_at_the_start_was_never_there),
      cmocka_unit_test(what_lies_on_it_falls_through),
      cmocka_unit_test(hinges_of_the_surface_end_with_it),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
