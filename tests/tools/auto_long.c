/* --integrator auto where no method can reach the accuracy, which takes many runs to find out. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

/* The double pendulum for 60 s: two good methods part before the end, and the verdict says so. */
static void what_is_not_determined_is_not_promised(void **state) {
  (void)state;
  test_hooke(&r, "XDG_CACHE_HOME=cache",
             "run " HK_ROOT "/scripts/scenes/double_pendulum.lua --integrator auto --accuracy 1e-3 --json --no-output");
  if (r.code != 5) fail_msg("exit %d instead of 5: %s%s", r.code, r.out, r.err);
  assert_non_null(strstr(r.err, "s two good methods part"));
  assert_non_null(strstr(r.out, "\"verdict\":\"inaccurate\""));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_not_determined_is_not_promised)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
