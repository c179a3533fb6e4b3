/* Options of a pin that stand in the wrong place are refused and not passed over: the particle would be held for good.
 */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#define HEAD "local scene = hooke.scene { duration = 1, fps = 10 }\nlocal p = scene:particle { mass = 1 }\n"

static void options_among_the_ids_are_refused(void **state) {
  (void)state;
  test_refused(HEAD "scene:pin { p, path = function(t) return t, 0, 0 end }\nreturn scene\n", "", 1,
               "bad.lua:3: pin: 'path' is no particle; options are a second table, scene:pin(ids, { path = ... })");
  test_refused(HEAD "scene:pin { p, release = 0.5 }\nreturn scene\n", "", 1, "pin: 'release' is no particle");
}

static void options_that_are_no_table_are_refused(void **state) {
  (void)state;
  test_refused(HEAD "scene:pin({ p }, function(t) return t, 0, 0 end)\nreturn scene\n", "", 1,
               "bad.lua:3: pin: options are a table, scene:pin(ids, { path = f }), got function");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(options_among_the_ids_are_refused),
      cmocka_unit_test(options_that_are_no_table_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
