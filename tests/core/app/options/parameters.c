/* hooke run SCENE.lua --help: the parameters with their limits, as a table and as JSON. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static const char scene[] = "local n = param('n', 4, 'particles', { min = 2, max = 64 })\n"
                            "local k = param('k', 1.5, 'N/m', { min = 0 })\n"
                            "local w = param('w', 1, '1/s', { max = 9 })\n"
                            "param('method', 'leapfrog', 'a \"name\"')\n"
                            "param('rough', false)\n"
                            "local scene = hooke.scene { duration = 0.1 }\n"
                            "scene:particle { mass = n * k * w }\n"
                            "return scene\n";

static void has(const char *text) {
  if (!strstr(r.out, text)) fail_msg("'%s' is not in: %s%s", text, r.out, r.err);
}

static void the_help_shows_limits(void **state) {
  (void)state;
  test_write("scene.lua", scene);
  test_hooke(&r, NULL, "run scene.lua --help");
  assert_int_equal(r.code, 0);
  has("particles (2 to 64)\n");
  has("N/m (at least 0)\n");
  has("1/s (at most 9)\n");
  has("a \"name\"\n");
}

static void json_has_types_values_and_limits(void **state) {
  (void)state;
  test_write("scene.lua", scene);
  test_hooke(&r, NULL, "run scene.lua n=8 --help --json");
  assert_int_equal(r.code, 0);
  assert_int_equal(strncmp(r.out, "{\"parameters\":[{", 16), 0);
  has("\"name\":\"n\",\"type\":\"integer\",\"initial\":\"4\",\"value\":\"8\",\"help\":\"particles\",\"min\":2,\"max\":"
      "64}");
  has("\"name\":\"k\",\"type\":\"number\",\"initial\":\"1.5\",\"value\":\"1.5\",\"help\":\"N/"
      "m\",\"min\":0,\"max\":null}");
  has("\"type\":\"string\",\"initial\":\"leapfrog\",\"value\":\"leapfrog\",\"help\":\"a \\\"name\\\"\",\"min\":null");
  has("\"name\":\"rough\",\"type\":\"boolean\"");
}

static void a_value_beyond_its_limits_is_refused(void **state) {
  (void)state;
  test_refused(scene, "n=65", 1, "parameter n: 65 is above the maximum 64");
  test_refused(scene, "k=-1", 1, "parameter k: -1 is below the minimum 0");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_help_shows_limits),
                                     cmocka_unit_test(json_has_types_values_and_limits),
                                     cmocka_unit_test(a_value_beyond_its_limits_is_refused)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
