/* What core/run/run/verify.c and core/scene/scene/overrides.c promise: an accuracy that is asked for is judged by half
 * the step from a disturbed start; runs can leave parts out, be disturbed, be cut short and be given an integrator with
 * its parameters. Through `hooke run`, and through hooke.load in a tool. */
#include "core/app/tools/tools.h"
#include "tests/support/command.h"
#include "tests/support/engine.h"

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

static void run(const char *scene, const char *arguments, int code) {
  char all[512];
  test_write("scene.lua", scene);
  snprintf(all, sizeof all, "run scene.lua --json --quiet --no-output %s", arguments);
  test_hooke(&r, NULL, all);
  if (r.code != code) fail_msg("%s: exit %d instead of %d: %s%s", all, r.code, code, r.err, r.out);
}

/* Runs `body` as a tool with the scene in scene.lua: it asserts. `load(options)` gives the scene, `ends(options)` its
 * summary and packed state at the end, `refused(options)` why it does not start. */
static void tool(const char *scene, const char *body) {
  static const char head[] =
      "package.path = '" HK_ROOT "/tools/?.lua;' .. package.path\n"
      "local states = require('states')\n"
      "local here = hooke.folder .. '/scene.lua'\n"
      "local function load(o) return assert(hooke.load(here, {}, o)) end\n"
      "local function ends(o) local run = load(o):run() return run:summary(), run:packed() end\n"
      "local function refused(o)\n"
      "  local scene, why = hooke.load(here, {}, o)\n"
      "  if not scene then return why end\n"
      "  local fine, message = pcall(scene.run, scene, { to = 0 })\n"
      "  assert(not fine, 'it was not refused')\n"
      "  return tostring(message)\n"
      "end\n"
      "local function says(text, wanted) assert(text:find(wanted, 1, true), wanted .. ' is not in: ' .. text) end\n"
      "local _ = { states, ends, refused, says }\n";
  static char text[8192];
  hk_registry registry;
  hk_error error = {0};
  hk_run_options options = {.dt = NAN, .tol = NAN, .until = NAN, .accuracy = NAN};
  hk_script_options script = {.registry = &registry, .trust = true, .run = &options};
  char path[512], *argv[] = {(char *)(uintptr_t) "probe"};
  int code = 0;
  test_write("scene.lua", scene);
  snprintf(text, sizeof text, "%s%s", head, body);
  snprintf(path, sizeof path, "%s", test_write("probe.lua", text));
  assert_int_equal(hk_registry_open(&registry, HK_BUILD "/plugins", NULL, &error), HK_OK);
  if (hk_tool_run(path, 1, argv, &script, &code, NULL, &error) != HK_OK) fail_msg("%s", error.text);
  hk_registry_close(&registry);
}

/* x'' = -w^2 x, w = 4 1/s, from 1 m; leapfrog is off by the phase w^3 h^2 t/24, so at t = 1 s and h = 1/100 by
 * 2.7e-4 sin(4) = 2.0e-4 m, and half the step by a quarter of that (201 steps in place of 100: 0.2475). */
static const char oscillator[] =
    "local scene = hooke.scene { duration = 1, fps = 1, dt = 0.01 }\n"
    "scene:particle { position = {1, 0, 0}, mass = 1 }\nscene:force('central', { strength = 16 })\n";
static const char exact[] = "scene:exact(function(t) return math.cos(4 * t), 0, 0 end)\n";

static char *joined(const char *a, const char *b) {
  static char text[4096];
  snprintf(text, sizeof text, "%s%sreturn scene\n", a, b);
  return text;
}

static void the_difference_is_what_richardson_says(void **state) {
  (void)state;
  run(joined(oscillator, exact), "--accuracy 1e-2", 0);
  double error = test_json(r.out, "exact_error"), difference = test_json(r.out, "verify_difference");
  double phase = 64 * 1e-4 / 24, expected = fabs(cos(4) - cos(4 * (1 + phase / 4)));
  assert_true(fabs(error / expected - 1) < 0.02); /* the next term of the phase is (w h)^2 of it, 2e-3 */
  assert_true(fabs(difference / error - 0.75) < 0.01);
  assert_true(test_json(r.out, "accuracy") == 1e-2);
}

/* The reference of the estimate is at a tolerance of 1e-5 of the accuracy. */
static void the_estimate_is_the_error_and_decides(void **state) {
  (void)state;
  char arguments[64];
  run(joined(oscillator, exact), "", 0);
  double error = test_json(r.out, "exact_error");
  snprintf(arguments, sizeof arguments, "--accuracy %.17g", 1.04 * error);
  run(joined(oscillator, ""), arguments, 0);
  assert_true(fabs(test_json(r.out, "error_estimate") / error - 1) < 1e-3);
  assert_non_null(strstr(r.out, "error about"));
  snprintf(arguments, sizeof arguments, "--accuracy %.17g", 0.99 * error);
  run(joined(oscillator, ""), arguments, 5);
  assert_non_null(strstr(r.out, "\"verdict\":\"inaccurate\""));
  assert_non_null(strstr(r.out, "is not reached"));
}

static void nothing_asked_for_nothing_judged(void **state) {
  (void)state;
  run(joined(oscillator, "scene:measure('z', function(s) return s:position(1)[3] end)\n"), "", 0);
  assert_true(isnan(test_json(r.out, "accuracy")) && isnan(test_json(r.out, "verify_difference")));
  test_write("asked.lua", "local scene = hooke.scene { duration = 1, fps = 1, dt = 0.01, accuracy = 1e-6 }\n"
                          "scene:particle { position = {1, 0, 0}, mass = 1 }\n"
                          "scene:force('central', { strength = 16 })\nreturn scene\n");
  test_hooke(&r, NULL, "run asked.lua --json --quiet");
  assert_int_equal(r.code, 5);
  test_hooke(&r, NULL, "run asked.lua --json --quiet --accuracy 1e-2"); /* the command line has the last word */
  assert_int_equal(r.code, 0);
}

/* At rest on the top of a hill, x'' = 100 x: it stays there to the last bit with any step, and 1e-14 m off it is
 * 1e-14 e^(10 t)/2 away, 1e-14 e^30/2 = 0.05 m after 3 s. */
static void a_balanced_start_is_found_out(void **state) {
  (void)state;
  const char hill[] = "local scene = hooke.scene { duration = 3, fps = 100, dt = 0.01 }\n"
                      "scene:particle { position = {0, 0, 0}, mass = 1 }\n"
                      "scene:force('central', { strength = -100 })\n"
                      "scene:exact(function(t) return 0, 0, 0 end)\nreturn scene\n";
  run(hill, "--accuracy 1e-3", 5);
  assert_true(test_json(r.out, "exact_error") == 0);
  double off = test_json(r.out, "verify_difference");
  assert_true(off > 1e-3 && off < 0.1);
  assert_non_null(strstr(r.out, "off by 1e-14 of the extent"));
}

/* The solution said to be exact is a metre off, and only one judge looks at it. */
static void a_blind_judge_does_not_see_the_exact_solution(void **state) {
  (void)state;
  const char *wrong = joined(oscillator, "scene:exact(function(t) return math.cos(4 * t) + 1, 0, 0 end)\n");
  tool(wrong, "local seen = load({ accuracy = 1e-2 }):run():verify()\n"
              "assert(seen.verdict == 'inaccurate' and seen.exact_error > 0.9)\n"
              "says(seen.reason, 'is above the accuracy asked for')\n"
              "local unseen = load({ accuracy = 1e-2, ignore_exact = true }):run():verify()\n"
              "assert(unseen.verdict == 'ok', unseen.reason)\n"
              "assert(unseen.verify_difference == seen.verify_difference)\n");
}

/* What a check found stands in summary.json as well; but once another run has begun there, the file is that run's. */
static void summary_json_has_what_the_check_found(void **state) {
  (void)state;
  tool(joined(oscillator, "scene:output('table')\n"),
       "local function kept() return io.open(hooke.folder .. '/kept/summary.json'):read('a') end\n"
       "local run = load({ accuracy = 1e-2, output = true, out = hooke.folder .. '/kept' }):run()\n"
       "assert(kept():find('\"verify_difference\": ?null'), 'before')\n"
       "run:verify()\n"
       "assert(kept():find('\"verify_difference\": ?[%d.]+'), 'after')\n"
       "local other = load({ output = true, out = hooke.folder .. '/kept' })\n"
       "other:run()\n"
       "local before = kept()\n"
       "run:verify()\n"
       "assert(kept() == before, 'another run')\n");
}

/* The force fails at its 150th evaluation: the run of 100 steps does not get there, and that of 201 does. */
static void a_second_run_that_fails_is_no_agreement(void **state) {
  (void)state;
  char scene[1024];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 1, fps = 1, dt = 0.01 }\n"
           "scene:particle { position = {1, 0, 0}, mass = 1 }\nscene:force('central', { strength = 16 })\n"
           "scene:force('%s/tests/fixtures/kicker.so', { fail_at = 150 })\nreturn scene\n",
           HK_BUILD);
  run(scene, "--trust", 0);
  run(scene, "--trust --accuracy 1e-2", 5);
  assert_non_null(strstr(r.err, "with half the step: scene.lua:4: kicker: asked to fail"));
  assert_non_null(strstr(r.out, "\"verdict\":\"inaccurate\""));
  assert_non_null(strstr(r.out, "could not be checked"));
}

/* The error goes with the tolerance (per step, so with its power 5/4 at the end): a tenth of it leaves 0.06 to 0.1. */
static void adaptive_methods_are_checked_by_their_tolerance(void **state) {
  (void)state;
  const char circle[] = "local scene = hooke.scene { duration = 3, fps = 1, tol = 1e-7 }\n"
                        "scene:particle { position = {1, 0, 0}, velocity = {0, 4, 0}, mass = 1 }\n"
                        "scene:force('central', { strength = 16 })\n"
                        "scene:exact(function(t) return math.cos(4 * t), math.sin(4 * t), 0 end)\nreturn scene\n";
  run(circle, "--integrator dopri5 --accuracy 1e-2", 0);
  double error = test_json(r.out, "exact_error"), difference = test_json(r.out, "verify_difference");
  if (!(difference > 0.85 * error && difference < error)) fail_msg("%g of %g", difference, error);
  run(circle, "--integrator dopri5 --accuracy 1e-7", 5);
}

/* ---- what is asked, and what is said ---- */

/* Leapfrog with h w = 1 turns by exactly 60 degrees a step, which is 5 % too fast: after 132 steps, 21 turns, it is one
 * turn ahead and 0.05 m off. */
static void an_accuracy_holds_at_all_frames_or_at_the_end(void **state) {
  (void)state;
  static const char circle[] = "local scene = hooke.scene { duration = 13.2, fps = 10, dt = 0.1, accuracy = 0.2%s }\n"
                               "scene:particle { position = {1, 0, 0}, velocity = {0, 10, 0}, mass = 1 }\n"
                               "scene:force('central', { strength = 100 })\nreturn scene\n";
  char scene[1024];
  snprintf(scene, sizeof scene, circle, "");
  run(scene, "", 5);
  double worst = test_json(r.out, "error_estimate");
  assert_true(worst > 1.9 && worst < 2.4); /* half a turn ahead, on an ellipse of 1 and 1.155 */
  run(scene, "--accuracy-at end", 0);
  snprintf(scene, sizeof scene, circle, ", accuracy_at = 'end'");
  run(scene, "", 0);
  assert_true(fabs(test_json(r.out, "error_estimate") / 0.0531 - 1) < 0.01); /* 132 - 42 pi rad of it */
  snprintf(scene, sizeof scene, circle, ", accuracy_at = 'start'");
  run(scene, "", 1);
  assert_non_null(strstr(r.err, "accuracy_at: expected"));
}

/* y' = -10 y, by euler: y_n = (1 - 10 h)^n, most wrong at t = 0.1: with h = 1/80 by 0.0242, with h = 1/4000 by 4.6e-4.
 */
static void channels_have_an_accuracy_of_their_own(void **state) {
  (void)state;
  static const char decay[] = "local scene = hooke.scene { duration = 1, fps = 20, dt = %s, integrator = 'euler' }\n"
                              "scene:particle { position = {0, 0, 0}, mass = 1 }\n"
                              "scene:channel('y', { initial = 1, rate = -10, accuracy = 5e-3 })\nreturn scene\n";
  char scene[1024];
  snprintf(scene, sizeof scene, decay, "0.0125");
  run(scene, "", 5);
  double ratio = test_json(r.out, "channel_error"), error = exp(-1) - pow(1 - 10 * 0.0125, 8);
  assert_true(fabs(ratio * 5e-3 / error - 1) < 1e-3);
  assert_non_null(strstr(r.out, "error of the channel 'y' is about 0.024"));
  snprintf(scene, sizeof scene, decay, "2.5e-4");
  run(scene, "", 0);
  snprintf(scene, sizeof scene, "%s", "local scene = hooke.scene {}\nscene:channel('y', { accuracy = 0 })\n");
  run(scene, "", 1);
  assert_non_null(strstr(r.err, "channel: accuracy: 0 must be positive"));
}

/* x'' = 100 x grows by e^600 in a minute: its energy is no number, so nothing is known of its balance. */
static void an_energy_that_is_no_number_is_never_ok(void **state) {
  (void)state;
  run("local scene = hooke.scene { duration = 60, fps = 60, integrator = 'rk4', dt = 1/60 }\n"
      "scene:particle { position = {1, 0, 0}, mass = 1 }\n"
      "scene:force('central', { strength = -100 })\nreturn scene\n",
      "", 5);
  assert_non_null(strstr(r.out, "the energy is not finite"));
}

/* What stands behind ok: what was checked of a small scene, which is compared unasked, and of one that is not. The
 * second run prints nothing. */
static void ok_says_what_was_checked(void **state) {
  (void)state;
  static const char many[] = "local scene = hooke.scene { duration = 1, fps = 60 }\n"
                             "scene:grid { nx = 150, ny = 150, width = 1, height = 1, mass = 1 }\n"
                             "scene:force('gravity', {})\nreturn scene\n";
  run(joined(oscillator, "print('once')\n"), "", 0);
  assert_non_null(strstr(r.out, "\"checked\":\"stable, energy balanced to "));
  assert_non_null(strstr(r.out, "error about 0.00"));
  char *first = strstr(r.err, "once");
  assert_true(first && !strstr(first + 1, "once"));
  run(many, "", 0);
  assert_non_null(strstr(r.out, "; accuracy not asked for: --accuracy 0.001 would"));
  assert_true(isnan(test_json(r.out, "error_estimate")));
}

/* A weight that hangs at rest moves by rounding, with which the rounding of its energy is not compared. */
static void a_scene_at_rest_has_its_energy_balanced(void **state) {
  (void)state;
  run("local scene = hooke.scene { duration = 1, fps = 60, integrator = 'bdf2', dt = 1 / 60 }\n"
      "local a = scene:particle { position = { 0, 0, 0 }, mass = 1 }\n"
      "local b = scene:particle { position = { 0, 0, -1 - 9.81 / 300 + 1e-9 }, mass = 1 }\n"
      "scene:pin { a }\n"
      "scene:force('springs', { edges = { { a, b } }, k = 300, rest = 1 })\n"
      "scene:force('gravity', { g = { 0, 0, -9.81 } })\nreturn scene\n",
      "", 0);
  assert_non_null(strstr(r.out, "energy balanced to its rounding"));
}

/* A light pair rings with 33 rad in a step, and bdf2 damps it at once with any such step,
 * while the work of a brake on a heavy body hides the missing energy: half the step agrees, and the reference does not.
 */
static void what_both_runs_damp_is_seen_by_the_reference(void **state) {
  (void)state;
  static const char scene[] =
      "local scene = hooke.scene { duration = 0.1, fps = 60, dt = 1 / 300, integrator = 'bdf2' }\n"
      "scene:particles { positions = { { 0, 0, 0 }, { 1.001, 0, 0 } }, mass = 1e-3 }\n"
      "scene:particle { position = { 0, 5, 0 }, velocity = { 0, 0, 100 }, mass = 1e3 }\n"
      "scene:force('springs', { edges = { { 1, 2 } }, k = 5e4, rest = 1 })\n"
      "scene:force('drag', { rate = 0.01, only = { 3 } })\nreturn scene\n";
  run(scene, "--accuracy 1e-4", 5);
  double difference = test_json(r.out, "verify_difference"), error = test_json(r.out, "error_estimate");
  if (!(2 * difference < 1e-4)) fail_msg("half the step is %g m away", difference);
  assert_true(error > 3e-4); /* of 1 mm between the two, spread over three particles */
}

/* A particle swings with 1e4 1/s, off its rest by `off`, while a heavy one is braked, whose energy and way hide that.
 * Steps of 0.9 of the stable limit damp the swings by far before the first frame, and so does half of them; a reference
 * to the end would take 1e5 steps. */
static void braked_beside_a_swing(const char *off, const char *options, double damping, int code) {
  char scene[1024], arguments[80];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 10, fps = 30 }\n"
           "scene:particles { positions = { { 0, 0, 0 }, { 1 + %s, 0, 0 } }, mass = 1 }\n"
           "scene:particle { position = { 0, 5, 0 }, velocity = { 0, 0, 30 }, mass = 1e4 }\n"
           "scene:pin { 1 }\n"
           "scene:force('springs', { edges = { { 1, 2 } }, k = 1e8, rest = 1, damping = %g })\n"
           "scene:force('drag', { rate = 0.1, only = { 3 } })\nreturn scene\n",
           off, damping);
  snprintf(arguments, sizeof arguments, "--accuracy 1e-2 --integrator %s", options);
  run(scene, arguments, code);
}

static void what_both_runs_damp_is_seen_at_the_beginning(void **state) {
  (void)state;
  static const char *const methods[] = {"rk4", "rk4 --accuracy-at end", "stoermer_wide3", "stoermer_wide4"};
  for (size_t k = 0; k < 4; k++) {
    braked_beside_a_swing("0.05", methods[k], 0, 5);
    double difference = test_json(r.out, "verify_difference"), error = test_json(r.out, "error_estimate");
    if (!(2 * difference < 1e-2)) fail_msg("%s: half the step is %g m away", methods[k], difference);
    assert_true(fabs(error / (0.05 / sqrt(3)) - 1) < 0.1); /* of 5 cm, spread over three particles */
    assert_non_null(strstr(r.out, "lose what half of them lose"));
  }
}

/* A spring at its rest, one off by less than the accuracy, and one whose own damping ends its swings at once. */
static void what_does_not_swing_is_not_lost(void **state) {
  (void)state;
  braked_beside_a_swing("0", "rk4", 0, 0);
  braked_beside_a_swing("0.01", "rk4", 0, 0);
  braked_beside_a_swing("0.05", "rk4", 2e3, 0);
  braked_beside_a_swing("0.05", "rk4 --accuracy-at end", 2, 0); /* which has ended by then */
}

/* ---- hooke.load's options ---- */

static const char pair[] = "local scene = hooke.scene { duration = 0.1, fps = 100, dt = 0.01 }\n"
                           "local a = scene:particle { position = {0, 0, 0}, mass = 1 }\n"
                           "local b = scene:particle { position = {2, 0, 0}, mass = 1 }\n"
                           "scene:pin { a }\n"
                           "scene:force('springs', { edges = {{a, b}}, k = 100, rest = 1, label = 'rod' })\n"
                           "scene:force('gravity', { g = {0, 0, -10} })\n";

static void a_disturbance_moves_free_particles_by_its_size(void **state) {
  (void)state;
  tool(joined(pair, ""),
       "local function start(o) local s = load(o) return s:run({ to = 0 }):packed() end\n"
       "local still, moved = start {}, start { perturb = 1e-6 }\n"
       "local off = states.distance(still, moved)\n"
       "assert(off.x_max > 0 and off.x_max <= 2e-6 * math.sqrt(3), off.x_max)\n" /* of the extent, 2 m, per axis */
       "local far = math.abs(off.x_rms * math.sqrt(2) / off.x_max - 1)\n"
       "assert(far < 1e-12, 'the pinned one moved')\n"
       "assert(off.v_max == 0)\n"
       "assert(start { perturb = 1e-6 } == moved, 'the same seed')\n"
       "assert(start { perturb = 1e-6, perturb_seed = 2 } ~= moved, 'another seed')\n"
       "local small = states.distance(still, start { perturb = 1e-9 })\n"
       "assert(math.abs(small.x_rms / off.x_rms / 1e-3 - 1) < 1e-6)\n" /* 1e-9 of 2 m, rounded to 16 digits */
  );
}

static void what_is_left_out_does_not_act(void **state) {
  (void)state;
  tool(joined(pair, ""), "local _, whole = ends {}\n"
                         "local s, rest = ends { without = { 'gravity', 'rod' } }\n"
                         "assert(states.distance(whole, rest).x_max > 0.01)\n"
                         "assert(states.distance(rest, load({}):run({ to = 0 }):packed()).x_max == 0, 'it moved')\n"
                         "for _, p in ipairs(s.plugins) do assert(p.kind ~= 'force', p.label) end\n"
                         "says(refused { without = { 'roods' } }, \"nothing labelled 'roods'\")\n"
                         "says(refused { without = { 'rod', 'rod' } }, \"nothing labelled 'rod'\")\n");
}

static void a_limit_of_steps_ends_the_run_there(void **state) {
  (void)state;
  tool(joined(pair, ""), "local scene = load { step_limit = 7 }\n"
                         "local run = scene:run { to = 0 }\n"
                         "local fine, message = pcall(scene.run, scene)\n"
                         "assert(not fine and run:summary().steps == 7)\n"
                         "says(tostring(message), '7 steps')\n"
                         "assert(ends({ step_limit = 10 }).steps == 10)\n"); /* the whole run: not one too many */
}

static void an_integrator_comes_with_its_parameters(void **state) {
  (void)state;
  tool(joined(pair, ""),
       "local s = ends { integrator = 'xpbd:substeps=3,bdf=2' }\n"
       "assert(s.integrator == 'xpbd' and s.steps == 10 and s.force_evaluations <= 3 * 10 + 1, s.force_evaluations)\n"
       "local _, few = ends { integrator = 'xpbd:substeps=3' }\n"
       "local _, many = ends { integrator = 'xpbd:substeps=4' }\n"
       "assert(few ~= many)\n"
       "assert(ends({ integrator = 'bdf2', solver = 'pcg:preconditioner=block_jacobi' }).solver == 'pcg')\n"
       "says(refused { integrator = 'xpbd:substep=3' }, \"did you mean 'substeps'?\")\n"
       "says(refused { integrator = 'xpbd:substeps' }, 'is not parameter=value')\n"
       "says(refused { integrator = 'xpbd:substeps=few' }, 'substeps')\n"
       "says(refused { integrator = 'xpbd:substeps=0' }, 'substeps')\n"
       "says(refused { integrator = 'xpbd:sweep=sideways' }, 'sweep')\n"
       "says(refused { integrator = 'leapfog' }, \"did you mean 'leapfrog'?\")\n"
       "says(refused { integrator = 'bdf2', solver = 'pcj' }, \"did you mean 'pcg'?\")\n"
       "says(select(2, pcall(hooke.load, here, {}, { sed = 1 })), \"did you mean 'seed'?\")\n");
}

static void methods_without_multipliers_refuse_constraints_before_the_first_step(void **state) {
  (void)state;
  char scene[1024];
  snprintf(scene, sizeof scene, "%sscene:constraint('%s/tests/fixtures/bar.so', { edges = {{a, b}}, label = 'bar' })\n",
           pair, HK_BUILD);
  tool(joined(scene, ""), "says(refused { integrator = 'xpbd', trust = true }, \"takes no constraints ('bar')\")\n"
                          "load { integrator = 'xpbd', trust = true, without = { 'bar' } }:run { to = 0 }\n"
                          "load { integrator = 'bdf2', trust = true }:run { to = 0 }\n");
}

typedef struct reopening { /* of a scene that opens with `status` */
  hk_scene *scene;
  hk_status status;
  int opened, closed;
} reopening;

static hk_status open_again(void *context, const hk_run_options *options, hk_run **again, hk_error *error) {
  reopening *second = context;
  second->opened++;
  if (second->status != HK_OK) return hk_error_set(error, second->status, "the file is gone");
  return hk_run_open(second->scene, options, again, error);
}

static void close_again(void *context, hk_run *again) {
  reopening *second = context;
  assert_true((again != NULL) == (second->status == HK_OK));
  hk_run_destroy(again);
  second->closed++;
}

static void fall(test_engine *e) {
  test_engine_open(e);
  test_particle(e, 0, 0, 1, 1);
  test_plugin(e, HK_FORCE, "gravity");
  e->scene->duration = 0.5;
  e->options.accuracy = 1e-6;
}

/* The second run is another scene's, of the same description: verifying knows of no script. */
static void the_second_scene_is_opened_and_closed_once(void **state) {
  const hk_status statuses[] = {HK_OK, HK_IO};
  (void)state;
  for (size_t k = 0; k < 2; k++) {
    test_engine first, other;
    hk_summary summary;
    hk_error error = {0};
    fall(&first);
    fall(&other);
    test_run(&first);
    test_advance(&first, 0.5);
    assert_int_equal(hk_run_close(first.run, &error), HK_OK);
    hk_run_summary(first.run, &summary);
    reopening second = {.scene = other.scene, .status = statuses[k]};
    hk_scene_loader loader = {open_again, close_again, &second};
    assert_int_equal(hk_verify(&loader, &first.options, false, first.run, &summary, &error), statuses[k]);
    assert_int_equal(second.opened, 2); /* half the step, and the reference */
    assert_int_equal(second.closed, second.opened);
    assert_true(isnan(summary.verify_difference) == (statuses[k] != HK_OK));
    assert_int_equal(summary.verdict, statuses[k] == HK_OK ? HK_VERDICT_OK : HK_INACCURATE);
    if (statuses[k] != HK_OK) assert_string_equal(error.text, "the file is gone");
    test_engine_close(&other);
    test_engine_close(&first);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_difference_is_what_richardson_says),
      cmocka_unit_test(the_estimate_is_the_error_and_decides),
      cmocka_unit_test(nothing_asked_for_nothing_judged),
      cmocka_unit_test(a_balanced_start_is_found_out),
      cmocka_unit_test(summary_json_has_what_the_check_found),
      cmocka_unit_test(a_blind_judge_does_not_see_the_exact_solution),
      cmocka_unit_test(a_second_run_that_fails_is_no_agreement),
      cmocka_unit_test(the_second_scene_is_opened_and_closed_once),
      cmocka_unit_test(adaptive_methods_are_checked_by_their_tolerance),
      cmocka_unit_test(an_accuracy_holds_at_all_frames_or_at_the_end),
      cmocka_unit_test(channels_have_an_accuracy_of_their_own),
      cmocka_unit_test(an_energy_that_is_no_number_is_never_ok),
      cmocka_unit_test(ok_says_what_was_checked),
      cmocka_unit_test(a_scene_at_rest_has_its_energy_balanced),
      cmocka_unit_test(what_both_runs_damp_is_seen_by_the_reference),
      cmocka_unit_test(what_both_runs_damp_is_seen_at_the_beginning),
      cmocka_unit_test(what_does_not_swing_is_not_lost),
      cmocka_unit_test(a_disturbance_moves_free_particles_by_its_size),
      cmocka_unit_test(what_is_left_out_does_not_act),
      cmocka_unit_test(a_limit_of_steps_ends_the_run_there),
      cmocka_unit_test(an_integrator_comes_with_its_parameters),
      cmocka_unit_test(methods_without_multipliers_refuse_constraints_before_the_first_step),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
