/* Bodies that a joint joins, or constraints hold at one place, do not meet each other, whatever the kind and the plugin
 * of contact, unless the joint says so; what they would meet otherwise, they meet. */
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
    "local function ends(on_a, on_b) return { { a:point { on_a, 0, 0 }, b:point { on_b, 0, 0 } } } end\n"
    "if kind == 'point' then it.kind, it.b, it.axis = 'ball', a:point { 0.5 + gap / 2, 0, 0 }, nil end\n"
    "if kind == 'line' then it.kind, it.b, it.at, it.axis = 'distance', a:point { 0, 0, 0 }, { 1.5, 0, 2 }, nil end\n"
    "if kind == 'weld' then scene:constraint('weld', { edges = ends(0.5 + gap / 2, -0.5 - gap / 2) })\n"
    "elseif kind == 'bars' then scene:constraint('bars', { edges = ends(0.5, -0.5 - gap / 2) })\n"
    "elseif kind == 'long' then scene:constraint('bars', { edges = ends(0, 0) })\n"
    "elseif kind == 'cables' then scene:constraint('cables', { edges = ends(0.5, -0.5 - gap / 2), length = 1 })\n"
    "elseif kind == 'shared' then\n"
    "  local p = scene:particle { position = it.at, mass = 1 }\n"
    "  scene:joint { kind = 'ball', a = a, b = p } scene:joint { kind = 'ball', a = b, b = p }\n"
    "else scene:joint(it) end\n"
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

/* Whatever constraint holds points of two bodies nearer than the thickness, here 1 mm: a joint with a point, a weld, a
 * bar of half of it, a particle that both hold, whose contact with them is left out with it. A joint with a point may
 * hold it at any distance. */
static void what_constraints_join_moves_as_without_contact(void **state) {
  (void)state;
  const char *kind[] = {"point", "line", "weld", "bars", "shared"};
  for (size_t k = 0; k < 5; k++) {
    char options[128];
    double wanted[2];
    snprintf(options, sizeof options, "kind=%s law=none", kind[k]);
    wanted[0] = measure(options, "height"), wanted[1] = test_json(r.out, "tilt");
    snprintf(options, sizeof options, "kind=%s", kind[k]);
    near(measure(options, "height"), wanted[0], 1e-11, options);
    near(test_json(r.out, "tilt"), wanted[1], 1e-11, options);
    assert_true(test_json(r.out, "intersections") == 0);
  }
}

/* Bodies that start within each other are refused, unless they do not meet. */
static void what_is_held_far_or_not_held_meets(void **state) {
  (void)state;
  const char *options[] = {"kind=long gap=-0.1", "kind=cables gap=-0.1", "kind=point gap=-0.1 meet=yes"};
  for (size_t k = 0; k < 3; k++) {
    run(options[k]);
    if (r.code != 1 || !strstr(r.err, "intersect at the start")) fail_msg("%s: %d: %s", options[k], r.code, r.err);
  }
}

/* A box hangs from a thread whose end is `within` its top face; a ball that flies into the box beside the thread's end
 * meets it. */
static const char hung[] =
    "local within, law, ball = param('within', 0, ''), param('law', 'contact', ''), param('ball', false, '')\n"
    "local scene = hooke.scene { duration = 0.1, fps = 50, dt = 1e-3, integrator = 'leapfrog' }\n"
    "local box = scene:rigid { shape = 'box', size = {0.1, 0.1, 0.1}, mass = 1, position = {0, 0, within - 0.05}, "
    "spin = {3, 0, 0} }\n"
    "local thread = scene:strand { n = 5, from = {0, 0, 0.4}, to = {0, 0, 0}, mass = 0.1 }\n"
    "scene:pin { thread:at(1) }\n"
    "scene:force('springs', { edges = thread:structural(), k = 1e3 })\n"
    "scene:joint { kind = 'ball', a = box, b = thread:at(5) }\n"
    "scene:force('gravity', { g = {0, 0, -9.81} })\n"
    "if law ~= 'none' then box:surface() scene:corrector(law, { thickness = 1e-3, radius = 1e-3 }) end\n"
    "if ball then scene:particle { position = {0.2, 0, -0.05}, velocity = {-2, 0, 0}, mass = 1 } end\n"
    "scene:measure('height', function(s) return box:position(s)[3] end)\n"
    "scene:measure('speed', function(s) return box:velocity(s)[1] end)\n"
    "return scene\n";

static double hang(const char *options, const char *name) {
  char command[256];
  test_write("hung.lua", hung);
  snprintf(command, sizeof command, "run hung.lua --json --quiet --no-output --no-check %s", options);
  test_hooke(&r, NULL, command);
  if (r.code != 0) fail_msg("%s: exit %d: %s%s", options, r.code, r.err, r.out);
  return test_json(r.out, name);
}

static void a_body_and_a_particle_that_it_holds_do_not_meet(void **state) {
  (void)state;
  double wanted = hang("law=none", "height");
  near(hang("", "height"), wanted, 1e-11, "at the face");
  near(hang("within=0.01", "height") - 0.01, hang("within=0.01 law=none", "height") - 0.01, 1e-11, "within");
  assert_true(hang("ball=true", "speed") < -0.1);
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
               "there is no b: leave it out");
  test_refused(BODY "s:joint { kind = 'ball', a = b, b = s:rigid { shape = 'sphere', radius = 1, mass = 1, position = "
                    "{0, 0, 2} }, at = {0, 0, 1}, contact = 'yes' } return s",
               "", 1, "contact: expected true or false, got a text");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_a_joint_joins_moves_as_without_contact),
      cmocka_unit_test(what_constraints_join_moves_as_without_contact),
      cmocka_unit_test(what_is_held_far_or_not_held_meets),
      cmocka_unit_test(a_body_and_a_particle_that_it_holds_do_not_meet),
      cmocka_unit_test(with_contact_its_bodies_meet),
      cmocka_unit_test(others_are_met),
      cmocka_unit_test(the_barrier_leaves_them_out),
      cmocka_unit_test(what_contact_of_a_joint_may_be),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
