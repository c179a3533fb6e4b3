/* --integrator auto: choices that are damaged or out of date are made anew; a cloth, a rope that comes taut late; and
 * where no method can reach the accuracy, which takes many runs to find out. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static void hooke(const char *arguments) { test_hooke(&r, "XDG_CACHE_HOME=cache", arguments); }

static void expect(int code, const char *text) {
  if (r.code != code) fail_msg("exit %d instead of %d: %s%s", r.code, code, r.out, r.err);
  if (!strstr(r.err, text)) fail_msg("no '%s' in: %s", text, r.err);
}

#define SCENES HK_ROOT "/scripts/scenes/"

/* A user's first run may have to make the folders, before the process gives up files. */
static void the_choice_is_kept_where_there_was_no_cache(void **state) {
  (void)state;
  static const char line[] = "run " SCENES "sine.lua k=5 --integrator auto --accuracy 1e-3 --no-output";
  test_hooke(&r, "XDG_CACHE_HOME=not/yet", line);
  expect(0, "kept in not/yet/hooke/auto-");
  test_hooke(&r, "XDG_CACHE_HOME=not/yet", line);
  expect(0, "chosen before");
}

static void a_damaged_choice_is_made_anew(void **state) {
  (void)state;
  static const char *const damaged[] = {"{\"integrator\": \"leapfrog\", \"why\": \"it is fast\", \"dt\": -1}",
                                        "{\"integrator\": \"none_such\", \"why\": \"it was there\"}", "{"};
  test_hooke(&r, "XDG_CACHE_HOME=bad", "auto " SCENES "sine.lua k=5 --accuracy 1e-3 --budget 0.2");
  for (size_t k = 0; k < sizeof damaged / sizeof *damaged; k++) {
    char before[256];
    snprintf(before, sizeof before, "for f in bad/hooke/*; do echo '%s' > $f; done; XDG_CACHE_HOME=bad", damaged[k]);
    test_hooke(&r, before, "auto " SCENES "sine.lua k=5 --accuracy 1e-3 --budget 0.2");
    expect(0, "measured in");
  }
}

/* A module beside the scene belongs to it. */
static void the_choice_is_made_anew_when_a_module_changes(void **state) {
  (void)state;
  test_write("pull.lua", "return 30\n");
  test_write("with.lua", "local scene = hooke.scene { duration = 1, fps = 30 }\n"
                         "scene:particle { position = { 1, 0, 0 }, mass = 1 }\n"
                         "scene:force('central', { strength = require('pull') })\nreturn scene\n");
  hooke("auto with.lua --accuracy 1e-3 --budget 0.2");
  expect(0, "measured in");
  hooke("auto with.lua --accuracy 1e-3 --budget 0.2");
  expect(0, "chosen before");
  test_write("pull.lua", "return 31\n");
  hooke("auto with.lua --accuracy 1e-3 --budget 0.2");
  expect(0, "measured in");
}

/* A cloth: the pilot sees a part of it only; the run is judged over all of it. */
static void a_cloth_is_right_to_the_accuracy_in_the_end(void **state) {
  (void)state;
  hooke("run " SCENES "curtain.lua N=8 --until 0.5 --integrator auto --accuracy 1e-3 --json --no-output");
  expect(0, "measured");
  assert_true(test_json(r.out, "verify_difference") <= 0.5e-3);
}

/* A mass falls freely until its rope comes taut, beyond what two methods agree on in the pilot: any step is right
 * there. */
static void a_rope_that_comes_taut_late_is_foreseen(void **state) {
  (void)state;
  test_write("late.lua", "local scene = hooke.scene { duration = 1.2, fps = 60, accuracy = 1e-4 }\n"
                         "scene:particle { position = { 0, 0, 0 }, mass = 1 }\n"
                         "scene:particle { position = { 0.2, 0, -0.1 }, mass = 2 }\n"
                         "scene:pin { 1 }\n"
                         "scene:force('gravity')\n"
                         "scene:force('ropes', { edges = { { 1, 2 } }, rest = 1.5, k = 4000, damping = 20 })\n"
                         "return scene\n");
  hooke("run late.lua --integrator auto --json --no-output");
  expect(0, "over the whole run");
  assert_true(test_json(r.out, "error_estimate") <= 1e-4);
}

/* The double pendulum for 60 s: two good methods part before the end, and the verdict says so. */
static void what_is_not_determined_is_not_promised(void **state) {
  (void)state;
  hooke("run " SCENES "double_pendulum.lua --integrator auto --accuracy 1e-3 --json --no-output");
  expect(5, "s two good methods part");
  assert_non_null(strstr(r.out, "\"verdict\":\"inaccurate\""));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_choice_is_kept_where_there_was_no_cache),
      cmocka_unit_test(a_damaged_choice_is_made_anew),
      cmocka_unit_test(the_choice_is_made_anew_when_a_module_changes),
      cmocka_unit_test(a_cloth_is_right_to_the_accuracy_in_the_end),
      cmocka_unit_test(a_rope_that_comes_taut_late_is_foreseen),
      cmocka_unit_test(what_is_not_determined_is_not_promised),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
