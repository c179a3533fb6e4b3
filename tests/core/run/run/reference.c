/* What core/run/run/reference.c promises: a reference is better than the run or there is none, it costs a part of the
 * run, and its distance is the run's error; motion that comes back at every frame is motion. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static void ended(const char *arguments, int code) {
  if (r.code != code) fail_msg("%s: exit %d instead of %d: %s%s", arguments, r.code, code, r.err, r.out);
}

static void start(const char *scene, const char *arguments) {
  char all[512];
  test_write("scene.lua", scene);
  snprintf(all, sizeof all, "run scene.lua --json --quiet --no-output %s", arguments);
  test_hooke(&r, NULL, all);
}

static void run(const char *scene, const char *arguments, int code) {
  start(scene, arguments);
  ended(arguments, code);
}

/* Three bodies that pass each other closely (Burrau 1913), until t = 70 s, when one has left: errors have grown by
 * 1e13.
 */
static const char pythagorean[] =
    "local scene = hooke.scene { duration = 70, fps = 1 / 70, integrator = 'dopri5' }\n"
    "for i, at in ipairs { { 1, 3, 0 }, { -2, -1, 0 }, { 1, -1, 0 } } do\n"
    "  scene:particle { position = at, mass = i + 2 }\n"
    "end\n"
    "scene:force('nbody', { G = 1 })\n"
    "for i = 1, 3 do for c = 1, 2 do scene:measure('x' .. i .. c, function(s) return s:position(i)[c] end) end end\n"
    "return scene\n";

/* By Taylor's method of order 30 with 39 digits, whose energy is off by 1.4e-30. */
static const double there[3][2] = {{6.933463599011887, 20.261804305951714},
                                   {-2.0030060026059841, -6.8724634358245448},
                                   {-2.5576733573223451, -6.6591118349113926}};

static double true_error(void) {
  double sum = 0;
  for (int i = 0; i < 3; i++)
    for (int c = 0; c < 2; c++) {
      char name[32];
      snprintf(name, sizeof name, "x%d%d", i + 1, c + 1);
      double off = test_json(r.out, name) - there[i][c];
      sum += off * off;
    }
  return sqrt(sum / 3);
}

/* m, RMS: how far the bodies have got. */
static const double way = 11.7;

/* dopri5 is off by some 40 and 1 m, as rounding has it, and inaccurate beyond a tenth of the way; a reference at a
 * tolerance of 3e-10 was off by 5 m itself. What rounding does to the reference is some 0.1 m. */
static void the_estimate_of_chaotic_motion_is_the_error(void **state) {
  (void)state;
  const char *const tolerances[] = {"--tol 1e-9", "--tol 1e-10", "--tol 1e-12"};
  for (size_t k = 0; k < 3; k++) {
    start(pythagorean, tolerances[k]);
    double error = true_error(), said = test_json(r.out, "error_estimate");
    print_message("%s: off by %.3g m, said %.3g m\n", tolerances[k], error, said);
    ended(tolerances[k], error > way / 10 ? 5 : 0);
    if (!(fabs(said - error) < 0.3)) fail_msg("%s: off by %g m, and said is %g m", tolerances[k], error, said);
  }
}

/* A circle of radius 1 m by a method with an error of 1e-12: the estimate says so, not what the reference is off by. */
static void an_accurate_run_is_seen_to_be_accurate(void **state) {
  (void)state;
  const char circle[] = "local scene = hooke.scene { duration = 20, fps = 1 / 20, integrator = 'dopri5' }\n"
                        "scene:particle { position = {1, 0, 0}, velocity = {0, 1, 0}, mass = 1 }\n"
                        "scene:force('central', { strength = 1 })\n"
                        "scene:exact(function(t) return math.cos(t), math.sin(t), 0 end)\nreturn scene\n";
  const char *const tolerances[] = {"--tol 1e-7", "--tol 1e-10", "--tol 1e-13"};
  for (size_t k = 0; k < 3; k++) {
    run(circle, tolerances[k], 0);
    double error = test_json(r.out, "exact_error"), said = test_json(r.out, "error_estimate");
    print_message("%s: off by %.3g m, said %.3g m\n", tolerances[k], error, said);
    if (!(fabs(said - error) < 0.2 * error)) fail_msg("%s: off by %g m, said %g m", tolerances[k], error, said);
  }
}

/* Of a run at the smallest tolerance of the best method there is no better one: it is compared with half its step. */
static void there_is_none_for_the_best_run(void **state) {
  (void)state;
  const char circle[] =
      "local scene = hooke.scene { duration = 20, fps = 1, integrator = 'gauss_radau', tol = 1e-18 }\n"
      "scene:particle { position = {1, 0, 0}, velocity = {0, 1, 0}, mass = 1 }\n"
      "scene:force('central', { strength = 1 })\nreturn scene\n";
  run(circle, "", 0);
  assert_true(isnan(test_json(r.out, "error_estimate")));
  assert_non_null(strstr(r.out, "accuracy not asked for"));
  run(circle, "--accuracy 1e-9", 0);
  assert_non_null(strstr(r.out, "compared with half the step"));
}

/* After ten turns it is where it was, with frames at whole turns only. */
static void what_is_back_at_every_frame_has_moved(void **state) {
  (void)state;
  const char turns[] = "local turn = 2 * math.pi\n"
                       "local scene = hooke.scene { duration = 10 * turn, fps = 1 / turn, integrator = 'dopri5' }\n"
                       "scene:particle { position = {1, 0, 0}, velocity = {0, 1, 0}, mass = 1 }\n"
                       "scene:force('central', { strength = 1 })\n%sreturn scene\n";
  char scene[1024];
  snprintf(scene, sizeof scene, turns, "");
  run(scene, "--tol 1e-8", 0);
  assert_true(test_json(r.out, "error_estimate") < 1e-5);
  snprintf(scene, sizeof scene, turns, "scene:exact(function(t) return math.cos(t), math.sin(t), 0 end)\n");
  run(scene, "--tol 1e-8 --until 402.1238596594935", 0); /* 64 turns */
}

/* 16 steps in a swing and a frame after each, of methods whose tiles and looks between frames are of 32 steps. */
static void what_is_back_after_a_few_steps_has_moved(void **state) {
  (void)state;
  static const char swing[] = "local P = 2 * math.pi\n"
                              "local scene = hooke.scene { duration = 100 * P, fps = 1 / P, dt = P / 16 }\n"
                              "scene:particle { position = { 1, 0, 0 }, velocity = { 0, 1, 0 }, mass = 1 }\n"
                              "scene:force('central', { strength = 1 })\n"
                              "scene:exact(function(t) return math.cos(t), math.sin(t), 0 end)\nreturn scene\n";
  static const char *const methods[] = {"kahan_li8", "blanes_moan", "stoermer8"};
  for (size_t k = 0; k < 3; k++) {
    char arguments[64];
    snprintf(arguments, sizeof arguments, "--integrator %s", methods[k]);
    run(swing, arguments, 0);
    assert_null(strstr(r.out, "more than a tenth of the motion"));
    assert_true(test_json(r.out, "exact_error") < 0.02);
  }
}

/* Frames end the steps of dopri5, and a smaller tolerance changes none: run and reference would be the same. */
static void a_reference_does_not_repeat_the_steps_of_the_run(void **state) {
  (void)state;
  static const char slow[] = "local scene = hooke.scene { duration = 2, fps = 60, integrator = 'dopri5' }\n"
                             "scene:particle { position = { 1, 0, 0 }, mass = 1 }\n"
                             "scene:force('central', { strength = 4 })\n"
                             "scene:exact(function(t) return math.cos(2 * t), 0, 0 end)\nreturn scene\n";
  static const char *const accuracies[] = {"", "--accuracy 1e-3"};
  for (size_t k = 0; k < 2; k++) {
    run(slow, accuracies[k], 0);
    double error = test_json(r.out, "exact_error"), said = test_json(r.out, "error_estimate");
    if (!(said > 0.8 * error && said < 2 * error)) fail_msg("off by %g m, said %g m", error, said);
  }
}

/* A planet of an eccentricity of 0.9 for 60 turns: errors of 1e-6 in a step are decimetres in the end, so that the
 * first reference is worse than the run, which the second, at a smaller tolerance, confirms. */
static void a_reference_that_is_worse_than_the_run_is_replaced(void **state) {
  (void)state;
  static const char planet[] =
      "local P = 2 * math.pi\n"
      "local scene = hooke.scene { duration = 60 * P, fps = 1 / P, integrator = 'rk4', dt = P / 3000 }\n"
      "scene:particle { position = { 0, 0, 0 }, mass = 1 }\n"
      "scene:particle { position = { 0.1, 0, 0 }, velocity = { 0, math.sqrt(19), 0 }, mass = 1e-12 }\n"
      "scene:force('nbody', { G = 1 })\nreturn scene\n";
  run(planet, "", 0);
  print_message("said %.3g m\n", test_json(r.out, "error_estimate"));
  assert_true(test_json(r.out, "error_estimate") < 0.2);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_estimate_of_chaotic_motion_is_the_error),
      cmocka_unit_test(an_accurate_run_is_seen_to_be_accurate),
      cmocka_unit_test(there_is_none_for_the_best_run),
      cmocka_unit_test(what_is_back_at_every_frame_has_moved),
      cmocka_unit_test(what_is_back_after_a_few_steps_has_moved),
      cmocka_unit_test(a_reference_does_not_repeat_the_steps_of_the_run),
      cmocka_unit_test(a_reference_that_is_worse_than_the_run_is_replaced),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
