/* What is said before a run: options without an effect, times before the start, how long it
 * will take, and what would take less. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* k = 1e12 N/m and 1 kg: w^2 = 2 k/m, and leapfrog's steps are up to 2/w. */
static const char stiff[] = "local k = param('k', 1e12)\n"
                            "local scene = hooke.scene { duration = param('T', 60), fps = 10 }\n"
                            "local a = scene:particle { position = {0, 0, 0}, mass = 1 }\n"
                            "local b = scene:particle { position = {1, 0, 0}, mass = 1 }\n"
                            "scene:force('gravity')\n"
                            "scene:force('springs', { edges = {{a, b}}, k = k, label = 'rod' })\n"
                            "return scene\n";

static test_result r;

static void says(const char *text) {
  if (!strstr(r.err, text)) fail_msg("no '%s' in: %s", text, r.err);
}

static void a_stiff_scene_is_told_of_implicit_methods(void **state) {
  (void)state;
  test_write("stiff.lua", stiff);
  test_hooke(&r, "timeout --preserve-status -s INT 3 ", "run stiff.lua T=6000");
  assert_int_equal(r.code, 130);
  says("steps of 1.3e-06 s are to come, which take about "); /* 0.9 of 1.41e-6 s */
  says("the fastest swings, of 4.4e-06 s, are those of 'rod'");
  says("hooke: --integrator bdf2 would take about ");
  test_hooke(&r, "timeout --preserve-status -s INT 3 ", "run stiff.lua T=6000 --quiet");
  if (r.code != 130 || strstr(r.err, "take about")) fail_msg("%s", r.err);
}

static void a_short_run_says_nothing(void **state) {
  (void)state;
  test_write("stiff.lua", stiff);
  test_hooke(&r, NULL, "run stiff.lua k=1e3");
  assert_int_equal(r.code, 0);
  if (*r.err) fail_msg("it said: %s", r.err);
  test_hooke(&r, NULL, "run stiff.lua --integrator bdf2");
  if (strstr(r.err, "take about")) fail_msg("it said: %s", r.err);
}

static void a_tolerance_without_effect_is_said(void **state) {
  (void)state;
  test_write("stiff.lua", stiff);
  test_hooke(&r, NULL, "run stiff.lua k=1e3 --tol 1e-3");
  assert_int_equal(r.code, 0);
  says("warning: --tol 0.001 has no effect: leapfrog takes steps of a given length; give --dt, or choose a method that "
       "chooses its steps, such as --integrator dopri5");
  test_hooke(&r, NULL, "run stiff.lua k=1e3 --tol 1e-3 --integrator dopri5");
  if (*r.err) fail_msg("it said: %s", r.err);
}

static void a_folder_that_stays_empty_is_said(void **state) {
  (void)state;
  test_write("stiff.lua", stiff);
  test_hooke(&r, NULL, "run stiff.lua k=1e3 --out pictures");
  assert_int_equal(r.code, 0);
  says("warning: --out pictures: nothing will be written there, since the scene has no output and no measure");
  assert_false(test_exists("pictures"));
  test_hooke(&r, NULL, "run stiff.lua k=1e3 --out pictures --no-output");
  says("warning: --out pictures has no effect: --no-output turns outputs and measures.csv off");
  test_hooke(&r, NULL, "run stiff.lua k=1e3 --out pictures --with output:table");
  if (*r.err) fail_msg("it said: %s", r.err);
  assert_true(test_exists("pictures"));
}

static void a_step_that_moves_no_time_is_refused(void **state) {
  (void)state;
  test_write("stiff.lua", stiff);
  test_hooke(&r, NULL, "run stiff.lua k=1e3 --dt 1e-20");
  assert_int_equal(r.code, 1);
  says("dt allows steps of 1e-20 s at most, too short to move t = 0 s; above 1e-15 s they are not"); /* 64 eps 0.1 s */
}

static void a_release_before_the_start_is_refused(void **state) {
  (void)state;
  test_refused("local scene = hooke.scene {}\nlocal p = scene:particle { position = {0,0,0}, mass = 1 }\n"
               "scene:pin({ p }, { release = -1 })\nreturn scene\n",
               "", 1, "bad.lua:3: pin: release: -1 s is no time of the run: give one from 0 on, or leave it out");
}

/* Where the run would end, and without any of its frames. An `exact` that knows nothing at other times is right. */
static void an_exact_solution_that_is_none_is_refused(void **state) {
  (void)state;
  static const char *const bad[][2] = {
      {"return 1", "exact gave 1 numbers at t = 2 s, which are not x, y, z of whole"},
      {"return 1, 2, 3, 4, 5, 6", "returned more numbers than are expected at t = 2 s"},
      {"return 1, 0 / 0, 3", "this function returned nan at t = 2 s"},
      {"return 1, 'a', 3", "a text where a number is needed at t = 2 s"},
      {"return t.x", "attempt to index a number"}};
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    char scene[512];
    snprintf(scene, sizeof scene,
             "local scene = hooke.scene { duration = 2, fps = 10 }\nscene:particle { position = {0,0,0}, mass = 1 }\n"
             "scene:on_frame(function() print('a frame') end)\n"
             "scene:exact(function(t) if t == 2 then %s end end)\nreturn scene\n",
             bad[k][0]);
    test_refused(scene, "", 1, bad[k][1]);
    test_hooke(&r, NULL, "run bad.lua --quiet");
    if (strstr(r.out, "a frame") || strstr(r.err, "a frame")) fail_msg("%s: it is said after the run", bad[k][0]);
  }
  test_write("known.lua", "local scene = hooke.scene { duration = 2, fps = 10 }\n"
                          "scene:particle { position = {0,0,0}, velocity = {1,0,0}, mass = 1 }\n"
                          "scene:exact(function(t) if t == 2 then return 2, 0, 0 end end)\nreturn scene\n");
  test_hooke(&r, NULL, "run known.lua --quiet");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_stiff_scene_is_told_of_implicit_methods),
      cmocka_unit_test(a_short_run_says_nothing),
      cmocka_unit_test(a_tolerance_without_effect_is_said),
      cmocka_unit_test(a_folder_that_stays_empty_is_said),
      cmocka_unit_test(a_step_that_moves_no_time_is_refused),
      cmocka_unit_test(an_exact_solution_that_is_none_is_refused),
      cmocka_unit_test(a_release_before_the_start_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
