/* The handle of scene:joint: angles, ways and speeds, and forces and torques, against closed forms. */
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

static void run(const char *scene) {
  static char text[4096];
  snprintf(text, sizeof text,
           "local scene = hooke.scene { duration = 0.5, fps = 100, dt = 1 / 1000, integrator = 'leapfrog' }\n"
           "local function m(name, f) scene:measure(name, f) end\n%s\nreturn scene\n",
           scene);
  test_write("handle.lua", text);
  test_hooke(&r, NULL, "run handle.lua --json --quiet --no-output");
  if (r.code != 0) fail_msg("%s: exit %d: %s", scene, r.code, r.err);
}

static void near(const char *key, double wanted, double tolerance) {
  double got = test_json(strstr(r.out, "\"measures\""), key);
  if (!(fabs(got - wanted) <= tolerance)) fail_msg("%s is %.17g, not %.17g +- %g", key, got, wanted, tolerance);
}

/* A box of 0.2 x 0.4 x 1 m and 3 kg on a hinge at the end of its long side, let go level. With phi its fall, I = m
 * (0.2^2 + 1)/12 + m/4 about the hinge: w^2 = m g sin(phi)/I, and on the hinge m (w^2 l + g sin(phi)) along the box, m
 * g cos(phi) (1
 * - m l^2/I) across it, upwards; none about the axis. What is compared holds at any angle: errors are those of the
 * state, (w h)^2, beside rounding. */
static void a_pendulum_pulls_at_its_pivot_as_known(void **state) {
  (void)state;
  run("scene:force('gravity', { g = {0, 0, -9.81} })\n"
      "local body = scene:rigid { shape = 'box', size = {1, 0.4, 0.2}, mass = 3, position = {0.5, 0, 0} }\n"
      "local j = scene:joint { kind = 'hinge', a = body, at = {0, 0, 0}, axis = {0, 1, 0} }\n"
      "local I, g = 3 * 1.04 / 12 + 0.75, 9.81\n"
      "m('along', function(s) local f, p, w = j:force(s), j:angle(s), j:speed(s)\n"
      "  return -f[1] * math.cos(p) + f[3] * math.sin(p) - 3 * (w * w / 2 + g * math.sin(p)) end)\n"
      "m('across', function(s) local f, p = j:force(s), j:angle(s)\n"
      "  return f[1] * math.sin(p) + f[3] * math.cos(p) - 3 * g * math.cos(p) * (1 - 0.75 / I) end)\n"
      "m('energy', function(s) return j:speed(s) ^ 2 * I / 2 - 3 * g / 2 * math.sin(j:angle(s)) end)\n"
      "m('angle', function(s) return j:angle(s) end)\n"
      "m('torque', function(s) local t = j:torque(s) return math.abs(t[1]) + math.abs(t[2]) + math.abs(t[3]) end)\n");
  near("along", 0, 1e-9);
  near("across", 0, 1e-9);
  near("torque", 0, 1e-9);
  near("energy", 0, 1e-4);
  if (!(test_json(strstr(r.out, "\"measures\""), "angle") > 1)) fail_msg("it has hardly turned");
}

/* A beam that juts out from a wall bears its weight, and twice the moment of a half of it: m g l/2. */
static void a_beam_at_rest_has_its_weight_and_moment(void **state) {
  (void)state;
  for (int slider = 0; slider < 2; slider++) {
    char scene[1024];
    snprintf(scene, sizeof scene,
             "scene:force('gravity', { g = {0, 0, -10} })\n"
             "local a = scene:rigid { shape = 'box', size = {2, 0.1, 0.1}, mass = 3, position = {1, 0, 0} }\n"
             "local j = scene:joint { kind = '%s', a = a, at = {0, 0, 0}, axis = %s }\n"
             "for k, c in ipairs { 'x', 'y', 'z' } do\n"
             "  m('f' .. c, function(s) return j:force(s)[k] end)\n"
             "  m('t' .. c, function(s) return j:torque(s)[k] end)\n"
             "end\n",
             slider ? "slider" : "fixed", slider ? "{0, 1, 0}" : "nil");
    run(scene);
    near("fx", 0, 1e-9), near("fy", 0, 1e-9), near("fz", 30, 1e-9);
    near("tx", 0, 1e-9), near("ty", -30, 1e-9), near("tz", 0, 1e-9);
  }
}

/* Free fall along a slope of 3 in 5; the rest of the weight is on the rail. Between two bodies that fly apart the way
 * grows at the speed of the start. */
static void ways_and_speeds_are_those_of_what_slides(void **state) {
  (void)state;
  run("scene:force('gravity', { g = {0, 0, -10} })\n"
      "local a = scene:rigid { shape = 'sphere', radius = 0.1, mass = 2, position = {0, 0, 0} }\n"
      "local j = scene:joint { kind = 'slider', a = a, at = {0, 0, 0}, axis = {0.8, 0, -0.6} }\n"
      "m('way', function(s) return j:way(s) end)\nm('speed', function(s) return j:speed(s) end)\n"
      "m('f', function(s) local f = j:force(s) return f[1] * 0.6 + f[3] * 0.8 end)\n"
      "m('along', function(s) local f = j:force(s) return f[1] * 0.8 - f[3] * 0.6 end)\n");
  near("way", 0.75, 1e-11), near("speed", 3, 1e-11), near("f", 16, 1e-9), near("along", 0, 1e-9);
  run("local a = scene:rigid { shape = 'sphere', radius = 0.1, mass = 2, position = {0, 0, 0}, velocity = {0, 2, 0} }\n"
      "local b = scene:rigid { shape = 'sphere', radius = 0.1, mass = 1, position = {0, 1, 0} }\n"
      "local j = scene:joint { kind = 'slider', a = a, b = b, at = {0, 0, 0}, axis = {0, 1, 0} }\n"
      "m('way', function(s) return j:way(s) end)\nm('speed', function(s) return j:speed(s) end)\n");
  near("way", 1, 1e-11), near("speed", 2, 1e-11);
}

static void refused(const char *line, const char *text) {
  static char scene[1024];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 0.1 }\n"
           "local a = scene:rigid { shape = 'sphere', radius = 0.1, mass = 2 }\n"
           "local j = scene:joint { kind = 'ball', a = a, at = {0, 0, 0} }\n%s\nreturn scene\n",
           line);
  test_refused(scene, "--quiet --no-output", 1, text);
}

static void what_a_joint_has_not_gets_a_sentence(void **state) {
  (void)state;
  refused("j:frame()", "a joint of the kind ball has no frame; a hinge or a slider has");
  refused("j:forces()", "a joint has no 'forces'; did you mean 'force'?");
  refused("j:force()", "expected a state, as in joint:force(state), got nothing");
  refused("scene:measure('m', function(s) return j:angle(s) end)",
          "a joint of the kind ball has no angle; a hinge has");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_pendulum_pulls_at_its_pivot_as_known),
      cmocka_unit_test(a_beam_at_rest_has_its_weight_and_moment),
      cmocka_unit_test(ways_and_speeds_are_those_of_what_slides),
      cmocka_unit_test(what_a_joint_has_not_gets_a_sentence),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
