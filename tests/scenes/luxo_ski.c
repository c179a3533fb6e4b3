/* Luxo's ski jump: the lamp crouches before it leaves the upper slope, flies freely, lands on the lower one, gives way,
 * and slides on as it stood. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static const double g = 9.81, steepness = 0.3490658503988659; /* m/s^2; 20 degrees */

static double value(const char *key) { return test_json(strstr(r.out, "\"measures\""), key); }

/* How much faster the centre of mass rises than that of a lamp that only slides. */
static double lift(const char *until, double t) {
  char option[32] = "--until ";
  test_scene(&r, "luxo_ski", strcat(option, until));
  return value("climb") + g * sin(steepness) * sin(steepness) * t;
}

static void it_crouches_and_springs(void **state) {
  (void)state;
  assert_true(lift("0.7", 0.7) < -0.2);
  assert_true(lift("0.8", 0.8) > 0.4);
}

/* Muscles and links change no momentum: the climb falls by g t, up to rounding. */
static void it_flies_freely_above_the_lower_slope(void **state) {
  (void)state;
  test_scene(&r, "luxo_ski", "--until 0.8");
  const double leaves = value("climb");
  test_scene(&r, "luxo_ski", "--until 1.0");
  assert_true(value("heel_above") > 0.1 && value("toe_above") > 0.1);
  test_scene(&r, "luxo_ski", "--until 1.2");
  assert_true(fabs(leaves - value("climb") - g * 0.4) < 1e-9);
}

/* Knots of a tenth of a newton, for which it lands 0.2 mm off. */
static void it_lands_on_both_feet(void **state) {
  (void)state;
  test_scene(&r, "luxo_ski", "--until 1.2");
  assert_true(fabs(value("heel_above")) < 1e-3 && fabs(value("toe_above")) < 1e-3);
  assert_true(fabs(value("heel_falls")) < 0.02 && fabs(value("toe_falls")) < 0.02);
  assert_true(fabs(value("toe_along") - 1.47) < 1e-3);
}

static void it_gives_way_and_stands_again(void **state) {
  (void)state;
  test_scene(&r, "luxo_ski", "--until 1.25");
  assert_true(value("head_above") < 0.5);
  test_scene(&r, "luxo_ski", "");
  assert_true(fabs(value("head_above") - 0.55) < 2e-3 && fabs(value("head_ahead") - 0.25) < 2e-3);
  assert_true(fabs(value("head_speed")) < 0.05 && fabs(value("head_falls")) < 0.05);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(it_crouches_and_springs),
      cmocka_unit_test(it_flies_freely_above_the_lower_slope),
      cmocka_unit_test(it_lands_on_both_feet),
      cmocka_unit_test(it_gives_way_and_stands_again),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
