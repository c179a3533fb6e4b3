/* Springs, dampers, motors and friction in joints, against closed forms. */
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

/* A flywheel of I = 0.5 kg m^2 on an axle that stands still, which starts at `spin` about it, or a slide of 2 kg along
 * x at `spin` m/s; `drive` is what acts on it. */
static void run(const char *options, double spin, const char *drive) {
  static char text[4096];
  snprintf(text, sizeof text,
           "local slide = %d\n"
           "local scene = hooke.scene { duration = 2, fps = 20, %s }\n"
           "local wheel = scene:rigid { mass = 2, inertia = { 0.3, 0.4, 0.5 }, %s = { %s%g%s } }\n"
           "local j = scene:joint { kind = slide == 1 and 'slider' or 'hinge', a = wheel, at = { 0, 0, 0 },\n"
           "  axis = slide == 1 and { 1, 0, 0 } or { 0, 0, 1 } }\n"
           "%s\n"
           "scene:measure('u', function(s) return j:speed(s) end)\n"
           "scene:measure('q', function(s) return slide == 1 and j:way(s) or j:angle(s) end)\n"
           "scene:measure('E', function(s) return s:energy() end)\nreturn scene\n",
           strstr(drive, "way") != NULL, options, strstr(drive, "way") ? "velocity" : "spin",
           strstr(drive, "way") ? "" : "0, 0, ", spin, strstr(drive, "way") ? ", 0, 0" : "", drive);
  test_write("drive.lua", text);
  test_hooke(&r, NULL, "run drive.lua --json --quiet --no-output");
  if (r.code != 0) fail_msg("%s: exit %d: %s", drive, r.code, r.err);
}

static void near(const char *key, double wanted, double tolerance) {
  double got = test_json(strstr(r.out, "\"measures\""), key);
  if (!(fabs(got - wanted) <= tolerance)) fail_msg("%s is %.12g, not %.12g +- %g", key, got, wanted, tolerance);
}

static const char *const fine = "dt = 1 / 400, integrator = 'rk4'";

/* I q'' = -k q - c q': w = sqrt(k/I - (c/2I)^2), and the same of a slide. Errors of rk4, (w h)^4. */
static void a_spring_and_a_damper_swing_as_known(void **state) {
  (void)state;
  for (int slide = 0; slide < 2; slide++) {
    double I = slide ? 2 : 0.5, k = 30, c = 0.6, b = c / (2 * I), w = sqrt(k / I - b * b), t = 2, u = 1.5;
    run(fine, u,
        slide ? "scene:force('joint_drives', { points = { j:frame() }, of = 'way', k = 30, damping = 0.6 })"
              : "scene:force('joint_drives', { points = { j:frame() }, k = 30, damping = 0.6 })");
    near("q", u / w * exp(-b * t) * sin(w * t), 1e-7);
    near("u", u * exp(-b * t) * (cos(w * t) - b / w * sin(w * t)), 1e-6);
  }
}

/* Implicit steps have the same motion to their order, and leapfrog keeps the energy of the spring. */
static void methods_agree(void **state) {
  (void)state;
  double w = sqrt(30 / 0.5);
  run("dt = 1 / 400, integrator = { 'implicit_midpoint', tolerance = 1e-10 }", 1.5,
      "scene:force('joint_drives', { points = { j:frame() }, k = 30 })");
  near("q", 1.5 / w * sin(w * 2), 1e-3);
  near("E", 0.5 * 0.5 * 1.5 * 1.5, 1e-4);
  run("dt = 1 / 400, integrator = 'leapfrog'", 1.5, "scene:force('joint_drives', { points = { j:frame() }, k = 30 })");
  near("E", 0.5 * 0.5 * 1.5 * 1.5, 1e-3);
}

/* Turns are counted: wound up by three and a half turns, and let go, a spring drives the wheel back through all of
 * them: after half a period it is wound the other way. */
static void a_spring_remembers_whole_turns(void **state) {
  (void)state;
  double w = 2, a = 7 * 3.14159265358979323846, pi = 3.14159265358979323846;
  char drive[256];
  snprintf(drive, sizeof drive, "scene:force('joint_drives', { points = { j:frame() }, k = 2, rest = %.17g })", a);
  run(fine, 0, drive);
  near("u", a * w * sin(w * 2), 1e-3); /* it turns by 0.1 rad in a step of order 4 */
  near("q", remainder(a - a * cos(w * 2), 2 * pi), 1e-3);
}

/* I u' = c (u_0 - u), and with a bound a torque at first: u = most t/I until c (u_0 - u) = most. */
static void a_motor_turns_a_flywheel_as_known(void **state) {
  (void)state;
  run(fine, 0, "scene:force('joint_drives', { points = { j:frame() }, damping = 1, speed = 4 })");
  near("u", 4 * (1 - exp(-1 * 2 / 0.5)), 1e-7);
  run(fine, 0, "scene:force('joint_drives', { points = { j:frame() }, damping = 1, speed = 4, most = 1.5 })");
  double t = 0.5 * 2.5 / 1.5; /* s, at which it has 2.5 rad/s, and 1.5 to go */
  near("u", 4 - 1.5 * exp(-(2 - t) / 0.5), 1e-5);
  run(fine, 0,
      "scene:force('joint_drives', { points = { j:frame() }, damping = 1, speed = function(t) return 3 * t end })");
  near("u", 3 * (2 - 0.5 * (1 - exp(-2 / 0.5))), 1e-6);
}

/* Coulomb's friction slows it at f/I; at rest it stays, where a torque below friction would have it creep. */
static void friction_stops_a_flywheel(void **state) {
  (void)state;
  run(fine, 3, "scene:force('joint_drives', { points = { j:frame() }, friction = 0.5, slip = 1e-2 })");
  near("u", 1, 1e-6);
  run("dt = 1 / 2000, integrator = 'rk4'", 1,
      "scene:force('joint_drives', { points = { j:frame() }, friction = 0.5 })");
  near("u", 0, 1e-6);
  near("q", 0.5, 1e-3);
}

/* Between two bodies nothing is given to both together: momentum and angular momentum are kept, and they turn against
 * each other. */
static void a_motor_between_bodies_turns_both(void **state) {
  (void)state;
  test_write("pair.lua",
             "local scene = hooke.scene { duration = 1, fps = 10, dt = 1 / 400, integrator = 'rk4' }\n"
             "local a = scene:rigid { mass = 2, inertia = { 0.3, 0.4, 0.5 } }\n"
             "local b = scene:rigid { mass = 1, inertia = { 0.3, 0.4, 0.25 }, position = { 0.2, 0, 0 } }\n"
             "local j = scene:joint { kind = 'hinge', a = a, b = b, at = { 0.1, 0, 0 }, axis = { 0, 0, 1 } }\n"
             "scene:force('joint_drives', { points = { j:frame() }, damping = 0.3, speed = 2 })\n"
             "scene:measure('L', function(s) return a:angular_momentum(s, {0, 0, 0})[3] + b:angular_momentum(s, {0, 0, "
             "0})[3] end)\n"
             "scene:measure('P', function(s) return a:momentum(s)[1] + b:momentum(s)[1] end)\n"
             "scene:measure('u', function(s) return j:speed(s) end)\nreturn scene\n");
  test_hooke(&r, NULL, "run pair.lua --json --quiet --no-output");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  near("L", 0, 1e-12);
  near("P", 0, 1e-12);
  if (!(test_json(strstr(r.out, "\"measures\""), "u") > 1)) fail_msg("it does not turn");
}

static void refused(const char *drive, const char *text) {
  static char scene[1024];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 0.1 }\n"
           "local a = scene:rigid { shape = 'sphere', radius = 0.1, mass = 2 }\n"
           "local j = scene:joint { kind = 'hinge', a = a, at = {0, 0, 0}, axis = {0, 0, 1} }\n"
           "scene:force('joint_drives', { %s })\nreturn scene\n",
           drive);
  test_refused(scene, "--quiet --no-output", 1, text);
}

static void what_drives_nothing_gets_a_sentence(void **state) {
  (void)state;
  refused("k = 1", "points");
  refused("points = { j:frame() }, of = 'way', k = 1",
          "tuple 1 is the frame of a hinge, which has an angle and no way");
  refused("points = { scene:joint({ kind = 'slider', a = a, at = {0.1, 0.2, 0.3}, axis = {1, 2, 3} }):frame() }, k = 1",
          "that of a slider has a way: of = \"way\" takes it");
  refused("points = { j:frame() }, rest = 1", "nothing pulls to 1, since k is 0");
  refused("points = { j:frame() }, most = 1", "there is nothing to bound");
  refused("points = { j:frame() }, speed = 3", "nothing drives to 3, since damping is 0");
  refused("points = { { a:point{0, 0, 0}, a:point{0, 0, 1}, a:point{0, 0, 2}, a:point{1, 0, 0} } }, k = 1",
          "another one is on their line");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_spring_and_a_damper_swing_as_known),
      cmocka_unit_test(methods_agree),
      cmocka_unit_test(a_spring_remembers_whole_turns),
      cmocka_unit_test(a_motor_turns_a_flywheel_as_known),
      cmocka_unit_test(friction_stops_a_flywheel),
      cmocka_unit_test(a_motor_between_bodies_turns_both),
      cmocka_unit_test(what_drives_nothing_gets_a_sentence),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
