/* Runs and tools that are stopped by signals at a hundred moments: stopped.h. */
#include "tests/core/app/command/stopped.h"

int main(void) {
  static int moments = 100;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_prestate(runs_stopped_by_signals_can_be_gone_on_from, &moments),
      cmocka_unit_test_prestate(tools_that_are_stopped_leave_no_child, &moments),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
