/* --output: an output that the user adds to the scene's. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const char ball[] =
    "local scene = hooke.scene { duration = 0.1, fps = 10, integrator = 'leapfrog', dt = 1e-2 }\n"
    "scene:particle { position = {0, 0, 1}, mass = 1 }\n"
    "scene:force('gravity', { g = { 0, 0, -1 } })\n"
    "if param('own', 0) == 1 then scene:output('table', { file = 'own.csv' }) end\n"
    "return scene\n";

static test_result r;

static void an_output_is_added_with_its_parameters(void **state) {
  (void)state;
  test_write("ball.lua", ball);
  test_hooke(&r, NULL, "run ball.lua --output table:file=more.csv --out more");
  assert_int_equal(r.code, 0);
  assert_true(test_exists("more/more.csv") && test_exists("more/summary.json"));
  test_hooke(&r, NULL, "run ball.lua --output table --no-output --out none");
  assert_false(test_exists("none"));
}

static void it_is_not_there_twice(void **state) {
  (void)state;
  test_hooke(&r, NULL, "run ball.lua own=1 --output table:file=more.csv --out own");
  assert_int_equal(r.code, 0);
  assert_true(test_exists("own/own.csv"));
  assert_false(test_exists("own/more.csv"));
}

static void refused(const char *options, const char *text) {
  char arguments[256];
  snprintf(arguments, sizeof arguments, "run ball.lua --out none %s", options);
  test_hooke(&r, NULL, arguments);
  assert_int_equal(r.code, 1);
  if (!strstr(r.err, text)) fail_msg("no '%s' in: %s", text, r.err);
}

static void names_and_values_are_checked(void **state) {
  (void)state;
  refused("--output tabel", "did you mean 'table'");
  refused("--output leapfrog", "there is no output 'leapfrog'");
  refused("--output table:fil=a", "did you mean 'file'");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_output_is_added_with_its_parameters),
      cmocka_unit_test(it_is_not_there_twice),
      cmocka_unit_test(names_and_values_are_checked),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
