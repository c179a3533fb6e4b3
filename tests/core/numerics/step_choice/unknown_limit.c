/* Where the largest stable step cannot be estimated, since forces close to the start are not finite, the run says so:
 * its step is no given one, and no verdict may pass over that in silence. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

/* At rest F is 0; the smallest strain makes it infinite. */
static void a_limit_that_is_not_known_is_said(void **state) {
  (void)state;
  static test_result r;
  test_write("stiff.lua", "local scene = hooke.scene { duration = 0.1, fps = 20 }\n"
                          "local g = scene:grid { nx = 3, ny = 3, width = 1, height = 1, mass = 1 }\n"
                          "scene:force('springs', { edges = g:edges(), k = 1e308 })\n"
                          "return scene\n");
  test_hooke(&r, NULL, "run stiff.lua --json --no-output");
  assert_non_null(strstr(r.err, "the largest stable step is not known"));
  assert_non_null(strstr(r.out, "\"step\":\"0.05 s (chosen)\""));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_limit_that_is_not_known_is_said)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
