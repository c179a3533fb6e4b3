/* The crane: its load is at rest where it shall be, and both masses together move as the drive alone says. */
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

/* The knots of the script have five digits, so that 1e-5 of 5 m is what they leave; the scene's steps leave 1e-5 m. */
static void the_load_is_brought_to_rest(void **state) {
  (void)state;
  test_scene(&r, "crane", "");
  assert_true(fabs(value("load") - 5) < 3e-4 && fabs(value("trolley") - 5) < 3e-4);
  assert_true(fabs(value("load_speed")) < 3e-4 && fabs(value("trolley_speed")) < 3e-4);
}

/* Nothing but the drive acts along the beam: the centre of mass of 50 and 20 kg moves by the integral of (6 s - t) F/70
 * kg, which is 7.5 - 1.5 = 6 m for 70 N that fall to nothing in 3 s and then to -70 N. */
static void the_centre_of_mass_follows_the_drive(void **state) {
  (void)state;
  test_scene(&r, "crane", "drive=\"6: 70 0 -70\"");
  assert_true(fabs((50 * value("trolley") + 20 * value("load")) / 70 - 6) < 1e-4);
  assert_true(fabs(50 * value("trolley_speed") + 20 * value("load_speed")) < 1e-6);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_load_is_brought_to_rest),
      cmocka_unit_test(the_centre_of_mass_follows_the_drive),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
