/* A function of the script that gives NaN or an infinite number is named with its file, its line, the number and the
 * time, wherever it stands; the run ends with code 1. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define HEAD                                                                                                           \
  "local scene = hooke.scene { duration = 1, fps = 10, dt = 0.05 }\n"                                                  \
  "local p = scene:particle { mass = 1 }\nlocal q = scene:particle { position = {1, 0, 0}, mass = 1 }\n"
#define FIXTURE(name) "'" HK_BUILD "/tests/fixtures/" name ".so'"

/* The function is on line 5 of the script, and gives its number from 0.5 s on. */
static void expect(const char *line, const char *number) {
  char scene[2048], text[128];
  snprintf(scene, sizeof scene, HEAD "scene:force('gravity')\n%s\nreturn scene\n", line);
  snprintf(text, sizeof text, "bad.lua:5: this function returned %s at t = 0.5", number);
  test_refused(scene, "--trust --quiet --no-output", 1, text);
}

static void a_parameter_of_time(void **state) {
  (void)state;
  expect("scene:force('gravity', { g = function(t) return 0, 0, t < 0.5 and -9.81 or 0/0 end })", "nan");
  expect("scene:corrector(" FIXTURE("floor") ", { height = function(t) return t < 0.5 and -99 or -1/0 end })", "-inf");
  expect("scene:integrator(" FIXTURE("liar") ", { drift = function(t) return t < 0.5 and 0 or 1/0 end })", "inf");
}

static void a_channels_rate(void **state) {
  (void)state;
  expect("scene:channel('heat', { rate = function(t, id, y) return t < 0.5 and 1 or 1/0 end })", "inf");
}

static void a_pins_path(void **state) {
  (void)state;
  expect("scene:pin({ p }, { path = function(t) return 0, t < 0.5 and t or 1/0, 0 end })", "inf");
  expect("scene:pin({ p }, { path = function(t) return 0, t, 0, 0, t < 0.5 and 1 or -1/0, 0 end })", "-inf");
}

static void a_measure(void **state) {
  (void)state;
  expect("scene:measure('m', function(s) return s.t < 0.5 and 1 or 1/0 end)", "inf");
}

/* What on_frame returns nobody looks at; what it computes with numbers that are none is its own. An error in it ends
 * the run. */
static void an_error_in_on_frame(void **state) {
  (void)state;
  test_refused(HEAD "scene:on_frame(function(s)\nif s.t > 0.45 then error('lost') end end)\nreturn scene\n", "--quiet",
               1, "bad.lua:5: lost");
}

static void the_exact_solution(void **state) {
  (void)state;
  char scene[2048];
  snprintf(scene, sizeof scene, HEAD "scene:exact(function(t) return t < 0.5 and 0 or 0/0, 0, 0 end)\nreturn scene\n");
  test_refused(scene, "--quiet --no-output", 1, "bad.lua:4: this function returned nan at t = 1 s");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_parameter_of_time),  cmocka_unit_test(a_channels_rate),
      cmocka_unit_test(a_pins_path),          cmocka_unit_test(a_measure),
      cmocka_unit_test(an_error_in_on_frame), cmocka_unit_test(the_exact_solution),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
