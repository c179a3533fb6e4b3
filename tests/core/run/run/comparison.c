/* The runs that a run is compared with: what nobody asked for costs a share of the run, counted in evaluations, and all
 * of them end steps where a function of time jumps. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static test_result r;

/* Whether an independent method has estimated the error. */
static bool estimated(const char *scene, const char *options) {
  char arguments[512];
  snprintf(arguments, sizeof arguments, "run %s --json --no-output --quiet %s", scene, options);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0) fail_msg("exit %d: %s%s", r.code, r.out, r.err);
  return strstr(r.out, "\"error_estimate\":") && !strstr(r.out, "\"error_estimate\":null");
}

static const char swing[] = "local scene = hooke.scene { duration = 2, fps = 60, dt = 1e-3 }\n"
                            "scene:particle { position = { 1, 0, 0 }, mass = 1 }\n"
                            "scene:force('central', { strength = 30 })\nreturn scene\n";

static void a_small_scene_is_compared_unless_that_is_switched_off(void **state) {
  (void)state;
  test_write("swing.lua", swing);
  assert_true(estimated("swing.lua", ""));
  assert_false(estimated("swing.lua", "--no-check"));
  assert_true(estimated("swing.lua", "--no-check --accuracy 1e-2")); /* that was asked for */
}

/* Implicit steps of hair, whose factors cost some ten evaluations by a solver for matrices of that kind. Counted as
 * those of a cloth they would be worth an explicit reference of thirty times the run's time. */
static void a_reference_dearer_than_the_run_is_not_taken(void **state) {
  (void)state;
  assert_false(estimated(HK_ROOT "/scripts/scenes/hair.lua", "--until 0.3"));
}

/* 1/w m/s2 for w = 34.77 ms from 0.2992 s: four midpoints of steps of 1/120 s are in it and ten of half the step, both
 * 33.3 ms of it, so that the two agree to rounding and are off by 0.028 m. The runs that it is compared with end steps
 * where the function jumps. */
static void a_jump_that_two_runs_miss_alike_is_seen(void **state) {
  (void)state;
  test_write("pulse.lua", "local w, at = 0.03477486283303936, 0.29921304706152846\n"
                          "local scene = hooke.scene { duration = 1, fps = 60, dt = 1 / 120,\n"
                          "  integrator = 'implicit_midpoint' }\n"
                          "scene:particle { mass = 1 }\n"
                          "scene:force('gravity', { g = function(t)\n"
                          "  return t >= at and t <= at + w and 1 / w or 0, 0, 0 end })\nreturn scene\n");
  test_hooke(&r, NULL, "run pulse.lua --accuracy 1e-3 --json --no-output --quiet");
  assert_int_equal(r.code, 5);
  double error = test_json(r.out, "error_estimate");
  assert_true(error > 0.028 && error < 0.06); /* the error, and twice that */
}

/* A pulse's end is a cut of the run, and so is the place where it was found, 1e-12 s before: a step between them says
 * nothing of those that follow, which would be 1e11 times as many as needed. */
static void a_step_between_two_near_cuts_does_not_stay(void **state) {
  static const char *const methods[] = {"cvode", "cvode:method=adams", "arkode"};
  (void)state;
  if (access(HK_BUILD "/plugins/integrators/cvode.so", R_OK) != 0) skip();
  test_write("late.lua", "local scene = hooke.scene { duration = 2, fps = 50, accuracy = 1e-4 }\n"
                         "scene:particle { position = { 0, 0, 0 }, mass = 1 }\n"
                         "scene:particle { position = { 0, 0, -1 }, mass = 0.5 }\n"
                         "scene:pin { 1 }\n"
                         "scene:force('springs', { edges = { { 1, 2 } }, k = 200, rest = 1 })\n"
                         "scene:force('gravity', { g = function(t)\n"
                         "  return { t > 1.6 and t < 1.63 and 200 or 0, 0, -9.81 } end })\nreturn scene\n");
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    char command[256];
    snprintf(command, sizeof command, "run late.lua --integrator %s --tol 1e-8 --json --no-output", methods[k]);
    test_hooke(&r, NULL, command);
    print_message("%s: estimate %g m\n", methods[k], test_json(r.out, "error_estimate"));
    assert_int_equal(r.code, 0);
    assert_true(test_json(r.out, "error_estimate") < 1e-4);
    assert_null(strstr(r.err, "will take about")); /* a second trial that came to the end forecasts no hours */
  }
}

/* A mass slides on a plane against Coulomb's friction and a spring: each half swing is one of cosine about mu g/k, and
 * 2 mu g/k shorter than the last. The error grows faster in the rest of the run than in its first eighth. */
static void the_order_of_the_beginning_is_not_that_of_impacts(void **state) {
  (void)state;
  static const double steps[] = {0.01, 0.002};
  static const char *const methods[] = {"backward_euler", "symplectic_euler"};
  test_write("friction.lua", "local k, mu, g, A = 40, 0.05, 9.81, 0.5\n"
                             "local w, d = math.sqrt(k), mu * g / k\n"
                             "local scene = hooke.scene { duration = 3, fps = 30 }\n"
                             "scene:particle { position = { A, 0, 0 }, mass = 1 }\n"
                             "scene:force('gravity', { g = { 0, 0, -g } })\n"
                             "scene:force('central', { axis = { 0, 0, 1 }, strength = k, power = 1 })\n"
                             "scene:corrector('obstacle', { friction = mu })\n"
                             "scene:exact(function(t)\n"
                             "  local n = math.floor(t * w / math.pi)\n"
                             "  local a = A - 2 * d * n\n"
                             "  return (n % 2 == 0 and 1 or -1) * ((a - d) * math.cos(w * t - n * math.pi) + d), 0, 0\n"
                             "end)\nreturn scene\n");
  for (size_t k = 0; k < 4; k++) {
    char arguments[256];
    double accuracy = 1e-9;
    for (int again = 0; again < 2; again++) {
      snprintf(arguments, sizeof arguments,
               "run friction.lua --json --no-output --quiet --integrator %s --dt %g --accuracy %.9g", methods[k % 2],
               steps[k / 2], accuracy);
      test_hooke(&r, NULL, arguments);
      accuracy = 1.6 * test_json(r.out, "verify_difference");
    }
    double said = test_json(r.out, "error_estimate"), error = test_json(r.out, "exact_error");
    if (!(said >= error && said < 2 * error)) fail_msg("%s: off by %g m, said %g m", arguments, error, said);
  }
}

/* A chain of EA = 10 N sinks and comes to rest before the first frame; steps of 0.2 s sum too much work of its drag,
 * of 8/s, which the positions do not show. */
static void work_of_damping_that_is_overcounted_is_no_fault(void **state) {
  (void)state;
  test_write("chain.lua", "local n, span, length, g = 64, 1, 1.2, 9.81\n"
                          "local l, depth = length / n, math.sqrt(length ^ 2 - span ^ 2) / 2\n"
                          "local scene = hooke.scene { duration = 20, fps = 1, integrator = 'bdf2' }\n"
                          "local ids, edges = {}, {}\n"
                          "for k = 0, n do\n"
                          "  local s = 2 * k / n\n"
                          "  ids[k] = scene:particle { position = { s / 2, 0, -depth * math.min(s, 2 - s) },\n"
                          "    mass = l / g }\n"
                          "  if k > 0 then edges[k] = { ids[k - 1], ids[k] } end\n"
                          "end\n"
                          "scene:pin { ids[0], ids[n] }\n"
                          "scene:force('gravity', { g = { 0, 0, -g } })\n"
                          "scene:force('drag', { rate = 8 })\n"
                          "scene:force('springs', { edges = edges, k = 10 / l, rest = l })\nreturn scene\n");
  assert_true(estimated("chain.lua", "--dt 0.2"));
}

/* Kepler's circle for 1,000 turns at steps of a hundredth: a method of order 2 lags by turns, a reference of the whole
 * is dearer than the run, and one of the first part tells. Of a method of order 8 it tells nothing. */
static void a_phase_that_is_lost_over_many_turns_is_seen(void **state) {
  (void)state;
  test_write("turns.lua", "local turns = param('turns', 1000, 'around the star')\n"
                          "local frames = param('frames', 24, 'of the run')\n"
                          "local scene = hooke.scene { duration = turns, fps = frames / turns, dt = 0.01 }\n"
                          "local w = 2 * math.pi\n"
                          "scene:particle { position = { 1, 0, 0 }, velocity = { 0, w, 0 }, mass = 1 }\n"
                          "scene:force('central', { strength = w * w, power = -2 })\nreturn scene\n");
  test_hooke(&r, NULL, "run turns.lua --integrator leapfrog --json --no-output --quiet");
  assert_int_equal(r.code, 5);
  assert_true(test_json(r.out, "error_estimate") > 0.5); /* 1000 2 pi (2 pi/100)^2/24 = 1.03 rad */
  test_hooke(&r, NULL, "run turns.lua turns=2000 frames=8 --integrator leapfrog --json --no-output --quiet");
  assert_int_equal(r.code, 5); /* the first frame is too late for a reference up to it */
  test_hooke(&r, NULL, "run turns.lua turns=200 --integrator stoermer8 --json --no-output --quiet");
  assert_int_equal(r.code, 0);
}

/* Steps of a third of a turn by a method of order 15: between the ends of a step the star seems to be passed closely,
 * and a reference of 380 turns, which nobody asked for, shows that it is not. */
static void what_a_runs_own_figures_say_may_be_refuted(void **state) {
  (void)state;
  test_write("circle.lua", "local scene = hooke.scene { duration = 571.4, fps = 0.01925, tol = 4.66e-7 }\n"
                           "scene:particle { position = { 1, 0, 0 }, velocity = { 0, 4.205, 0 }, mass = 1 }\n"
                           "scene:force('central', { strength = 4.205 ^ 2, power = -2 })\nreturn scene\n");
  test_hooke(&r, NULL, "run circle.lua --integrator gauss_radau --json --no-output --quiet");
  if (r.code != 0) fail_msg("exit %d: %s%s", r.code, r.out, r.err);
}

/* The same circle for 300 turns by a method that is right to 1e-10 m: a reference that is strict enough for all but so
 * many turns is off by more than what is asked for, one with the run's own steps is dearer than the run, and a stricter
 * one that chooses its steps decides. */
static void a_reference_whose_errors_grew_is_overruled(void **state) {
  (void)state;
  test_write("exact.lua", "local w, x, y = 5.601938567545862, 0.8, 0.6\n"
                          "local scene = hooke.scene { duration = 297.07, fps = 0.0572, dt = 0.00066665 }\n"
                          "scene:particle { position = { x, y, 0 }, velocity = { -w * y, w * x, 0 }, mass = 1 }\n"
                          "scene:force('central', { strength = w * w, power = -2 })\nreturn scene\n");
  test_hooke(&r, NULL, "run exact.lua --integrator stoermer8 --accuracy 0.01 --json --no-output --quiet");
  if (r.code != 0) fail_msg("exit %d: %s%s", r.code, r.out, r.err);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_small_scene_is_compared_unless_that_is_switched_off),
      cmocka_unit_test(a_jump_that_two_runs_miss_alike_is_seen),
      cmocka_unit_test(a_step_between_two_near_cuts_does_not_stay),
      cmocka_unit_test(the_order_of_the_beginning_is_not_that_of_impacts),
      cmocka_unit_test(work_of_damping_that_is_overcounted_is_no_fault),
      cmocka_unit_test(a_reference_dearer_than_the_run_is_not_taken),
      cmocka_unit_test(a_phase_that_is_lost_over_many_turns_is_seen),
      cmocka_unit_test(what_a_runs_own_figures_say_may_be_refuted),
      cmocka_unit_test(a_reference_whose_errors_grew_is_overruled),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
