/* Welds: two strands joined at their ends, a particle that hangs on a moving pin, offsets, closed loops of welds. */
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

static void run(const char *options) {
  char arguments[1024];
  snprintf(arguments, sizeof arguments, "run %s/scene.lua --json --quiet --no-output %s", test_folder(), options);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0) fail_msg("%s: exit %d: %s%s", options, r.code, r.err, r.out);
}

static void near(const char *key, double wanted, double tolerance) {
  double got = test_json(strstr(r.out, "\"measures\""), key);
  if (!(fabs(got - wanted) <= tolerance)) fail_msg("%s is %.17g, not %.17g +- %g", key, got, wanted, tolerance);
}

/* Two strands of springs whose ends start in one place are one strand: the weight of the lower one hangs on the weld,
 * and the motion is that of a strand whose particle in the middle has the mass of both. Rounding, grown over 400 steps.
 */
static void two_strands_welded_at_their_ends_are_one(void **state) {
  (void)state;
  test_write(
      "scene.lua",
      "local welded = param('welded', 1, '')\n"
      "local scene = hooke.scene { duration = 1, fps = 10, integrator = 'leapfrog', dt = 1 / 400 }\n"
      "local ids, edges = {}, {}\n"
      "for k = 0, 8 do\n"
      "  ids[k] = scene:particle { position = { 0.1 * k, 0, 0 }, mass = k == 4 and welded == 0 and 0.02 or 0.01 }\n"
      "  if k > 0 then edges[k] = { ids[k - 1], ids[k] } end\n"
      "end\n"
      "if welded == 1 then\n"
      "  local twin = scene:particle { position = { 0.4, 0, 0 }, mass = 0.01 }\n"
      "  edges[5] = { twin, ids[5] }\n"
      "  scene:constraint('weld', { edges = { { ids[4], twin } } })\n"
      "end\n"
      "scene:pin { ids[0] }\n"
      "scene:force('gravity')\n"
      "scene:force('springs', { edges = edges, k = 50, rest = 0.1, damping = 0.01 })\n"
      "for c = 1, 3, 2 do scene:measure('end' .. c, function(s) return s:position(ids[8])[c] end) end\n"
      "return scene\n");
  run("welded=0");
  double x = test_json(strstr(r.out, "\"measures\""), "end1"), z = test_json(strstr(r.out, "\"measures\""), "end3");
  run("welded=1");
  near("end1", x, 1e-11);
  near("end3", z, 1e-11);
}

/* A pin on a circle carries two particles welded to it: they go with it at their offsets, and the welds bear the weight
 * and m a, a = w^2 r towards the middle. Leapfrog and implicit methods alike, for the path's speed is given. */
static void what_is_welded_to_a_moving_pin_goes_with_it(void **state) {
  (void)state;
  test_write("scene.lua",
             "local r, w = 0.5, 3\n"
             "local scene = hooke.scene { duration = 0.9, fps = 10, dt = 1 / 200 }\n"
             "local pin = scene:particle { position = { 0.5, 0, 0 } }\n"
             "local a = scene:particle { position = { 0.5, 0.2, -0.1 }, mass = 2, velocity = { 0, r * w, 0 } }\n"
             "local b = scene:particle { position = { 0.5, 0, 0 }, mass = 3, velocity = { 0, r * w, 0 } }\n"
             "scene:pin({ pin }, { path = function(t)\n"
             "  local c, s = math.cos(w * t), math.sin(w * t)\n"
             "  return r * (c - 1), r * s, 0, -r * w * s, r * w * c, 0\n"
             "end })\n"
             "scene:force('gravity')\n"
             "scene:constraint('weld', { edges = { { pin, a }, { pin, b } } })\n"
             "scene:measure('x', function(s) return s:position(a)[1] - r * math.cos(w * s.t) end)\n"
             "scene:measure('y', function(s) return s:position(a)[2] - r * math.sin(w * s.t) end)\n"
             "scene:measure('z', function(s) return s:position(a)[3] end)\n"
             "scene:measure('v', function(s) return s:velocity(b)[1] + r * w * math.sin(w * s.t) end)\n"
             "scene:measure('fx', function(s) return s:force('weld', a)[1] / math.cos(w * s.t) end)\n"
             "scene:measure('fz', function(s) return s:force('weld', a)[3] end)\n"
             "return scene\n");
  static const char *const methods[] = {"leapfrog", "rk4", "implicit_midpoint", "bdf2", "dopri5"};
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    char option[64];
    snprintf(option, sizeof option, "--integrator %s", methods[k]);
    run(option);
    near("x", 0, 1e-12);
    near("y", 0.2, 1e-12);
    near("z", -0.1, 1e-12);
    near("v", 0, 1e-11);
    near("fx", -2 * 9 * 0.5, 1e-6); /* differences of the path's velocity */
    near("fz", 2 * 9.81, 1e-12);
  }
}

/* A stated offset that is not that of the start pulls the pair there, by their masses: 1 kg and 3 kg. Momentum stays.
 */
static void an_offset_is_reached_by_the_masses(void **state) {
  (void)state;
  test_write("scene.lua", "local scene = hooke.scene { duration = 0.1, fps = 10, dt = 0.1 }\n"
                          "local a = scene:particle { position = { 0, 0, 0 }, velocity = { 1, 0, 0 }, mass = 1 }\n"
                          "local b = scene:particle { position = { 1, 2, 0 }, velocity = { 0, 1, 0 }, mass = 3 }\n"
                          "scene:constraint('weld', { edges = { { a, b } }, dx = 0, dy = { 0 }, dz = 0.4 })\n"
                          "for c = 1, 3 do scene:measure('x' .. c, function(s) return s:position(a)[c] end) end\n"
                          "for c = 1, 3 do scene:measure('v' .. c, function(s) return s:velocity(b)[c] end) end\n"
                          "return scene\n");
  run("");
  near("x1", 0.75 + 0.1 * 0.25, 1e-14);
  near("x2", 1.5 + 0.1 * 0.75, 1e-14);
  near("x3", -0.3, 1e-14);
  near("v1", 0.25, 1e-14);
  near("v2", 0.75, 1e-14);
  near("v3", 0, 1e-14);
}

/* Three welds in a triangle are three equations too many, which is no error. */
static void a_loop_of_welds_holds(void **state) {
  (void)state;
  test_write("scene.lua", "local scene = hooke.scene { duration = 0.5, fps = 10, dt = 0.01 }\n"
                          "local a = scene:particle { position = { 0, 0, 0 } }\n"
                          "local b = scene:particle { position = { 1, 0, 0 }, mass = 2 }\n"
                          "local c = scene:particle { position = { 0, 1, 0 }, mass = 5 }\n"
                          "scene:force('gravity', { g = { 0, 0, -10 } })\n"
                          "scene:pin { a }\n"
                          "scene:constraint('weld', { edges = { { a, b }, { b, c }, { c, a } } })\n"
                          "scene:measure('z', function(s) return s:position(c)[3] end)\n"
                          "scene:measure('on a', function(s) return s:force('weld', a)[3] end)\n"
                          "return scene\n");
  run("");
  near("z", 0, 1e-12);
  near("on a", -70, 1e-10);
}

/* The oldest particle of the scene dies again and again, and with it its weld: the others keep their own differences.
 */
static void welds_follow_deaths(void **state) {
  (void)state;
  char script[2048];
  snprintf(
      script, sizeof script,
      "local scene = hooke.scene { duration = 0.45, fps = 20, dt = 0.05 }\n"
      "local pairs = {}\n"
      "for k = 1, 4 do\n"
      "  local a = scene:particle { position = { k, 0, 0 }, mass = k, velocity = { 0, k, 0 } }\n"
      "  pairs[k] = { a, (scene:particle { position = { k, 0.1 * k, 0.2 * k }, mass = 1, velocity = { 0, k, 0 } }) }\n"
      "end\n"
      "scene:force('gravity')\n"
      "scene:constraint('weld', { edges = pairs, dx = { 0, 0, 0, 0.5 } })\n"
      "scene:source('%s/tests/fixtures/spout.so', { every = 0.1, lifetime = 0.1 })\n"
      "scene:measure('n', function(s) return s.n end)\n"
      "for c = 1, 3 do\n"
      "  scene:measure('d' .. c, function(s) return s:position(pairs[4][2])[c] - s:position(pairs[4][1])[c] end)\n"
      "end\n"
      "scene:measure('dead', function(s) return pcall(s.position, s, 1) and 0 or 1 end)\n"
      "return scene\n",
      HK_BUILD);
  test_write("scene.lua", script);
  run("--trust");
  near("dead", 1, 0);
  near("d1", 0.5, 1e-13);
  near("d2", 0.4, 1e-13);
  near("d3", 0.8, 1e-13);
}

/* Welds to two pins that are not at the offset contradict each other. */
static void contradicting_welds_are_an_error(void **state) {
  (void)state;
  test_refused("local scene = hooke.scene { duration = 0.5, fps = 10, dt = 0.01 }\n"
               "local a = scene:particle { position = { 0, 0, 0 } }\n"
               "local b = scene:particle { position = { 1, 0, 0 } }\n"
               "local c = scene:particle { position = { 0, 1, 0 } }\n"
               "scene:pin { a, b }\n"
               "scene:constraint('weld', { edges = { { a, c }, { b, c } }, dx = 0, dy = 0, dz = 0 })\n"
               "return scene\n",
               "--quiet", 3, "bad.lua:6: weld");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(two_strands_welded_at_their_ends_are_one),
      cmocka_unit_test(what_is_welded_to_a_moving_pin_goes_with_it),
      cmocka_unit_test(an_offset_is_reached_by_the_masses),
      cmocka_unit_test(a_loop_of_welds_holds),
      cmocka_unit_test(welds_follow_deaths),
      cmocka_unit_test(contradicting_welds_are_an_error),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
