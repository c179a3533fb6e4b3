/* --dt is the longest step of every method, of those that choose their steps as well. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* So slow that these methods take steps of a frame, 50 ms, by themselves. */
static void a_step_that_is_given_is_the_longest(void **state) {
  (void)state;
  static const char *const methods[] = {"leapfrog", "bdf2", "dopri5", "tr_bdf2", "esdirk4", "linear_bdf2"};
  static test_result r;
  test_write("slow.lua", "local scene = hooke.scene { duration = 0.5, fps = 20 }\n"
                         "local p = scene:strand { n = 4, from = { 0, 0, 0 }, to = { 1, 0, 0 }, mass = 1 }\n"
                         "scene:force('springs', { edges = p:edges(), k = 0.1 })\n"
                         "scene:force('gravity')\nreturn scene\n");
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    char arguments[128];
    snprintf(arguments, sizeof arguments, "run slow.lua --json --quiet --no-output --dt 4e-3 --integrator %s",
             methods[k]);
    test_hooke(&r, NULL, arguments);
    double longest = test_json(r.out, "dt_max");
    if (r.code != 0 || !(longest <= 4e-3 * (1 + 1e-9)))
      fail_msg("%s: %d, %g s: %s", methods[k], r.code, longest, r.err);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_step_that_is_given_is_the_longest)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
