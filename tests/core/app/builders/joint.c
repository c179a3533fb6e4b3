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
  refused("kind = 'distance', a = a, b = b, at = {0, 0, 0.5}, to = {0, 0, 0.5}", "a distance of 0 m");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(joints_keep_what_they_say_and_no_more),
      cmocka_unit_test(bodies_are_joined_to_particles_and_to_what_stands_still),
      cmocka_unit_test(what_cannot_be_joined_gets_a_sentence),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
