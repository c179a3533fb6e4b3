/* --integrator auto: it chooses what reaches the accuracy, says why, keeps the choice on file for just this scene,
 * these parameters and this accuracy, and says so where no method can. */
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

static void the_choice_reaches_the_accuracy_and_says_why(void **state) {
  (void)state;
  hooke("run " SCENES "circle.lua --integrator auto --accuracy 1e-4 --json --no-output");
  expect(0, "measured");
  assert_non_null(strstr(r.err, "m at ")); /* the error and its price */
  assert_non_null(strstr(r.err, "the next is"));
  assert_true(test_json(r.out, "exact_error") <= 1e-4 && test_json(r.out, "verify_difference") <= 0.5e-4);
}

static void the_choice_is_kept_for_scene_parameters_and_accuracy(void **state) {
  (void)state;
  static const char line[] = "auto " SCENES "sine.lua k=5 --accuracy 1e-3 --budget 0.2";
  hooke(line);
  expect(0, "kept in cache/hooke/auto-");
  hooke(line);
  expect(0, "chosen before, from cache/hooke/auto-");
  hooke("auto " SCENES "sine.lua k=6 --accuracy 1e-3 --budget 0.2");
  expect(0, "measured in");
  hooke("auto " SCENES "sine.lua k=5 --accuracy 1e-5 --budget 0.2");
  expect(0, "measured in");
  hooke("auto " SCENES "sine.lua k=5 --accuracy 1e-3 --budget 0.2 --again");
  expect(0, "measured in");
  hooke("auto " SCENES "sine.lua k=5 --accuracy 1e-3 --budget 0.2 --quiet");
  assert_true(r.code == 0 && !*r.err && !*r.out);
}

static void a_scene_asks_for_it_itself(void **state) {
  (void)state;
  test_write("mine.lua", "local scene = hooke.scene { duration = 1, fps = 30, integrator = 'auto', accuracy = 1e-5 }\n"
                         "scene:particle { position = { 1, 0, 0 }, mass = 1 }\n"
                         "scene:force('central', { strength = 30 })\n"
                         "scene:exact(function(t) return math.cos(math.sqrt(30) * t), 0, 0 end)\nreturn scene\n");
  hooke("run mine.lua --json --no-output");
  expect(0, "measured");
  assert_true(test_json(r.out, "exact_error") <= 1e-5);
  hooke("run " SCENES "circle.lua --integrator auto --no-output");
  expect(1, "needs to know the accuracy");
  hooke("auto " SCENES "circle.lua");
  expect(1, "--accuracy METRES is needed");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_choice_reaches_the_accuracy_and_says_why),
      cmocka_unit_test(the_choice_is_kept_for_scene_parameters_and_accuracy),
      cmocka_unit_test(a_scene_asks_for_it_itself),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
