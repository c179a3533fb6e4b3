/* The words behind `ok` say no more than what was measured: "stable" is a run whose steps are all within the limit. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* A slow oscillator, and a stiff spring at rest (w = 1000 1/s: leapfrog is stable up to 2 ms). */
static const char scene[] = "local scene = hooke.scene { duration = 0.02, fps = 400 }\n"
                            "local a = scene:particle { position = { 1, 0, 0 }, mass = 1, group = 'slow' }\n"
                            "local b = scene:particle { position = { 0, 1, 0 }, mass = 2 }\n"
                            "local c = scene:particle { position = { 0, 2, 0 }, mass = 2 }\n"
                            "scene:force('central', { strength = 1e4, power = 1, group = 'slow' })\n"
                            "scene:force('springs', { edges = { { b, c } }, k = 1e6 })\n"
                            "return scene\n";

static void expect(const char *options, const char *text, const char *other) {
  static test_result r;
  char arguments[256];
  test_write("two.lua", scene);
  snprintf(arguments, sizeof arguments, "run two.lua --no-output %s", options);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0 || !strstr(r.out, text)) fail_msg("%s: no '%s' in: %s%s", options, text, r.out, r.err);
  if (other && strstr(r.out, other)) fail_msg("%s: '%s' in: %s", options, other, r.out);
}

static void stable_is_a_run_within_the_limit(void **state) {
  (void)state;
  expect("--dt 1e-4", "ok: stable, ", NULL);
}

/* 2.5 ms multiply an error of the spring by 4 a step: of one rounding, 1e-16 m, 4^8 are 7e-12 m. The slow one is off by
 * (h w)^2/24 of its phase, 2 rad: less than a tenth of its way. */
static void a_step_above_it_is_not(void **state) {
  (void)state;
  expect("--dt 2.5e-3", "with steps above the stable limit, which the positions do not show", "ok: stable");
}

static void nor_is_a_method_without_a_stable_step(void **state) {
  (void)state;
  expect("--integrator midpoint --dt 1e-5", "ok: not stable at any step", "ok: stable");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(stable_is_a_run_within_the_limit),
      cmocka_unit_test(a_step_above_it_is_not),
      cmocka_unit_test(nor_is_a_method_without_a_stable_step),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
