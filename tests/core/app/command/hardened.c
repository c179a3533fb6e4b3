/* hooke as it is built by default: position-independent, its tables of functions read-only once it runs, with guarded
 * stacks and checked copies. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void expect(const char *file, const char *question) {
  static test_result r;
  char before[1024];
  snprintf(before, sizeof before, "readelf -hldsW %s/%s | grep -q '%s' || exit 9;", HK_BUILD, file, question);
  test_hooke(&r, before, "--version");
  if (r.code != 0) fail_msg("%s: no %s", file, question);
}

static void the_build_is_hardened(void **state) {
  (void)state;
  static const char *const files[] = {"hooke", "plugins/forces/springs.so", "plugins/integrators/leapfrog.so"};
  static test_result r;
  test_hooke(&r, "command -v readelf || exit 9;", "--version");
  if (r.code == 9 || strstr(HK_BUILD, "sanitize")) skip();
  for (size_t k = 0; k < sizeof files / sizeof *files; k++) {
    expect(files[k], "Type: *DYN");
    expect(files[k], "GNU_RELRO");
    expect(files[k], "BIND_NOW");
    expect(files[k], "GNU_STACK .* RW ");
  }
  expect("hooke", "__stack_chk_fail");
  expect("hooke", "__snprintf_chk");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_build_is_hardened)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
