/* Stops of hinges and sliders: where they stop, how they bounce, and what rests on them, against closed forms. */
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
static const double g = 10;

/* A slide of 2 kg on a vertical rail, at rest at 0, falls to a stop 0.2 m below. */
static void fall(const char *options, double duration, const char *stop) {
  static char text[2048];
  snprintf(text, sizeof text,
           "local scene = hooke.scene { duration = %.17g, fps = 20, %s }\n"
           "scene:force('gravity', { g = {0, 0, -10} })\n"
           "local a = scene:rigid { shape = 'box', size = {0.1, 0.1, 0.1}, mass = 2 }\n"
           "local j = scene:joint { kind = 'slider', a = a, at = {0, 0, 0}, axis = {0, 0, 1} }\n"
           "scene:constraint('joint_stops', { points = { j:frame() }, of = 'way', lower = -0.2, %s })\n"
           "scene:measure('q', function(s) return j:way(s) end)\n"
           "scene:measure('u', function(s) return j:speed(s) end)\n"
           "scene:measure('f', function(s) return s:constraint_forces('joint_stops')[1] end)\nreturn scene\n",
           duration, options, stop);
  test_write("fall.lua", text);
  test_hooke(&r, NULL, "run fall.lua --json --quiet --no-output");
  if (r.code != 0) fail_msg("%s: exit %d: %s", stop, r.code, r.err);
}

static void near(const char *key, double wanted, double tolerance) {
  double got = test_json(strstr(r.out, "\"measures\""), key);
  if (!(fabs(got - wanted) <= tolerance)) fail_msg("%s is %.12g, not %.12g +- %g", key, got, wanted, tolerance);
}

static const char *const leapfrog = "dt = 1 / 300, integrator = 'leapfrog'";

/* It falls for sqrt(2 d/g) = 0.2 s and arrives at 2 m/s, leaves at e 2 m/s and flies for 2 e 0.2 s, ... Leapfrog has
 * parabolas exactly, and impacts are found within a step. */
static void a_slide_bounces_as_often_and_high_as_known(void **state) {
  (void)state;
  double t = 1.05, u = 2, at = 0.2, e = 0.8;
  while (at + 2 * e * u / g < t) at += 2 * e * u / g, u *= e;
  double now = t - at;
  fall(leapfrog, t, "bounce = 0.8");
  near("q", -0.2 + e * u * now - g * now * now / 2, 1e-9);
  near("u", e * u - g * now, 1e-8);
  fall("dt = 1 / 300, integrator = 'rk4'", t, "bounce = 0.8");
  near("q", -0.2 + e * u * now - g * now * now / 2, 1e-9);
}

/* Without loss it goes on for ever, and is where it began after each 0.4 s. */
static void a_slide_without_loss_returns(void **state) {
  (void)state;
  fall(leapfrog, 4, "bounce = 1");
  near("q", 0, 1e-9);
  near("u", 0, 1e-7);
}

/* Without bounce it stays, and the stop bears its weight; with some it comes to rest after 0.2 (1 + e)/(1 - e) s. */
static void what_has_come_to_rest_is_borne(void **state) {
  (void)state;
  fall(leapfrog, 1, "bounce = 0");
  near("q", -0.2, 1e-12), near("u", 0, 1e-12), near("f", 20, 1e-9);
  fall(leapfrog, 1.2, "bounce = 0.5, still = 1e-2");
  near("q", -0.2, 1e-9), near("u", 0, 1e-9), near("f", 20, 1e-9);
}

/* A door that swings freely at 2 rad/s between stops at -0.5 and 1 rad, without loss: a saw. Between two bodies, the
 * angular momentum is kept. */
static void a_hinge_swings_between_its_stops(void **state) {
  (void)state;
  for (int pair = 0; pair < 2; pair++) {
    static char text[2048];
    snprintf(
        text, sizeof text,
        "local scene = hooke.scene { duration = 1.9, fps = 10, dt = 1 / 200, integrator = 'leapfrog' }\n"
        "local a = scene:rigid { mass = 2, inertia = { 0.3, 0.4, 0.5 }, spin = { 0, 0, 2 } }\n"
        "local b\nif %d == 1 then b = scene:rigid { mass = 2, inertia = { 0.3, 0.4, 0.5 } } end\n"
        "local j = scene:joint { kind = 'hinge', a = a, b = b, at = { 0, 0, 0 }, axis = { 0, 0, 1 } }\n"
        "scene:constraint('joint_stops', { points = { j:frame() }, lower = -0.5, upper = 1, bounce = 1 })\n"
        "scene:measure('q', function(s) return j:angle(s) end)\n"
        "scene:measure('u', function(s) return j:speed(s) end)\n"
        "scene:measure('L', function(s) return a:angular_momentum(s)[3] + (b and b:angular_momentum(s)[3] or 0) end)\n"
        "return scene\n",
        pair);
    test_write("door.lua", text);
    test_hooke(&r, NULL, "run door.lua --json --quiet --no-output");
    if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
    near("q", 0.8, 1e-4); /* 3.8 rad of way: 1 up, 1.5 down, and 1.3 up; the method turns too fast by (w h)^2/6 */
    near("u", 2, 1e-4);
    if (pair) near("L", 1, 1e-5); /* beside one-sided equations it projects after its steps, which gives turns some */
  }
}

/* A stop that nothing reaches changes no method: leapfrog and kahan_li8 keep bodies and joints in their own steps, with
 * the energy that they have without it (where all steps were projected after they were taken, leapfrog was off by 3e-3
 * of the energy after 100 s, kahan_li8 by 3e-4). */
static void a_stop_out_of_reach_changes_nothing(void **state) {
  (void)state;
  static const char *const method[2] = {"leapfrog", "kahan_li8"};
  for (int k = 0; k < 4; k++) {
    static char text[2048];
    snprintf(text, sizeof text,
             "local scene = hooke.scene { duration = 10, fps = 1, dt = 1 / 100, integrator = '%s' }\n"
             "scene:force('gravity', { g = {0, 0, -10} })\n"
             "local a = scene:rigid { shape = 'box', size = {1, 0.4, 0.2}, mass = 3, position = {0.5, 0, 0} }\n"
             "local j = scene:joint { kind = 'hinge', a = a, at = {0, 0, 0}, axis = {0, 1, 0} }\n"
             "if %d == 1 then scene:constraint('joint_stops', { points = { j:frame() }, lower = -1, upper = 4 }) end\n"
             "scene:measure('q', function(s) return j:angle(s) end)\n"
             "scene:measure('E', function(s) return s:energy() end)\nreturn scene\n",
             method[k / 2], k % 2);
    test_write("free.lua", text);
    test_hooke(&r, NULL, "run free.lua --json --quiet --no-output");
    if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
    static double angle, energy;
    if (k % 2) near("q", angle, 1e-8), near("E", energy, 1e-9);
    angle = test_json(strstr(r.out, "\"measures\""), "q");
    energy = test_json(strstr(r.out, "\"measures\""), "E");
  }
}

/* A pendulum that falls on a stop once in a second keeps its energy through all impacts: each ends a part of a step,
 * and the parts are those of the method, of order 8. */
static void impacts_leave_a_method_its_order(void **state) {
  (void)state;
  test_write("hit.lua",
             "local scene = hooke.scene { duration = 10, fps = 10, dt = 1 / 200, integrator = 'kahan_li8' }\n"
             "scene:force('gravity', { g = {0, 0, -10} })\n"
             "local a = scene:rigid { shape = 'box', size = {1, 0.4, 0.2}, mass = 3, position = {0.5, 0, 0} }\n"
             "local j = scene:joint { kind = 'hinge', a = a, at = {0, 0, 0}, axis = {0, 1, 0} }\n"
             "scene:constraint('joint_stops', { points = { j:frame() }, lower = -1, upper = 2.5, bounce = 1 })\n"
             "local most = 0\n"
             "scene:on_frame(function(s) most = math.max(most, j:angle(s)) end)\n"
             "scene:measure('most', function(s) return most end)\n"
             "scene:measure('E', function(s) return s:energy() end)\nreturn scene\n");
  test_hooke(&r, NULL, "run hit.lua --json --quiet --no-output --no-check");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  near("E", 0, 1e-9);
  near("most", 2.4, 0.1);
}

static void refused(const char *stop, const char *text) {
  static char scene[1024];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 0.1 }\n"
           "local a = scene:rigid { shape = 'sphere', radius = 0.1, mass = 2 }\n"
           "local j = scene:joint { kind = 'hinge', a = a, at = {0, 0, 0}, axis = {0, 0, 1} }\n"
           "scene:constraint('joint_stops', { points = { j:frame() }, %s })\nreturn scene\n",
           stop);
  test_refused(scene, "--quiet --no-output", 1, text);
}

static void limits_that_cannot_be_get_a_sentence(void **state) {
  (void)state;
  refused("lower = 1", "an angle needs both lower and upper");
  refused("lower = 0.25, upper = 1",
          "joint 1 starts at 0 rad, outside of its stops by 0.25: start it between them, or move lower");
  refused("lower = 1, upper = 0.5", "lower, 1, has to be below upper, 0.5");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_slide_bounces_as_often_and_high_as_known),
      cmocka_unit_test(a_slide_without_loss_returns),
      cmocka_unit_test(what_has_come_to_rest_is_borne),
      cmocka_unit_test(a_hinge_swings_between_its_stops),
      cmocka_unit_test(a_stop_out_of_reach_changes_nothing),
      cmocka_unit_test(impacts_leave_a_method_its_order),
      cmocka_unit_test(limits_that_cannot_be_get_a_sentence),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
