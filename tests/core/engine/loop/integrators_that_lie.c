/* What an integrator reports is checked: each way of breaking the contract ends the run with code 2 and a sentence that
 * names the plugin. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void expect(const char *plugin, const char *how, int code, const char *text) {
  static test_result r;
  char scene[1024];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 0.5, fps = 10, integrator = { '%s/tests/fixtures/%s.so', how = '%s' "
           "} }\nscene:particle { position = {0, 0, 1}, velocity = {1, 0, 0}, mass = 1 }\nscene:force('gravity')\n"
           "return scene\n",
           HK_BUILD, plugin, how);
  test_write("lie.lua", scene);
  test_hooke(&r, NULL, "run lie.lua --trust --quiet --dt 0.01");
  if (r.code != code) fail_msg("%s, %s: exit %d instead of %d; it said: %s", plugin, how, r.code, code, r.err);
  if (code && (!strstr(r.err, text) || !strstr(r.err, plugin) || !strstr(r.err, "at t = 0 s")))
    fail_msg("%s, %s: expected '%s', the plugin and the time in: %s", plugin, how, text, r.err);
}

static void those_that_keep_the_contract_run(void **state) {
  (void)state;
  expect("liar", "truth", 0, "");
  expect("adaptive_liar", "truth", 0, "");
}

static void a_fixed_step_method_takes_the_step_that_it_is_given(void **state) {
  (void)state;
  static const char *const lies[] = {"beyond", "shorter", "no_length", "backward"};
  for (size_t k = 0; k < sizeof lies / sizeof *lies; k++)
    expect("liar", lies[k], 2, "has a fixed step and reports another one than it was given");
  expect("liar", "untouched", 2, "took a step without saying how long it was");
}

static void an_adaptive_method_says_what_step_it_took_within_its_stop(void **state) {
  (void)state;
  expect("adaptive_liar", "untouched", 2, "took a step without saying how long it was");
  expect("adaptive_liar", "beyond", 2, "reports a step that is not above 0, or beyond its stop");
  expect("adaptive_liar", "no_length", 2, "reports a step that is not above 0, or beyond its stop");
  expect("adaptive_liar", "backward", 2, "reports a step that is not above 0, or beyond its stop");
  expect("adaptive_liar", "no_next", 2, "does not say what step it would take next");
}

static void time_and_vector_are_the_hosts(void **state) {
  (void)state;
  static const char *const plugins[] = {"liar", "adaptive_liar"};
  for (int k = 0; k < 2; k++) {
    expect(plugins[k], "time", 2, "moved the time, which is the host's");
    expect(plugins[k], "vector", 2, "changed the system, which is the host's");
    expect(plugins[k], "count", 2, "changed the system, which is the host's");
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(those_that_keep_the_contract_run),
      cmocka_unit_test(a_fixed_step_method_takes_the_step_that_it_is_given),
      cmocka_unit_test(an_adaptive_method_says_what_step_it_took_within_its_stop),
      cmocka_unit_test(time_and_vector_are_the_hosts),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
