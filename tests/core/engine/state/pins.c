/* Options of a pin that stand in the wrong place are refused and not passed over: the particle would be held for good.
 * The velocity of a path is its derivative at any time, whether the script gives it or not. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define HEAD "local scene = hooke.scene { duration = 1, fps = 10 }\nlocal p = scene:particle { mass = 1 }\n"

static void options_among_the_ids_are_refused(void **state) {
  (void)state;
  test_refused(HEAD "scene:pin { p, path = function(t) return t, 0, 0 end }\nreturn scene\n", "", 1,
               "bad.lua:3: pin: 'path' is no particle; options are a second table, scene:pin(ids, { path = ... })");
  test_refused(HEAD "scene:pin { p, release = 0.5 }\nreturn scene\n", "", 1, "pin: 'release' is no particle");
}

static void options_that_are_no_table_are_refused(void **state) {
  (void)state;
  test_refused(HEAD "scene:pin({ p }, function(t) return t, 0, 0 end)\nreturn scene\n", "", 1,
               "bad.lua:3: pin: options are a table, scene:pin(ids, { path = f }), got function");
}

/* The measure `m` at `until` s of a run with a path of that function. */
static double late(const char *until, const char *path, const char *measure) {
  static test_result r;
  char scene[1024], arguments[128];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 2000, fps = 0.01, dt = 100, integrator = 'leapfrog' }\n"
           "local p = scene:particle { mass = 1 }\nscene:pin({ p }, { path = %s })\n"
           "scene:measure('m', function(s) %s end)\nreturn scene\n",
           path, measure);
  test_write("late.lua", scene);
  snprintf(arguments, sizeof arguments, "run late.lua --json --quiet --no-output --until %s", until);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0 && r.code != 5) fail_msg("exit %d: %s", r.code, r.err);
  return test_json(r.out, "m");
}

/* 100 Hz and 0.01 m at 2,000 s, where sin(w t) is rounded by 1e-10: 2 pi m/s up to 1e-8, six digits more than are seen.
 * Differences over 0.012 s would give 0.1 m/s. */
static void the_speed_of_a_late_shaking_is_right(void **state) {
  (void)state;
  double v = late("2000", "function(t) return 0.01 * math.sin(200 * math.pi * t), 0, 0 end", "return s:velocity(p)[1]");
  if (!(fabs(v - 2 * 3.141592653589793) < 1e-7)) fail_msg("%.17g m/s", v);
}

/* The step ends at the jump of 3 m: the speed is that of what comes then, 0.5 m/s. */
static void a_jump_gives_no_speed(void **state) {
  (void)state;
  double v = late("100", "function(t) return t < 100 and t or 3 + 0.5 * t, 0, 0 end", "return s:velocity(p)[1]");
  if (!(fabs(v - 0.5) < 1e-8)) fail_msg("%.17g m/s", v);
}

static bool warns(const char *path) {
  static test_result r;
  char scene[1024];
  snprintf(scene, sizeof scene, HEAD "scene:pin({ p }, { path = %s })\nreturn scene\n", path);
  test_write("given.lua", scene);
  test_hooke(&r, NULL, "run given.lua --no-output");
  if (r.code != 0 && r.code != 5) fail_msg("exit %d: %s", r.code, r.err);
  return strstr(r.err, "given.lua:3: pin: the velocity that the path gives is not the derivative of its positions");
}

static void a_given_velocity_that_is_none_is_said(void **state) {
  (void)state;
  assert_true(warns("function(t) return math.sin(9 * t), 0, 0, math.cos(9 * t), 0, 0 end"));
  assert_true(warns("function(t) return math.sin(9 * t), 0, 0, 0, 9 * math.cos(9 * t), 0 end"));
  assert_true(warns("function(t) return 2 * t, 0, 0, -2, 0, 0 end"));
  assert_true(warns("function(t) return 1, 2, 3, 1e-3, 0, 0 end"));
  assert_false(warns("function(t) return math.sin(9 * t), 0, 0, 9 * math.cos(9 * t), 0, 0 end"));
  assert_false(warns("function(t) return math.sin(9e3 * t), 0, 0, 9e3 * math.cos(9e3 * t), 0, 0 end"));
  assert_false(warns("function(t) return math.abs(t - 0.5), t * t, 0, t < 0.5 and -1 or 1, 2 * t, 0 end"));
  assert_false(warns("function(t) return 0, 0, t < 0.5 and 1 or 2, 0, 0, 0 end"));
  assert_false(warns("function(t) return 0, 0, 0, 0, 0, 0 end"));
}

#define WIND "scene:force('gravity', { g = function(t) return { 0, 0, t } end, fastest = %s })\nreturn scene\n"

static const char *run_with(const char *fastest, const char *arguments) {
  static test_result r;
  char scene[1024], all[256];
  snprintf(scene, sizeof scene, HEAD WIND, fastest);
  test_write("fastest.lua", scene);
  snprintf(all, sizeof all, "run fastest.lua --no-output %s", arguments);
  test_hooke(&r, NULL, all);
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  return r.err;
}

/* Steps of a method that chooses none for itself are compared with it: 0.1 s against 0.05 s. */
static void the_shortest_time_of_functions_is_declared(void **state) {
  (void)state;
  const char *longer = "fastest.lua:3: gravity: the steps, 0.1 s, are longer than `fastest`, 0.05 s";
  assert_non_null(strstr(run_with("0.05", "--integrator leapfrog --dt 0.1"), longer));
  assert_null(strstr(run_with("0.05", "--integrator leapfrog --dt 0.05"), "fastest"));
  assert_null(strstr(run_with("0.05", "--integrator dopri5"), "fastest"));
  test_refused(HEAD "scene:force('gravity', { g = {0, 0, -1}, fastest = 1e-4 })\nreturn scene\n", "", 1,
               "gravity: fastest: no parameter is a function of time");
  test_refused(HEAD "scene:force('gravity', { g = function(t) return {0, 0, t} end, fastest = 0 })\nreturn scene\n", "",
               1, "gravity: fastest: 0 s is no time in which anything changes");
  test_refused(HEAD "scene:pin({ p }, { fastest = 1e-4 })\nreturn scene\n", "", 1,
               "bad.lua:3: pin: fastest: the pin has no path that could change");
  test_refused(HEAD "scene:pin({ p }, { path = function(t) return t, 0, 0 end, fastest = -1 })\nreturn scene\n", "", 1,
               "pin: fastest: -1 s is no time");
}

/* Two particles 2 m apart turn by 1 rad/s about their middle, which rises by 0.5 m/s. */
static void pins_turn_about_their_middle(void **state) {
  static test_result r;
  (void)state;
  test_write("turn.lua",
             "local scene = hooke.scene { duration = 1, fps = 10, dt = 0.1, integrator = 'leapfrog' }\n"
             "local a, b = scene:particle { position = {1, 1, 0} }, scene:particle { position = {3, 1, 0} }\n"
             "scene:pin({ a, b }, { path = function(t) return 0, 0, t / 2 end,\n"
             "  rotation = function(t) return 0, 0, t end })\n"
             "scene:measure('x', function(s) return s:position(b)[1] - 2 - math.cos(s.t) end)\n"
             "scene:measure('z', function(s) return s:position(a)[3] - s.t / 2 end)\n"
             "scene:measure('v', function(s) return s:velocity(a)[2] + math.cos(s.t) end)\nreturn scene\n");
  test_hooke(&r, NULL, "run turn.lua --json --quiet --no-output");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  assert_true(fabs(test_json(r.out, "x")) < 1e-15 * 8 && fabs(test_json(r.out, "z")) < 1e-15);
  assert_true(fabs(test_json(r.out, "v")) < 1e-9);
}

static void turns_that_cannot_be_are_refused(void **state) {
  (void)state;
  test_refused(HEAD "scene:pin({ p }, { rotation = 3 })\nreturn scene\n", "", 1,
               "bad.lua:3: pin: rotation: expected a function of t");
  test_refused(HEAD "scene:pin({ p }, { center = { 1, 0, 0 } })\nreturn scene\n", "", 1,
               "pin: center: the pin has no rotation about it");
  test_refused(HEAD "scene:pin({ p }, { rotation = function(t) return t, 0, 0 end, axes = { 1, 0, 0 } })\n", "", 1,
               "pin: give one of path (or rotation), axes and normal");
  test_refused(HEAD "scene:pin({ p }, { rotation = function(t) return t end })\nreturn scene\n", "", 1,
               "pin: the rotation gave 1 numbers at t = 0 s, expected x, y, z [, vx, vy, vz]");
}

/* A rotation that vibrates at 100 kHz is not seen by steps of 0.1 s, nor by any run that is affordable; and a rate
 * that is none is said. */
static void rotations_are_judged_as_paths_are(void **state) {
  static test_result r;
  (void)state;
  test_write("hum.lua",
             HEAD "local q = scene:particle { position = { 1, 0, 0 } }\n"
                  "scene:force('springs', { edges = { { p, q } }, k = 1 })\nscene:pin({ p }, { center = { 0, 1, 0 },\n"
                  "  rotation = function(t) return 0, 0, math.sin(6.283e5 * t) end })\nreturn scene\n");
  test_hooke(&r, NULL, "run hum.lua --no-output --dt 0.1");
  assert_non_null(strstr(r.out, "pin: rotation does something within"));
  test_write("rate.lua", HEAD "scene:pin({ p }, { center = { 1, 0, 0 },\n"
                              "  rotation = function(t) return 0, 0, t, 0, 0, 2 end })\nreturn scene\n");
  test_hooke(&r, NULL, "run rate.lua --no-output");
  assert_non_null(strstr(r.err, "pin: the velocity that the rotation gives is not the derivative of its positions"));
  assert_non_null(strstr(r.err, "is 2 rad/s and should be 1 rad/s"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(options_among_the_ids_are_refused),
      cmocka_unit_test(options_that_are_no_table_are_refused),
      cmocka_unit_test(the_speed_of_a_late_shaking_is_right),
      cmocka_unit_test(a_jump_gives_no_speed),
      cmocka_unit_test(a_given_velocity_that_is_none_is_said),
      cmocka_unit_test(the_shortest_time_of_functions_is_declared),
      cmocka_unit_test(pins_turn_about_their_middle),
      cmocka_unit_test(turns_that_cannot_be_are_refused),
      cmocka_unit_test(rotations_are_judged_as_paths_are),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
