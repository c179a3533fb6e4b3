/* Many impacts of rigid bodies at once: a pyramid lies still that sweeps alone leave in motion. */
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

static void run(double duration, const char *joined) {
  static char scene[4096];
  snprintf(scene, sizeof scene,
           "local a, thick, N = 0.1, 2e-3, 8\n"
           "local scene = hooke.scene { duration = %g, fps = 500, dt = 2e-3, integrator = 'leapfrog' }\n"
           "scene:force('gravity', { g = {0, 0, -9.81} })\n"
           "scene:body { shape = 'box', size = {4, 2, 0.2}, position = {0, 0, -0.1} }\n"
           "local list = {}\n"
           "for k = 1, N do for j = 1, N + 1 - k do\n"
           "  local b = scene:rigid { shape = 'box', size = a, mass = 1, position = {(j + k / 2) * 1.05 * a, 0, "
           "(a + thick) * (k - 0.5) } }\n"
           "  b:surface()\n  list[#list + 1] = b\n"
           "end end\n%s"
           "scene:corrector('contact', { thickness = thick, friction = 0.5 })\n"
           "scene:measure('speed', function(s) local most = 0\n"
           "  for _, b in ipairs(list) do for c = 1, 3 do most = math.max(most, math.abs(b:velocity(s)[c])) end end\n"
           "  return most end)\n"
           "return scene\n",
           duration, joined);
  test_write("pyramid.lua", scene);
  test_hooke(&r, NULL, "run pyramid.lua --json --quiet --no-output");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  assert_true(test_json(r.out, "intersections") == 0);
}

/* 144 impacts with three unknowns each. 1e-5 of the tolerance of speeds, 1e-5 of the thickness a step, is 1e-10 m/s. */
static void a_pyramid_of_thirty_six_lies_still(void **state) {
  (void)state;
  run(0.012, "");
  double speed = test_json(r.out, "speed"), factors = test_json(r.out, "factorizations");
  print_message("speed %.3g m/s, %g factorisations\n", speed, factors);
  assert_true(speed < 1e-10);
}

/* A step begins from the impulses of the last one, which are those of this one but for what programs leave: it takes
 * one round, or none, for places and for speeds, where the first step takes dozens. */
static void a_pyramid_at_rest_needs_few_factors(void **state) {
  (void)state;
  run(0.012, "");
  double first = test_json(r.out, "factorizations");
  run(0.024, "");
  double more = test_json(r.out, "factorizations") - first;
  print_message("%g factorisations of 6 steps, %g of 6 more\n", first, more);
  assert_true(first > 20 && more <= 3 * 6);
}

/* A body on a joint does not answer as a free one does, and is left to the other solution. */
static void a_box_on_a_joint_stays_on_it(void **state) {
  (void)state;
  run(0.012, "scene:joint { kind = 'ball', a = list[#list], at = {0.525, 0, 0.9} }\n");
  assert_true(strstr(r.out, "\"verdict\":\"ok\"") != NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_pyramid_of_thirty_six_lies_still),
      cmocka_unit_test(a_pyramid_at_rest_needs_few_factors),
      cmocka_unit_test(a_box_on_a_joint_stays_on_it),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
