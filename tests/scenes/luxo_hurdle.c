/* Luxo jumps over a hurdle: the lamp crouches, both feet are above the hurdle while they pass it, and it lands and
 * stands again. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static const double g = 9.81, height = 0.12, place = 0.25; /* m/s^2; m, of the hurdle */

static double value(const char *key) { return test_json(strstr(r.out, "\"measures\""), key); }

static void run_until(double t) {
  char option[32];
  snprintf(option, sizeof option, "--until %.6g", t);
  test_scene(&r, "luxo_hurdle", option);
}

static void it_crouches_before_it_jumps(void **state) {
  (void)state;
  run_until(0.7);
  assert_true(value("z[6]") < 0.45);
  assert_true(fabs(value("x[1]") + 0.12) < 5e-3 && fabs(value("z[1]")) < 5e-3);
}

/* Muscles and links change no momentum: the climb falls by g t, up to rounding. */
static void it_flies_freely(void **state) {
  (void)state;
  run_until(0.8);
  const double leaves = value("climb");
  run_until(1.2);
  assert_true(fabs(leaves - value("climb") - g * 0.4) < 1e-9);
}

/* Both feet are on this side at first and on the other side at last, and at knots and between them above the hurdle,
 * which is 0.03 m thick; knots of a hundredth of a newton leave less than 1 mm. */
static void both_feet_pass_above_the_hurdle(void **state) {
  (void)state;
  static const char *const x[] = {"x[1]", "x[2]"}, *const z[] = {"heel_height", "toe_height"};
  for (int k = 0; k <= 24; k++) {
    run_until(0.8 + k / 60.0);
    for (int foot = 0; foot < 2; foot++) {
      double aside = value(x[foot]) - place;
      assert_true(fabs(aside) > 0.015 || value(z[foot]) > height - 1e-3);
      assert_true(k > 0 || aside < -0.015);
      assert_true(k < 24 || aside > 0.015);
    }
  }
}

/* Knots of a hundredth of a newton. */
static void it_lands_on_both_feet_and_stands_again(void **state) {
  (void)state;
  run_until(1.2);
  assert_true(fabs(value("x[1]") - 0.38) < 1e-3 && fabs(value("x[2]") - 0.62) < 1e-3);
  assert_true(fabs(value("z[1]")) < 1e-3 && fabs(value("z[2]")) < 1e-3);
  test_scene(&r, "luxo_hurdle", "");
  assert_true(fabs(value("x[4]") - 0.3) < 1e-3 && fabs(value("z[4]") - 0.4) < 1e-3);
  assert_true(fabs(value("x[6]") - 0.75) < 1e-3 && fabs(value("z[6]") - 0.55) < 1e-3);
  assert_true(fabs(value("vx[6]")) < 0.01 && fabs(value("vz[6]")) < 0.01);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(it_crouches_before_it_jumps),
      cmocka_unit_test(it_flies_freely),
      cmocka_unit_test(both_feet_pass_above_the_hurdle),
      cmocka_unit_test(it_lands_on_both_feet_and_stands_again),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
