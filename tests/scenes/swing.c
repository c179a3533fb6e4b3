/* The swing: pumped, it has the energy that was asked for, and at rest it keeps what it has. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static double value(const char *key) { return test_json(strstr(r.out, "\"measures\""), key); }

/* Knots of four decimals, 2e-3 of what they are; the goal was met for the exact ones. */
static void pumping_gives_the_energy_that_was_asked_for(void **state) {
  (void)state;
  test_scene(&r, "swing", "");
  assert_true(fabs(value("energy") - 1) < 3e-3);
  assert_true(fabs(value("distance") - 2.52) < 1e-3 && fabs(value("climb")) < 5e-3);
}

/* Without pumping it has g L (1 - cos 0.2) less g times the stretch, m g/k (1 + 2 (1 - cos 0.2)) at the lowest place;
 * the damper takes what the fall of the start leaves in the bounce, and from then on a little of the stretch that
 * changes. */
static void without_pumping_it_keeps_its_energy(void **state) {
  (void)state;
  const double g = 9.81, rise = 1 - cos(0.2), stretch = 40 * g / 2e4;
  test_scene(&r, "swing", "pump=\"12: 0 0\"");
  assert_true(fabs(value("energy") - (g * 2.5 * rise - g * stretch)) < 0.01);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(pumping_gives_the_energy_that_was_asked_for),
      cmocka_unit_test(without_pumping_it_keeps_its_energy),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
