/* Water that is poured: numbers that are known before it meets the bowl. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static test_result r;

static void near(double found, double wanted, double tolerance) {
  if (!(fabs(found - wanted) <= tolerance)) fail_msg("%.17g instead of %.17g", found, wanted);
}

/* Leapfrog is exact where the acceleration is constant: the first grain of the first thread leaves 0.41 m above the
 * table with 1.2 m/s at once, and falls freely; rounding of some hundred steps. Each of seven threads gives a grain
 * every 2 radius / speed = 17.5 ms, one after the other: 0.1 s are 40 grains, and up to one more, as the first comes at
 * once. */
static void water_falls_out_of_the_spout(void **state) {
  (void)state;
  test_scene(&r, "pour", "size=0.02 --until 0.1 --trust");
  near(test_json(r.out, "lowest"), 0.41 - 1.2 * 0.1 - 9.81 * 0.1 * 0.1 / 2, 1e-12);
  near(test_json(r.out, "grains"), 40.5, 0.5);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(water_falls_out_of_the_spout),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
