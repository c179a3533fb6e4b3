/* What a run that is inaccurate says would do: with it, the run is ok; and it names the force that swings fastest. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* A stiff and a soft oscillator, w = 20 and 3 /s. */
static const char scene[] = "local scene = hooke.scene { duration = 2, fps = 20 }\n"
                            "local list = {}\n"
                            "for i = 1, 3 do list[i] = scene:particle { position = {i * 1.2, 0, 0}, mass = 1 } end\n"
                            "scene:pin { 1 }\n"
                            "scene:force('springs', { edges = {{1, 2}}, k = 400, rest = 1, label = 'stiff' })\n"
                            "scene:force('springs', { edges = {{1, 3}}, k = 9, rest = 2, label = 'soft' })\n"
                            "return scene\n";

static test_result r;

static void run(const char *options) {
  char arguments[512];
  test_write("two.lua", scene);
  snprintf(arguments, sizeof arguments, "run two.lua --json --quiet --no-output %s", options);
  test_hooke(&r, NULL, arguments);
}

/* "--dt X" or "--tol X" of the remedy, in `option`. */
static void remedy(char *option, size_t size) {
  const char *text = strstr(r.out, "\"remedy\":\"--");
  if (!text) fail_msg("no remedy in: %s", r.out);
  text += strlen("\"remedy\":\"");
  snprintf(option, size, "%.*s", (int)(strcspn(text, " ") + 1 + strcspn(text + strcspn(text, " ") + 1, " ")), text);
}

static void what_it_says_would_do_does(void **state) {
  (void)state;
  static const char *const cases[] = {"--integrator leapfrog --dt 0.05 --accuracy 1e-2",
                                      "--integrator leapfrog --dt 0.02 --accuracy 1e-3",
                                      "--integrator euler --dt 2e-4 --accuracy 1e-3",
                                      "--integrator rk4 --dt 0.05 --accuracy 1e-5",
                                      "--integrator bdf2 --dt 0.01 --accuracy 1e-2",
                                      "--integrator backward_euler --dt 1e-3 --accuracy 1e-2",
                                      "--integrator dopri5 --tol 1e-3 --accuracy 1e-6",
                                      "--integrator euler --dt 1e-3 --trust", /* by its energy alone */
                                      "--integrator midpoint --dt 0.02 --trust"};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    char option[64], again[256];
    run(cases[k]);
    if (r.code != 5 || !strstr(r.out, "are those of 'stiff'")) fail_msg("%s: %d: %s%s", cases[k], r.code, r.out, r.err);
    remedy(option, sizeof option);
    snprintf(again, sizeof again, "%s %s", cases[k], option); /* the last one counts */
    run(again);
    if (r.code != 0) fail_msg("%s: %d: %s%s", again, r.code, r.out, r.err);
  }
}

static void what_is_far_off_is_not_extrapolated(void **state) {
  (void)state;
  run("--integrator euler --dt 0.05 --accuracy 1e-9");
  assert_int_equal(r.code, 5);
  assert_non_null(strstr(r.out, "\"remedy\":\"try --dt 0.005: the error is too large to tell which step would do"));
}

/* At its smallest tolerance a method is not told to take it; another one that reaches rounding may do, and does. */
static void a_tolerance_that_a_run_has_is_no_remedy(void **state) {
  (void)state;
  run("--integrator dopri5 --tol 1e-13 --accuracy 3e-14");
  assert_int_equal(r.code, 5);
  assert_null(strstr(r.out, "--tol 1e-13 would do"));
  assert_non_null(strstr(r.out, "\"remedy\":\"no --tol would do, as errors of dopri5 fall to tolerances of 1e-13: try "
                                "--integrator gauss_radau"));
  run("--integrator gauss_radau --accuracy 3e-14");
  assert_int_equal(r.code, 0);
  run("--integrator dopri5 --tol 1e-10 --accuracy 3e-14");
  assert_int_equal(r.code, 5);
  assert_non_null(strstr(r.out, "\"remedy\":\"try --tol 1e-13, the smallest that dopri5 makes use of"));
}

/* What would take many times as long as the run is not tried, and the order is said on which it rests. A chain of bars
 * falls onto a plane: impacts leave order 1, whatever the method's is. Where half the step is nearer to a reference,
 * the order is seen. */
static void what_it_rests_on_is_said(void **state) {
  (void)state;
  test_write("bars.lua", "local scene = hooke.scene { duration = 1, fps = 30, dt = 1 / 300, integrator = 'leapfrog' }\n"
                         "local edges = {}\n"
                         "for i = 1, 5 do scene:particle { position = { i * 0.1, 0, 0.02 * i }, mass = 0.1 } end\n"
                         "for i = 1, 4 do edges[i] = { i, i + 1 } end\n"
                         "scene:force('gravity', {})\n"
                         "scene:constraint('bars', { edges = edges })\n"
                         "scene:corrector('obstacle', { friction = 0.3, restitution = 0.3 })\nreturn scene\n");
  test_hooke(&r, NULL, "run bars.lua --json --quiet --no-output --accuracy 1e-7");
  assert_int_equal(r.code, 5);
  if (!strstr(r.out, "to the power 1, as impacts leave it (not tried)")) fail_msg("%s", r.out);
  run("--integrator euler --dt 1e-4 --accuracy 3e-5");
  if (!strstr(r.out, "as half the step shows") && !strstr(r.out, "and half the step shows it")) fail_msg("%s", r.out);
  run("--integrator euler --dt 1e-3 --trust");
  if (!strstr(r.out, "(not tried)")) fail_msg("%s", r.out);
}

/* A pulse of 30 ms whose edges steps of any length pass by: the order of the method says nothing, and the step that it
 * asks for is tried, be the machine ever so busy. A fast one goes on to a step with which the run is ok. */
static void a_step_that_would_not_do_is_not_offered(void **state) {
  (void)state;
  test_write("late.lua", "local scene = hooke.scene { duration = 2, fps = 50 }\n"
                         "scene:particle { position = { 0, 0, 0 }, mass = 1 }\n"
                         "scene:particle { position = { 0, 0, -1 }, mass = 0.5 }\n"
                         "scene:pin { 1 }\n"
                         "scene:force('springs', { edges = { { 1, 2 } }, k = 200, rest = 1 })\n"
                         "scene:force('gravity', { g = function(t)\n"
                         "  return { t > 1.6 and t < 1.63 and 200 or 0, 0, -9.81 } end })\nreturn scene\n");
  test_hooke(&r, NULL, "run late.lua --integrator leapfrog --dt 0.02 --accuracy 1e-3 --json --quiet --no-output");
  assert_int_equal(r.code, 5);
  if (!strstr(r.out, "was tried, and is not enough") && !strstr(r.out, "would do: a run with it is ok"))
    fail_msg("%s", r.out);
}

/* The step that is offered as tried is one with which the run is ok. */
static void a_step_that_was_tried_would_do(void **state) {
  (void)state;
  test_write("swing.lua", "local scene = hooke.scene { duration = 1, fps = 50 }\n"
                          "scene:particles { positions = { { 0, 0, 0 }, { 0.3, 0.1, -1 } }, mass = 0.5 }\n"
                          "scene:pin { 1 }\n"
                          "scene:force('springs', { edges = { { 1, 2 } }, k = 200, rest = 1 })\n"
                          "scene:force('gravity', {})\nreturn scene\n");
  test_hooke(&r, NULL, "run swing.lua --integrator leapfrog --dt 0.02 --accuracy 1e-3 --json --quiet --no-output");
  assert_int_equal(r.code, 5);
  const char *remedy = strstr(r.out, "\"remedy\":\"--dt ");
  if (!remedy || !strstr(remedy, "would do: a run with it is ok")) fail_msg("%s", remedy ? remedy : r.out);
  char again[256];
  snprintf(again, sizeof again,
           "run swing.lua --integrator leapfrog --dt %g --accuracy 1e-3 --json --quiet --no-output",
           strtod(strstr(remedy, "--dt ") + 5, NULL));
  test_hooke(&r, NULL, again);
  assert_int_equal(r.code, 0);
}

/* A chain with weights hangs over a cylinder, with friction that holds it: steps of a frame land with too much energy,
 * by an error that follows no order. */
static void steps_of_impacts_are_tried(void **state) {
  (void)state;
  test_write("capstan.lua",
             "local scene = hooke.scene { duration = 0.1, fps = 50, integrator = 'leapfrog' }\n"
             "local n, R, ids, edges = 16, 0.1, {}, {}\n"
             "local turn = math.pi / n\n"
             "local out = (R + 1e-6) / math.cos(turn / 2)\n"
             "local l = 2 * out * math.sin(turn / 2)\n"
             "local function bead(x, z, m) ids[#ids + 1] = scene:particle { position = { x, 0, z }, mass = m } end\n"
             "for k = 6, 1, -1 do bead(-R - 1e-6, l * (0.5 - k), k == 6 and 1 or 0.01) end\n"
             "for k = 1, n do bead(-out * math.cos(turn * (k - 0.5)), out * math.sin(turn * (k - 0.5)), 0.01) end\n"
             "for k = 1, 6 do bead(R + 1e-6, l * (0.5 - k), k == 6 and 2 or 0.01) end\n"
             "for k = 2, #ids do edges[k - 1] = { ids[k - 1], ids[k] } end\n"
             "scene:force('gravity')\n"
             "scene:constraint('bars', { edges = edges })\n"
             "scene:corrector('obstacle', { shape = 'cylinder', size = { 2 * R, 2 * R, 1 },\n"
             "  rotation = { math.pi / 2, 0, 0 }, friction = 0.3 })\nreturn scene\n");
  test_hooke(&r, NULL, "run capstan.lua --json --quiet --no-output");
  assert_int_equal(r.code, 5);
  if (!strstr(r.out, "would do: a run with it is ok")) fail_msg("%s", r.out);
}

/* A triangle of bars lies on a slope that holds it by friction: it starts in contact, and nothing moves. What it creeps
 * within the tolerance of contact is no energy that contact gave. */
static void what_lies_still_needs_none(void **state) {
  (void)state;
  test_write("lies.lua", "local scene = hooke.scene { duration = 0.5, fps = 50, integrator = 'leapfrog' }\n"
                         "local a, ids = math.rad(20), {}\n"
                         "for k, p in ipairs { { 0, 0 }, { 0.3, 0.05 }, { 0.1, 0.25 } } do\n"
                         "  ids[k] = scene:particle { position = { p[1], p[2], 5e-4 }, mass = 0.1 * k }\nend\n"
                         "scene:constraint('bars', { edges = { { 1, 2 }, { 2, 3 }, { 1, 3 } } })\n"
                         "scene:force('gravity', { g = { 9.81 * math.sin(a), 0, -9.81 * math.cos(a) } })\n"
                         "scene:body { shape = 'plane', size = 5 }\n"
                         "scene:corrector('contact', { friction = 1.01 * math.tan(a) })\nreturn scene\n");
  test_hooke(&r, NULL, "run lies.lua --json --quiet --no-output");
  if (r.code != 0) fail_msg("%s", r.out);
}

static void a_run_that_is_ok_has_none(void **state) {
  (void)state;
  run("--integrator rk4 --dt 0.001 --accuracy 1e-3");
  assert_int_equal(r.code, 0);
  assert_non_null(strstr(r.out, "\"remedy\":\"\""));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_it_says_would_do_does),
      cmocka_unit_test(what_is_far_off_is_not_extrapolated),
      cmocka_unit_test(a_tolerance_that_a_run_has_is_no_remedy),
      cmocka_unit_test(what_it_rests_on_is_said),
      cmocka_unit_test(a_step_that_would_not_do_is_not_offered),
      cmocka_unit_test(a_step_that_was_tried_would_do),
      cmocka_unit_test(steps_of_impacts_are_tried),
      cmocka_unit_test(what_lies_still_needs_none),
      cmocka_unit_test(a_run_that_is_ok_has_none),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
