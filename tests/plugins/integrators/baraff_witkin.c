/* What is Baraff and Witkin's own: altered positions, filtered gradients, and steps that follow the stretch of
 * triangles.
 */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static test_result r;

/* A mass on a spring of length 0, which is linear, whose other end is moved along a curve: by the altered positions the
 * step is backward Euler with the place where the end will be, which is written out beside it. */
static const char driven[] =
    "local h, k, m = 0.01, 400, 0.5\n"
    "local scene = hooke.scene { duration = 0.3, fps = 1 / h, dt = h, "
    "integrator = { 'baraff_witkin', solve = '%s', stretch = 1e9 } }\n"
    "local function path(t) return 0.1 * math.sin(30 * t) + 0.02 * math.floor(t / 0.05 + 1e-6) end\n"
    "local a = scene:particle { position = { 0, 0, 0 } }\n"
    "local b = scene:particle { position = { 0.05, 0, 0 }, mass = m }\n"
    "scene:pin({ a }, { path = function(t) return path(t), 0, 0 end })\n"
    "scene:force('springs', { edges = { { a, b } }, k = k, rest = 0 })\n"
    "local x, v, off, steps = 0.05, 0, 0, 0\n"
    "scene:on_frame(function(s)\n"
    "  if s.t > 0 then\n"
    "    v = (v - h * k / m * (x - path(s.t))) / (1 + h * h * k / m)\n"
    "    x, steps = x + h * v, steps + 1\n"
    "  end\n"
    "  off = math.max(off, math.abs(s:position(b)[1] - x))\n"
    "end)\n"
    "scene:measure('off', function() return off end)\n"
    "scene:measure('seen', function() return steps end)\n"
    "return scene\n";

static void neighbours_know_where_pins_will_be(void **state) {
  (void)state;
  static const char *const solve[] = {"solver", "filtered"};
  for (int k = 0; k < 2; k++) {
    char scene[4096];
    snprintf(scene, sizeof scene, driven, solve[k]);
    test_write("driven.lua", scene);
    test_hooke(&r, NULL, "run driven.lua --json --quiet");
    assert_true(test_json(r.out, "seen") == 29);  /* before the last frame */
    assert_true(test_json(r.out, "off") < 1e-13); /* of 0.2 m: rounding of 30 steps, and of pi's multiples */
  }
}

/* A sheet of membrane and hinges that hangs: both ways to solve the equations are one method. */
static const char hanging[] = "local scene = hooke.scene { duration = 0.2, fps = 50, dt = 0.01, "
                              "integrator = { 'baraff_witkin', solve = '%s'%s } }\n"
                              "local c = scene:grid { nx = 9, ny = 9, density = 0.2, alternating = true }\n"
                              "scene:pin { c:at(1, 9), c:at(9, 9) }\n"
                              "scene:pin({ c:at(5, 9) }, { axes = { 1, 2, 0 } })\n"
                              "scene:force('membrane', { stiffness = 50, damping = 0.001 })\n"
                              "scene:force('hinges', { rigidity = 1e-4 })\n"
                              "scene:force('gravity')\n"
                              "scene:measure('low', function(s) return s:position(c:at(5, 1))[3] end)\n"
                              "scene:measure('slide', function(s)\n"
                              "  local p = s:position(c:at(5, 9))\n"
                              "  return math.abs(p[2] - 1 - 2 * (p[1] - 0.5)) + math.abs(p[3])\n"
                              "end)\n"
                              "return scene\n";

static double hang(const char *solve, const char *more, const char *what) {
  char scene[4096];
  snprintf(scene, sizeof scene, hanging, solve, more);
  test_write("hanging.lua", scene);
  test_hooke(&r, NULL, "run hanging.lua --json --quiet");
  return test_json(r.out, what);
}

static void both_solutions_are_one_method(void **state) {
  (void)state;
  double direct = hang("solver", "", "low"), filtered = hang("filtered", ", tolerance = 1e-12", "low");
  assert_true(direct < -0.05);
  assert_true(fabs(direct - filtered) < 1e-9); /* 1e-12 of steps of 1 mm, 20 of them, grown by the swing */
  assert_true(hang("filtered", "", "slide") < 1e-14);
}

/* The strain of this sheet changes by some hundredths in a step of 0.01 s: where it may change by 0.002 alone, there
 * are several times as many steps. */
static void steps_follow_the_stretch_of_triangles(void **state) {
  (void)state;
  assert_true(hang("solver", ", stretch = 100", "steps") < 25); /* 20 and the ends of some frames */
  assert_true(hang("solver", ", stretch = 0.002", "steps") > 60);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(neighbours_know_where_pins_will_be),
      cmocka_unit_test(both_solutions_are_one_method),
      cmocka_unit_test(steps_follow_the_stretch_of_triangles),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
