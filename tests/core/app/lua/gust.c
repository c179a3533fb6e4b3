/* hooke.gust{} in scenes: where a function of time stands, of a number, a vector or a pin's path; the step that it asks
 * for; and what is refused. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define HEAD                                                                                                           \
  "local scene = hooke.scene { duration = 1, fps = 10, integrator = 'rk4' }\nlocal p = scene:particle { mass = 1 }\n"

static void run(test_result *r, const char *lines, const char *options) {
  char scene[2048], command[1200];
  snprintf(scene, sizeof scene, HEAD "%s\nreturn scene\n", lines);
  test_write("gusts.lua", scene);
  snprintf(command, sizeof command, "run %s/gusts.lua --json --no-output %s", test_folder(), options);
  test_hooke(r, NULL, command);
  if (r->code != 0) fail_msg("%s", r->err);
}

/* A step that is chosen takes eight to the shortest period; one that is given is warned of where it is above half of
 * it. */
static void the_step_resolves_a_gust(void **state) {
  (void)state;
  static test_result r;
  run(&r, "scene:force('gravity', { g = hooke.gust { mean = { 0, 0, -9 }, amplitude = 1, shortest = 0.16 } })", "");
  assert_true(fabs(test_json(r.out, "dt_max") - 0.02) < 1e-12);
  run(&r, "scene:force('gravity', { g = hooke.gust { amplitude = { 1, 0, 0 }, shortest = 0.16 } })", "--dt 0.1");
  assert_true(strstr(r.err, "longer than `fastest`, 0.08 s") || strstr(r.out, "longer than `fastest`, 0.08 s"));
  run(&r,
      "local x = hooke.gust { amplitude = { 1, 0, 0 }, shortest = 0.08 }\n"
      "scene:pin({ p }, { path = x })",
      "");
  assert_true(fabs(test_json(r.out, "dt_max") - 0.01) < 1e-12);
}

/* Called by the script itself it gives the same numbers; a function around it does as well, but says nothing of how
 * fast it changes. */
static void a_gust_is_a_function_of_the_script_as_well(void **state) {
  (void)state;
  static test_result r;
  double first = NAN;
  for (int around = 0; around < 2; around++) {
    char lines[512];
    snprintf(lines, sizeof lines,
             "local g = hooke.gust { mean = 3, amplitude = 1, shortest = 1, longest = 2, seed = 5 }\n"
             "scene:force('central', { strength = %s, center = { 1, 0, 0 } })\n"
             "scene:measure('x', function(s) return s:position(p)[1] end)",
             around ? "function(t) return g(t) end" : "g");
    run(&r, lines, "--dt 0.01");
    if (around == 0) first = test_json(r.out, "x");
    assert_true(first > 0.5 && test_json(r.out, "x") == first);
  }
}

static void nonsense_is_refused(void **state) {
  (void)state;
  static const char *const wrong[][2] = {
      {"{ amplitude = 1 }", "gust: shortest: the shortest period, in s, has to be given, and above 0"},
      {"{ amplitude = 1, shortest = -1 }", "gust: shortest: the shortest period, in s, has to be given, and above 0"},
      {"{ amplitude = 1, shortest = 2, longest = 1 }", "gust: longest: 1 s is below the shortest period, 2 s"},
      {"{ amplitude = -1, shortest = 2 }", "gust: amplitude: -1 is below the minimum 0"},
      {"{ amplitude = { 1, 2 }, shortest = 2 }", "amplitude"},
      {"{ mean = 3, amplitude = { 1, 2, 3 }, shortest = 2 }", "gust: mean: a number, where the amplitude is a vector"},
      {"{ amplitude = 1, shortest = 2, speed = 3 }", "speed"},
      {"{ amplitude = 'x', shortest = 2 }", "amplitude"},
      {"{ amplitude = 1, shortest = 2, seed = 0.5 }", "seed"},
  };
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    char scene[1024];
    snprintf(scene, sizeof scene, HEAD "local g = hooke.gust %s\nreturn scene\n", wrong[k][0]);
    test_refused(scene, "--quiet", 1, wrong[k][1]);
    test_refused(scene, "--quiet", 1, "bad.lua:3:");
  }
  test_refused(HEAD
               "scene:force('gravity', { g = hooke.gust { mean = 1, amplitude = 1, shortest = 1 } })\nreturn scene\n",
               "--quiet", 1, "the function gave 1 numbers at t = 0 s, expected 3");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_step_resolves_a_gust),
      cmocka_unit_test(a_gust_is_a_function_of_the_script_as_well),
      cmocka_unit_test(nonsense_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
