/* Cables: slack they do nothing, taut they are bars that only pull, and becoming taut is an inelastic impact. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static const double g = 10;

/* A particle of 2 kg at (x, y) with (u, v), tied to a pin at the origin by 1 m of `what`. */
static void tie(test_engine *e, const char *method, const char *what, const double at[4]) {
  test_engine_open(e);
  test_plugin(e, HK_INTEGRATOR, method);
  test_vector(e, test_plugin(e, HK_FORCE, "gravity"), "g", 0, -g, 0);
  test_particle(e, 0, 0, 0, 1);
  test_particle(e, at[0], at[1], 0, 2);
  e->scene->particles.velocity[3] = at[2];
  e->scene->particles.velocity[4] = at[3];
  test_pin(e, HK_PIN_FIXED, 1, NULL);
  hk_plugin_spec *spec = test_plugin(e, HK_CONSTRAINT, what);
  test_edges(e, spec, (const uint32_t[][2]){{1, 2}}, 1);
  test_number(e, spec, "length", 1);
  e->scene->duration = 2;
  e->scene->fps = 100;
  e->options.dt = 1e-3;
}

/* Let go level with the pin, 0.6 m from it, it falls freely for sqrt(1.6/g) s to a depth of 0.8 m; there the cable is
 * taut, and what the velocity has along it ends: 0.8 of it. Leapfrog is exact for a parabola, and the impact is found
 * within a step, in which the speed changes by g h. */
static void a_fall_ends_at_the_length(void **state) {
  (void)state;
  test_engine e;
  double fall = sqrt(1.6 / g), speed = g * fall;
  tie(&e, "leapfrog", "cables", (double[]){0.6, 0, 0, 0});
  test_run(&e);
  test_advance(&e, fall - 2e-3);
  assert_true(fabs(test_position(&e, 2)[1] + g * (fall - 2e-3) * (fall - 2e-3) / 2) < 1e-12);
  test_advance(&e, fall + 2e-3);
  const double *v = test_velocity(&e, 2), *x = test_position(&e, 2);
  assert_true(fabs(x[0] * v[0] + x[1] * v[1]) < 1e-12);
  assert_true(fabs(hypot(v[0], v[1]) - 0.6 * speed) < 5 * g * 1e-3);
  assert_true(hypot(x[0], x[1]) < 1 + 1e-12);
  test_engine_close(&e);
}

/* While it is taut it is a bar, to rounding grown over a thousand steps. */
static void a_taut_cable_is_a_bar(void **state) {
  (void)state;
  double end[2][2];
  for (int k = 0; k < 2; k++) {
    test_engine e;
    tie(&e, "rk4", k ? "bars" : "cables", (double[]){0.8, -0.6, 0.3, 0.4});
    test_run(&e);
    test_advance(&e, 1);
    memcpy(end[k], test_position(&e, 2), sizeof end[k]);
    test_engine_close(&e);
  }
  assert_true(fabs(end[0][0] - end[1][0]) < 1e-10 && fabs(end[0][1] - end[1][1]) < 1e-10);
}

/* From the lowest point with v^2 = 3.5 g L the cable goes slack where v^2 = g L cos, measured from the top:
 * cos = (3.5 - 2)/3 = 1/2, 60 degrees from it. From there it is a parabola that ends inside the circle. */
static void a_cable_goes_slack_before_the_top(void **state) {
  (void)state;
  test_engine e;
  tie(&e, "rk4", "cables", (double[]){0, -1, sqrt(3.5 * g), 0});
  test_run(&e);
  double highest = -1, slack_at = 0, T;
  for (int frame = 1; frame <= 80; frame++) {
    test_advance(&e, frame / 100.0);
    const double *x = test_position(&e, 2);
    assert_int_equal(hk_run_constraint_forces(e.run, "cables", &T, &e.error), HK_OK);
    assert_true(T >= 0 && hypot(x[0], x[1]) < 1 + 1e-10);
    if (T == 0 && slack_at == 0) slack_at = x[1];
    highest = fmax(highest, x[1]);
  }
  /* Frames are 0.01 s apart, in which it rises by 0.02 m with sqrt(g L/2) sin 60. */
  assert_true(slack_at >= 0.5 - 1e-6 && slack_at < 0.53);
  /* The parabola from 60 degrees with v^2 = g/2: it rises by (v sin 60)^2/(2 g) = 3/16 m. */
  assert_true(fabs(highest - (0.5 + 3.0 / 16)) < 1e-3);
  test_engine_close(&e);
}

static void cables_of_no_length_are_refused(void **state) {
  (void)state;
  test_engine e;
  tie(&e, "leapfrog", "cables", (double[]){0.6, 0, 0, 0});
  hk_plugin_spec *spec = test_plugin(&e, HK_CONSTRAINT, "cables");
  test_edges(&e, spec, (const uint32_t[][2]){{2, 1}}, 1);
  test_number(&e, spec, "length", 0);
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
  assert_non_null(strstr(e.error.text, "particles 2 and 1"));
  assert_non_null(strstr(e.error.text, "weld"));
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_fall_ends_at_the_length),
      cmocka_unit_test(a_taut_cable_is_a_bar),
      cmocka_unit_test(a_cable_goes_slack_before_the_top),
      cmocka_unit_test(cables_of_no_length_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
