/* scene:joint: what is joined stays so, and is free to move otherwise; a hinge's equation that follows from others does
 * no harm; and one sentence for what cannot be joined. */
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

static const char *const prelude =
    "local scene = hooke.scene { duration = 0.5, fps = 10, dt = 1 / 400, integrator = 'leapfrog' }\n"
    "scene:force('gravity', { g = {0, 0, -9.81} })\n"
    "local a = scene:rigid { shape = 'box', size = {0.2, 0.3, 1}, mass = 2, position = {0, 0, 0}, spin = {1, 2, 0.5} "
    "}\n"
    "local b = scene:rigid { shape = 'box', size = {1, 0.2, 0.3}, mass = 1, position = {0.5, 0, 0.5} }\n"
    "local function dot(p, q) return p[1] * q[1] + p[2] * q[2] + p[3] * q[3] end\n"
    "local function apart(p, q) return math.sqrt((p[1]-q[1])^2 + (p[2]-q[2])^2 + (p[3]-q[3])^2) end\n"
    "local function column(body, s, k) local R = select(2, body:attitude(s)) return {R[1][k], R[2][k], R[3][k]} end\n";

/* The largest value of the expression at any frame. */
static double most(const char *joint, const char *expression) {
  static char scene[4096];
  snprintf(scene, sizeof scene,
           "%slocal pa, pb = a:point{0, 0, 0.5}, b:point{-0.5, 0, 0}\n%s\nlocal worst = 0\n"
           "scene:on_frame(function(s) worst = math.max(worst, math.abs(%s)) end)\n"
           "scene:measure('m', function(s) return worst end)\n"
           "scene:measure('E', function(s) return s:energy() end)\nreturn scene\n",
           prelude, joint, expression);
  test_write("joint.lua", scene);
  test_hooke(&r, NULL, "run joint.lua --json --quiet");
  if (r.code != 0) fail_msg("%s: exit %d: %s", joint, r.code, r.err);
  return test_json(r.out, "m");
}

static void below(double found, double limit) {
  if (!(found <= limit)) fail_msg("%g, expected at most %g", found, limit);
}

static void above(double found, double limit) {
  if (!(found > limit)) fail_msg("%g, expected more than %g", found, limit);
}

/* Points meet to rounding of places of some m; what is free turns by some 0.1 rad at least. */
static void joints_keep_what_they_say_and_no_more(void **state) {
  (void)state;
  const char *ball = "scene:joint { kind = 'ball', a = a, b = b, at = {0, 0, 0.5} }";
  const char *hinge = "scene:joint { kind = 'hinge', a = a, b = b, at = {0, 0, 0.5}, axis = {0, 1, 0} }";
  const char *universal =
      "scene:joint { kind = 'universal', a = a, b = b, at = {0, 0, 0.5}, axis = {0, 0, 1}, axis_b = {1, 0, 0} }";
  const char *slider =
      "scene:joint { kind = 'slider', a = a, b = b, at = {0, 0, 0.5}, axis = {0.6, 0, 0.8} }\n"
      "local pc, pd = b:point{-0.5 + 0.6, 0, 0.8}, b:point{-0.5, 1, 0}\n"
      "local function off(s, q) local p, b, t, sum = s:position(pa), s:position(pb), s:position(q), 0\n"
      "  for k = 1, 3 do sum = sum + (p[k] - b[k]) * (t[k] - b[k]) end return sum end";
  const char *fixed = "scene:joint { kind = 'fixed', a = a, b = b, at = {0, 0, 0.5} }";
  const char *meet = "apart(s:position(pa), s:position(pb))";
  below(most(ball, meet), 1e-12);
  above(most(ball, "apart(column(a, s, 2), column(b, s, 2))"), 0.1);
  below(most(hinge, meet), 1e-12);
  below(most(hinge, "apart(column(a, s, 2), column(b, s, 2))"), 1e-11);
  above(most(hinge, "apart(column(a, s, 1), column(b, s, 1))"), 0.1);
  below(most(universal, meet), 1e-12);
  below(most(universal, "dot(column(a, s, 3), column(b, s, 1))"), 1e-11);
  above(most(universal, "apart(column(a, s, 2), column(b, s, 2))"), 0.1);
  below(most(slider, "off(s, pd)"), 1e-11);
  above(most(slider, "off(s, pc)"), 0.02);
  below(most(slider, "apart(column(a, s, 1), column(b, s, 1)) + apart(column(a, s, 3), column(b, s, 3))"), 1e-11);
  below(most(fixed, meet), 1e-12);
  below(most(fixed, "apart(column(a, s, 1), column(b, s, 1)) + apart(column(a, s, 3), column(b, s, 3))"), 1e-11);
  below(most("scene:joint { kind = 'distance', a = a, b = b, at = {0, 0, -0.5}, to = {1, 0, 0.5} }\n"
             "pa, pb = a:point{0, 0, -0.5}, b:point{0.5, 0, 0}",
             "apart(s:position(pa), s:position(pb)) - math.sqrt(2)"),
        1e-12);
}

static void bodies_are_joined_to_particles_and_to_what_stands_still(void **state) {
  (void)state;
  below(
      most("local p = scene:particle { position = {0, 0, 0.5}, mass = 3 }\nscene:joint { kind = 'ball', a = a, b = p }",
           "apart(s:position(p), s:position(pa))"),
      1e-12);
  below(most("scene:joint { kind = 'ball', a = a, at = {0, 0, 0.5} }", "apart(s:position(pa), {0, 0, 0.5})"), 1e-12);
  below(most("scene:joint { kind = 'hinge', a = a, at = {0, 0, 0.5}, axis = {0, 1, 0} }",
             "apart(column(a, s, 2), {0, 1, 0})"),
        2.3); /* its spin of the start is projected onto the hinge: the axis stays where it is from then on */
}

/* Along a slope of 3 in 5 whatever slides falls with 0.6 g, which leapfrog has exactly; it does not turn, though its
 * centre is beside the rail, and its spin of the start has to end. */
static void a_slider_goes_along_its_axis_alone(void **state) {
  (void)state;
  below(most("scene:joint { kind = 'slider', a = a, at = {0.3, 0.2, 0.5}, axis = {0.8, 0, -0.6} }",
             "s:position(pa)[1] - 0.8 * (0.6 * 9.81 * s.t ^ 2 / 2)"),
        1e-11);
  below(most("scene:joint { kind = 'slider', a = a, at = {0.3, 0.2, 0.5}, axis = {0.8, 0, -0.6} }",
             "apart(column(a, s, 2), {0, 1, 0}) + apart(column(a, s, 1), {1, 0, 0})"),
        1e-11);
}

/* A swing of two equal arms and a bar between them: three equations of its loop follow from the others in space. The
 * bar does not turn, the hinges stay closed, and it swings as a pendulum of all moments, (2 m/3 + M) l^2 w^2/2 = (m +
 * M) g l (cos(p) - cos(1)); what is left is the method's error, (w h)^2. */
static void a_parallelogram_stays_closed(void **state) {
  (void)state;
  const char *swing = "local h, c, s = 0.05, math.cos(1), math.sin(1)\n"
                      "local function arm(x) return scene:rigid { shape = 'box', size = {h, h, 0.6}, mass = 0.5, "
                      "orientation = {0, -1, 0},\n"
                      "  position = {x + 0.3 * s, 5, -0.3 * c} } end\n"
                      "local p, q = arm(0), arm(0.8)\n"
                      "local bar = scene:rigid { shape = 'box', size = {0.8, h, h}, mass = 2, position = {0.6 * s + "
                      "0.4, 5, -0.6 * c} }\n"
                      "local function hinge(a, b, x, z) return scene:joint { kind = 'hinge', a = a, b = b, at = {x, 5, "
                      "z}, axis = {0, -1, 0} } end\n"
                      "local first = hinge(p, nil, 0, 0) hinge(q, nil, 0.8, 0)\n"
                      "hinge(bar, p, 0.6 * s, -0.6 * c) hinge(bar, q, 0.6 * s + 0.8, -0.6 * c)\n"
                      "pa, pb = q:point{0, 0, -0.3}, bar:point{0.4, 0, 0}";
  below(most(swing, "apart(s:position(pa), s:position(pb))"), 1e-11);
  below(most(swing, "apart(column(bar, s, 1), {1, 0, 0})"), 1e-10);
  below(most(swing, "(1 / 3 + 2) * 0.36 * first:speed(s) ^ 2 / 2 + 0.5 * 2 * h ^ 2 / 12 * first:speed(s) ^ 2 / 2\n"
                    "  - 2.5 * 9.81 * 0.6 * (math.cos(1 + first:angle(s)) - c)"),
        1e-3);
}

static void refused(const char *joint, const char *text) {
  char scene[4096];
  snprintf(scene, sizeof scene, "%sscene:joint { %s }\nreturn scene\n", prelude, joint);
  test_refused(scene, "--quiet", 1, text);
}

static void what_cannot_be_joined_gets_a_sentence(void **state) {
  (void)state;
  refused("kind = 'ball', a = a, b = scene:particle { position = {0, 0, 0.75} }, at = {0, 0, 0.5}",
          "joint: at: particle 9 is 0.25 m off {0, 0, 0.5}: the two have to meet at the start");
  refused("kind = 'bal', a = a, b = b, at = {0, 0, 0.5}", "there is no 'bal'; did you mean 'ball'?");
  refused("a = a, b = b, at = {0, 0, 0.5}", "joint: kind: expected ball, hinge");
  refused("kind = 'ball', a = 1, b = b, at = {0, 0, 0.5}", "joint: a: expected a rigid body");
  refused("kind = 'ball', a = a, b = 77, at = {0, 0, 0.5}", "joint: b: expected a rigid body or the id of a particle");
  refused("kind = 'ball', a = a, b = a, at = {0, 0, 0.5}", "the same body");
  refused("kind = 'ball', a = a, b = b", "joint: at: the place of the joint is required");
  refused("kind = 'hinge', a = a, b = b, at = {0, 0, 0.5}", "joint: axis: a hinge needs one");
  refused("kind = 'hinge', a = a, b = b, at = {0, 0, 0.5}, axis = {0, 0, 0}", "has no direction");
  refused("kind = 'slider', a = a, b = b, at = {0, 0, 0.5}", "joint: axis: a slider needs one");
  refused("kind = 'slider', a = a, b = scene:particle { position = {0, 0, 1} }, at = {0, 0, 0.5}, axis = {0, 0, 1}",
          "a particle has no directions: a slider joins bodies");
  refused("kind = 'ball', a = a, b = hooke.scene {}:rigid { shape = 'sphere', radius = 1, mass = 1 }, at = {0, 0, 0.5}",
          "joint: b: this body is of another scene");
  refused("kind = 'distance', a = a, b = b, at = {0, 0, 0.5}, to = {0, 0, 0.5}", "a distance of 0 m");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(joints_keep_what_they_say_and_no_more),
      cmocka_unit_test(a_slider_goes_along_its_axis_alone),
      cmocka_unit_test(a_parallelogram_stays_closed),
      cmocka_unit_test(bodies_are_joined_to_particles_and_to_what_stands_still),
      cmocka_unit_test(what_cannot_be_joined_gets_a_sentence),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
