/* Bodies that a joint joins do not meet each other, whatever its kind and the plugin of contact, unless the joint says
 * so; what they would meet otherwise, they meet. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static test_result r;

/* Two bars of 1 m fall, the first in a hinge at its end, the second joined to it: there their faces are parallel, `gap`
 * apart (below 0: within each other), with the joint in the middle. Under the end of the first, which falls faster than
 * what is free, a ball falls. */
static const char scene[] =
    "local gap, meet, kind = param('gap', 1e-3, ''), param('meet', '', ''), param('kind', 'hinge', '')\n"
    "local law, T, ball = param('law', 'contact', ''), param('T', 0.2, ''), param('ball', false, '')\n"
    "local implicit = law == 'barrier'\n"
    "local scene = hooke.scene { duration = T, fps = 50, dt = 1e-3, integrator = implicit and 'bdf2' or 'leapfrog' }\n"
    "local function bar(x) return scene:rigid { shape = 'box', size = {1, 0.2, 0.2}, mass = 1, position = {x, 0, 2} } "
    "end\n"
    "local a, b = bar(0.5), bar(1.5 + gap)\n"
    "if law ~= 'none' then a:surface() b:surface() end\n"
    "scene:joint { kind = 'hinge', a = a, at = {0, 0, 2}, axis = {0, 1, 0} }\n"
    "local it = { kind = kind, a = b, b = a, at = {1 + gap / 2, 0, 2}, axis = {0, 1, 0} }\n"
    "if kind == 'slider' then it.axis = {0, 0, 1} end\n"
    "if kind == 'ball' or kind == 'distance' or kind == 'fixed' then it.axis = nil end\n"
    "if kind == 'distance' then it.to = {0.5, 0, 2} end\n"
    "if meet ~= '' then it.contact = meet == 'yes' end\n"
    "scene:joint(it)\n"
    "local free = ball and scene:rigid { shape = 'sphere', radius = 0.1, mass = 10, position = {0.9, 0, 1.79} }\n"
    "if ball then free:surface({{0, 0, 0}}, {radius = 0.1}) end\n"
    "scene:force('gravity', { g = {0, 0, -9.81} })\n"
    "if implicit then scene:force(law, { d_hat = 1e-3, thickness = 1e-3 }) elseif law ~= 'none' then\n"
    "  scene:corrector(law, { thickness = 1e-3 }) end\n"
    "scene:measure('tilt', function(s) return select(2, b:attitude(s))[3][1] end)\n"
    "scene:measure('height', function(s) return b:position(s)[3] end)\n"
    "scene:measure('fall', function(s) return ball and free:velocity(s)[3] or 0 end)\n"
    "return scene\n";

static void run(const char *options) {
  char command[256];
  test_write("joined.lua", scene);
  snprintf(command, sizeof command, "run joined.lua --json --quiet --no-output --no-check %s", options);
  test_hooke(&r, NULL, command);
}

static double measure(const char *options, const char *name) {
  run(options);
  if (r.code != 0) fail_msg("%s: exit %d: %s%s", options, r.code, r.err, r.out);
  return test_json(r.out, name);
}

static void near(double found, double wanted, double off, const char *what) {
  if (!(fabs(found - wanted) <= off)) fail_msg("%s: %.12g, expected %.12g", what, found, wanted);
}

/* To rounding of some hundred steps. */
static void what_a_joint_joins_moves_as_without_contact(void **state) {
  (void)state;
  const char *kind[] = {"ball", "hinge", "universal", "slider", "fixed", "distance"};
  for (size_t k = 0; k < 6; k++)
    for (int within = 0; within < 2; within++) {
      char options[128];
      double wanted[2];
      snprintf(options, sizeof options, "kind=%s gap=%s law=none", kind[k], within ? "-0.1" : "1e-3");
      wanted[0] = measure(options, "height"), wanted[1] = test_json(r.out, "tilt");
      snprintf(options, sizeof options, "kind=%s gap=%s", kind[k], within ? "-0.1" : "1e-3");
      near(measure(options, "height"), wanted[0], 1e-11, options);
      near(test_json(r.out, "tilt"), wanted[1], 1e-11, options);
      assert_true(test_json(r.out, "intersections") == 0);
    }
}

/* The joint's plane faces cannot turn against each other, but for what the gap of the touching edges leaves. */
static void with_contact_its_bodies_meet(void **state) {
  (void)state;
  double first = measure("", "tilt");
  near(measure("meet=no", "tilt"), first, 0, "contact = false");
  measure("meet=yes kind=hinge", "tilt");
  assert_true(fabs(test_json(r.out, "tilt") - first) > 1e-3);
  run("meet=yes gap=-0.1");
  assert_int_not_equal(r.code, 0);
}

static void others_are_met(void **state) {
  (void)state;
  near(measure("ball=true law=none", "fall"), -9.81 * 0.2, 1e-9, "free fall");
  assert_true(measure("ball=true", "fall") < -9.81 * 0.2 - 0.01);
}

static void the_barrier_leaves_them_out(void **state) {
  (void)state;
  double wanted = measure("law=none T=0.02 gap=-0.1", "height");
  near(measure("law=barrier T=0.02 gap=-0.1", "height"), wanted, 1e-6, "barrier"); /* 20 steps of another method */
}

static void what_contact_of_a_joint_may_be(void **state) {
  (void)state;
#define BODY "local s = hooke.scene { duration = 1 } local b = s:rigid { shape = 'sphere', radius = 1, mass = 1 }\n"
  test_refused(BODY "s:joint { kind = 'ball', a = b, at = {0, 0, 1}, contact = true } return s", "", 1,
               "it is for two bodies, and b is none");
  test_refused(BODY "s:joint { kind = 'ball', a = b, b = s:rigid { shape = 'sphere', radius = 1, mass = 1, position = "
                    "{0, 0, 2} }, at = {0, 0, 1}, contact = 'yes' } return s",
               "", 1, "contact: expected true or false, got a text");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_a_joint_joins_moves_as_without_contact),
      cmocka_unit_test(with_contact_its_bodies_meet),
      cmocka_unit_test(others_are_met),
      cmocka_unit_test(the_barrier_leaves_them_out),
      cmocka_unit_test(what_contact_of_a_joint_may_be),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
