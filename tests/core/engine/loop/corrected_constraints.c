/* What a corrector moves is put on the constraints and pins again in the same step. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

/* A bar of 1 m falls on a floor, its lower end first: the floor lifts that end and stops it. Afterwards the bar is as
 * long as before, and its ends move at right angles to it, up to rounding: 1e-12 of the extent, and of the speed, is
 * what projections leave. */
static void constraints_hold_after_a_corrector_moved_something(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  e.scene->duration = 1;
  e.scene->fps = 100;
  e.options.dt = 0.01;
  test_particle(&e, 0, 0, 0.5, 1);
  test_particle(&e, 0.6, 0, 1.3, 2);
  test_edges(&e, test_plugin(&e, HK_CONSTRAINT, "fixture:bar"), (const uint32_t[][2]){{1, 2}}, 1);
  test_plugin(&e, HK_FORCE, "gravity");
  test_plugin(&e, HK_CORRECTOR, "fixture:floor");
  test_run(&e);
  for (int k = 1; k <= 60; k++) {
    test_advance(&e, k / 100.0);
    const double *x = hk_run_view(e.run)->x, *v = hk_run_view(e.run)->v;
    double d[3], along = 0, length = 0;
    for (int c = 0; c < 3; c++) d[c] = x[3 + c] - x[c], length += d[c] * d[c];
    for (int c = 0; c < 3; c++) along += d[c] * (v[3 + c] - v[c]);
    if (fabs(sqrt(length) - 1) > 1e-12) fail_msg("t = %g s: the bar is off by %g m", k / 100.0, sqrt(length) - 1);
    if (fabs(along) > 1e-11) fail_msg("t = %g s: its ends part at %g m/s", k / 100.0, along);
  }
  assert_true(e.run->record.moved); /* it did land */
  assert_true(e.run->record.violation_max < 1e-12);
  assert_true(hk_run_close(e.run, &e.error) == HK_OK);
  test_engine_close(&e);
}

/* A particle on a line that slopes: the floor lifts it off, the pin brings it back to the line, exactly up to rounding.
 */
static void pins_hold_after_a_corrector_moved_something(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  e.scene->duration = 1;
  e.scene->fps = 100;
  e.options.dt = 0.01;
  test_particle(&e, 0, 0, 0.5, 1);
  test_pin(&e, HK_PIN_LINE, 1, (const double[]){sqrt(0.5), 0, sqrt(0.5)});
  test_plugin(&e, HK_FORCE, "gravity");
  test_plugin(&e, HK_CORRECTOR, "fixture:floor");
  test_run(&e);
  test_advance(&e, 0.6);
  const double *x = test_position(&e, 1), *v = test_velocity(&e, 1);
  assert_true(e.run->record.moved);
  assert_true(fabs(x[2] - 0.5 - x[0]) < 1e-14 && x[1] == 0);
  assert_true(fabs(v[2] - v[0]) < 1e-14);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(constraints_hold_after_a_corrector_moved_something),
      cmocka_unit_test(pins_hold_after_a_corrector_moved_something),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
