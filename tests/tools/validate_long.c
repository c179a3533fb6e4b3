/* hooke validate finds a plugin that is wrong by a factor. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static void validate(const char *arguments, int code) {
  char all[2048];
  snprintf(all, sizeof all, "validate %s", arguments);
  test_hooke(&r, NULL, all);
  if (r.code != code) fail_msg("%s: exit %d instead of %d: %s%s", arguments, r.code, code, r.out, r.err);
}

static void says(const char *where, const char *text) {
  if (!strstr(where, text)) fail_msg("no '%s' in: %s%s", text, r.out, r.err);
}

/* The fixture's force is 0.999 of what it says; the engine's own is the same problem's force under another file. */
static void a_plugin_with_a_wrong_factor_is_found(void **state) {
  (void)state;
  validate("oscillators damped --quick --no-page --plugin '" HK_BUILD "/plugins/forces/central.so'", 0);
  says(r.out, "damped, central for central");
  validate("oscillators damped --no-page --plugin '" HK_BUILD "/tests/fixtures/weak_central.so'", 5);
  says(r.out, "WRONG damped, weak_central for central");
  /* Every problem names forces and parameters that are there; springs stand in for springs in many. */
  validate("--list --plugin '" HK_BUILD "/plugins/forces/springs.so'", 0);
  says(r.out, "membrane, springs for springs");
  validate("--no-page --plugin '" HK_BUILD "/plugins/forces/ropes.so'", 1);
  says(r.err, "ropes has the parameters of cubic_springs and of springs: --as says in the place of which it is tried");
  validate("oscillators --no-page --as drag --plugin '" HK_BUILD "/tests/fixtures/weak_central.so'", 1);
  says(r.err, "weak_central can stand in nowhere here as drag");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_plugin_with_a_wrong_factor_is_found),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
