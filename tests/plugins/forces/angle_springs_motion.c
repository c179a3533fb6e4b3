/* Chains that bend, in runs: the same rest with every way of solving, angles in a plane and in space; a ring that
 * swings without losing momenta or energy. */
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

static void run(const char *scene, const char *options) {
  char arguments[400];
  test_write("bend.lua", scene);
  snprintf(arguments, sizeof arguments, "run bend.lua --json --quiet %s", options);
  test_hooke(&r, NULL, arguments);
  /* 5: not accurate as a motion, which is not asked for where a scene comes to rest */
  if (r.code != 0 && r.code != 5) fail_msg("%s: exit %d: %s", options, r.code, r.err);
}

/* A thick cantilever, EA L^2/EI = 2500, so that methods that go from element to element come to rest in seconds. */
static const char cantilever[] =
    "local scene = hooke.scene { duration = 2, fps = 60, dt = 1/60, integrator = 'backward_euler' }\n"
    "local r, plane = 4e-2, param('plane', false)\n"
    "local s = scene:strand { n = 10, direction = { 1, 0, 0 }, clamped = true, radius = r, mass = 1 / 9.81,\n"
    "  E = 4 / (math.pi * r ^ 4) }\n"
    "scene:force('springs', { edges = s:edges(), k = s.stiffness })\n"
    "scene:force('angle_springs', { edges = s:edges(), EI = s.EI, rest = 0, normal = plane and { 0, 1, 0 } or nil })\n"
    "scene:force('gravity')\nscene:force('drag', { rate = 10 })\n"
    "scene:measure('drop', function(state) return -state:position(s:at(10))[3] end)\nreturn scene\n";

/* Newton's rest is exact; xpbd's and the local and global iterations' stop where a step changes little (drag of 10/s
 * leaves exp(-10) of the first swing, which is 5e-6, too). */
static void every_way_of_solving_comes_to_the_same_rest(void **state) {
  (void)state;
  static const char *const ways[] = {"plane=true",
                                     "--integrator implicit_midpoint",
                                     "--integrator bdf2",
                                     "--solver banded",
                                     "--solver pcg",
                                     "--solver umfpack",
                                     "--integrator xpbd:substeps=100,iterations=4",
                                     "--integrator local_global:iterations=100"};
  run(cantilever, "");
  double rest = test_json(r.out, "drop");
  assert_true(fabs(rest - 0.12536) < 5e-5); /* 8 segments: 0.1234714 (1 + 1/64), less what the rest of order 4 is */
  for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
    run(cantilever, ways[k]);
    if (!(fabs(test_json(r.out, "drop") - rest) < 1e-4)) fail_msg("%s: %g m", ways[k], test_json(r.out, "drop"));
  }
}

/* A free ring of rest curvature, bent and thrown: leapfrog keeps the momenta to rounding and the energy to (w h)^2. */
static void a_free_ring_keeps_its_momenta(void **state) {
  (void)state;
  run("local scene = hooke.scene { duration = 1, fps = 10, integrator = 'leapfrog', dt = 5e-4 }\n"
      "local points, velocities, edges, n = {}, {}, {}, 24\n"
      "for k = 1, n do local a = 2 * math.pi * k / n\n"
      "  points[k] = { math.cos(a), 0.6 * math.sin(a), 0.2 * math.sin(3 * a) }\n"
      "  velocities[k] = { math.sin(2 * a), 1, math.cos(a) } edges[k] = { k, k % n + 1 } end\n"
      "scene:particles { positions = points, velocities = velocities, mass = 1 / n }\n"
      "scene:force('springs', { edges = edges, k = 500 })\n"
      "scene:force('angle_springs', { edges = edges, EI = 1, rest = 0.2 })\n"
      "local function sum(f) return function(s) local all = 0\n"
      "  for k = 1, n do all = all + f(s:position(k), s:velocity(k)) / n end return all end end\n"
      "scene:measure('p', sum(function(_, v) return v[2] end))\n"
      "scene:measure('L', sum(function(x, v) return x[2] * v[3] - x[3] * v[2] end))\n"
      "local L = 0\nfor k = 1, n do local x, v = points[k], velocities[k] L = L + (x[2] * v[3] - x[3] * v[2]) / n end\n"
      "scene:measure('L at first', function() return L end)\n"
      "scene:measure('E', function(s) return s:energy() end)\nlocal E\n"
      "scene:measure('drift', function(s) E = E or s:energy() return s:energy() / E - 1 end)\nreturn scene\n",
      "");
  assert_true(fabs(test_json(r.out, "p") - 1) < 1e-12); /* 2,000 steps of some roundings */
  assert_true(fabs(test_json(r.out, "L") - test_json(r.out, "L at first")) < 1e-12);
  assert_true(fabs(test_json(r.out, "drift")) < 1e-3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_way_of_solving_comes_to_the_same_rest),
      cmocka_unit_test(a_free_ring_keeps_its_momenta),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
