/* Stacks of boxes, of which the corners of the faces are solved: they lie still, bear their weight, and stand or fall
 * by where their centres are. What Newton's iteration leaves is a millionth of half of the thickness, 1e-9 m, and 5e-7
 * m/s in steps of 2 ms; the limits are ten times that. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static test_result r;

static double found(const char *measure, double within) {
  double value = test_json(r.out, measure);
  print_message("%s: %.3g, at most %.1g\n", measure, value, within);
  if (!(fabs(value) <= within)) fail_msg("%s: %.17g is above %g", measure, value, within);
  return value;
}

/* `boxes` calls box(x, z) for the places of boxes of 0.2 m; the thickness is 2 mm. */
static void run(double duration, const char *boxes) {
  char scene[4096];
  snprintf(
      scene, sizeof scene,
      "local scene = hooke.scene { duration = %g, fps = 50, dt = 2e-3, integrator = 'leapfrog' }\n"
      "local B, from, a, t = {}, {}, 0.2, 2e-3\n"
      "local function box(x, z)\n"
      "  local b = scene:rigid { shape = 'box', size = a, mass = 4, position = {x, 0, z} }\n"
      "  b:surface() B[#B + 1] = b from[#B] = {x, 0, z}\nend\n"
      "%s\n"
      "scene:body { shape = 'box', size = {8, 2, 0.2}, position = {0, 0, -0.1} }\n"
      "scene:force('gravity', { g = {0, 0, -9.81} })\n"
      "scene:corrector('contact', { thickness = t, friction = 0.5 })\n"
      "local function most(f) return function(s) local m = 0 for k, b in ipairs(B) do for c = 1, 3 do m = math.max(m, "
      "math.abs(f(b, s, k)[c])) end end return m end end\n"
      "scene:measure('shift', most(function(b, s, k) local x = b:position(s); for c = 1, 3 do x[c] = x[c] - from[k][c] "
      "end return x end))\n"
      "scene:measure('speed', most(function(b, s) return b:velocity(s) end))\n"
      "return scene\n",
      duration, boxes);
  test_write("stack.lua", scene);
  test_hooke(&r, NULL, "run stack.lua --json --quiet --no-output");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  assert_true(test_json(r.out, "intersections") == 0);
}

static void a_tower_lies_still_and_bears_its_weight(void **state) {
  (void)state;
  run(0.06, "for k = 1, 6 do box(0, (a + t) * (k - 0.5)) end");
  found("shift", 1e-8);
  found("speed", 5e-6);
  double weight = 4 * 9.81 * 0.06 * (6 * 7 / 2.0); /* N s: of all that each contact bears */
  if (!(fabs(test_json(r.out, "impulse") - weight) < 1e-5 * weight)) fail_msg("%g N s", test_json(r.out, "impulse"));
}

static void a_pyramid_lies_still(void **state) {
  (void)state;
  run(0.04, "for k = 1, 3 do for j = 1, 4 - k do box((j + (k - 1) / 2) * 1.05 * a, (a + t) * (k - 0.5)) end end");
  found("shift", 1e-8);
  found("speed", 5e-6);
}

/* The second box of a stack is off by 1/2 of its side and a little, or not quite that. */
static void a_box_beyond_the_edge_falls(void **state) {
  (void)state;
  run(0.1, "box(0, (a + t) / 2) box(0.499 * a, 1.5 * (a + t))");
  found("shift", 1e-8);
  run(0.1, "box(0, (a + t) / 2) box(0.51 * a, 1.5 * (a + t))");
  if (!(test_json(r.out, "shift") > 1e-5)) fail_msg("it stays to %g m", test_json(r.out, "shift"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_tower_lies_still_and_bears_its_weight),
      cmocka_unit_test(a_pyramid_lies_still),
      cmocka_unit_test(a_box_beyond_the_edge_falls),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
