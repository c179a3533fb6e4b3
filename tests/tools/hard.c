/* The corpus of hard cases, tests/hard: every integrator reaches a case's bound or says that it did not, and those that
 * have to reach it do. Runs of at most 15,000 steps; `make study` holds the long ones. Sanitizers look for other faults
 * than wrong verdicts, which are the same in their builds, so they see every fourth run. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static void no_run_says_ok_beyond_its_bound(void **state) {
  (void)state;
  char arguments[512];
  snprintf(arguments, sizeof arguments, "stability --hard %s/tests/hard --trust --quiet --timeout 300%s", HK_ROOT,
           strstr(HK_BUILD, "sanitize") ? " --part 1/4" : "");
  test_hooke(&r, NULL, arguments);
  const char *counts = strstr(r.out, "\nslowest");
  print_message("%s", counts ? counts : r.out);
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  assert_non_null(strstr(r.out, " 0 failed"));
  assert_null(strstr(r.err, "left out"));
}

/* A hooke that was built without the plugins for tests, here a copy: cases that need them are left out, with a word. */
static void cases_without_their_plugins_are_left_out(void **state) {
  (void)state;
  test_hooke(&r,
             "mkdir -p copy/build copy/core && cp -r " HK_ROOT "/tools " HK_ROOT "/scripts copy/ && cp " HK_ROOT
             "/core/plugin.h copy/core/ && cp -r " HK_BUILD "/hooke " HK_BUILD "/plugins " HK_BUILD
             "/tools copy/build/ && copy/build/hooke stability --hard " HK_ROOT "/tests/hard --integrators leapfrog "
             "--quiet --case free_fall --case births --case floor_catches && ",
             "--version");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  assert_non_null(strstr(r.err, "2 of 3 cases are left out (births, floor_catches): their plugins for tests, such as "
                                "sower.so, are not built; make test-programs builds them"));
  assert_non_null(strstr(r.out, "1 cases"));
  test_hooke(&r, NULL, "stability --hard nowhere");
  assert_true(r.code == 1 &&
              strstr(r.err, "nowhere is not a folder of cases; hooke's sources have some in tests/hard"));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(cases_without_their_plugins_are_left_out),
                                     cmocka_unit_test(no_run_says_ok_beyond_its_bound)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
