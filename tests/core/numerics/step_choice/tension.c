/* Steps of leapfrog that are chosen where constraints' forces rise during the run: they stiffen what they hold, by
 * T/(m l) for a bar of the length l under the tension T with the mass m at its end, and nothing states it. */
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

static void runs(const char *options) {
  char arguments[1024];
  snprintf(arguments, sizeof arguments, "run scene.lua --json --no-output %s", options);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0) fail_msg("%s: exit %d: %s%s", options, r.code, r.err, r.out);
  assert_non_null(strstr(r.out, "\"verdict\":\"ok\""));
}

/* Rods with a body at their end, 1e6 times as heavy as a rod, let go from the horizontal: there is no tension at first,
 * and 3 M g at the lowest point. The rods' lengths, 0.1 m, are kept to 1e-12 of the whole. */
static void a_heavy_end_is_let_go_from_the_horizontal(void **state) {
  (void)state;
  test_write("scene.lua", "local n = param('n', 5, '')\n"
                          "local scene = hooke.scene { duration = 0.15, fps = 60, integrator = 'leapfrog' }\n"
                          "scene:force('gravity')\n"
                          "local before\n"
                          "for k = 1, n do\n"
                          "  local rod = scene:rigid { shape = 'box', size = { 0.1, 0.02, 0.02 }, mass = 0.1,\n"
                          "    position = { 0.1 * k - 0.05, 0, 0 } }\n"
                          "  scene:joint { kind = 'hinge', a = rod, b = before, at = { 0.1 * (k - 1), 0, 0 },\n"
                          "    axis = { 0, 1, 0 } }\n"
                          "  before = rod\n"
                          "end\n"
                          "local ball = scene:rigid { shape = 'sphere', radius = 0.05, mass = 1e5,\n"
                          "  position = { 0.1 * n, 0, 0 } }\n"
                          "scene:joint { kind = 'hinge', a = ball, b = before, at = { 0.1 * n, 0, 0 },\n"
                          "  axis = { 0, 1, 0 } }\n"
                          "return scene\n");
  const char *of[] = {"n=5", "n=10"};
  for (size_t k = 0; k < 2; k++) {
    runs(of[k]);
    assert_true(test_json(r.out, "constraint_violation") < 1e-12 * 0.5);
    double drift = fabs(test_json(r.out, "drift"));
    if (!(drift < 1e-6)) fail_msg("%s: the energy drifts by %g", of[k], drift);
  }
}

/* The ends of a rope of bars along x, 20 of them, l = 0.05 m and m = 0.01 kg, whose other end is fixed, and what pulls:
 * a force that rises as T = P (t/s)^2, so that the rope is slack at first. Its shortest waves have the frequency
 * 2 sqrt(T/(m l)): leapfrog's limit at the end of the run is the inverse, sqrt(m l/T). */
static void tension_that_rises_slowly_shortens_the_step(void **state) {
  (void)state;
  test_write("scene.lua", "local scene = hooke.scene { duration = 1, fps = 60, integrator = 'leapfrog' }\n"
                          "local ids, edges = {}, {}\n"
                          "for k = 0, 20 do\n"
                          "  ids[k] = scene:particle { position = { 0.05 * k, 1e-9 * k % 3, 0 }, mass = 0.01 }\n"
                          "  if k > 0 then edges[k] = { ids[k - 1], ids[k] } end\n"
                          "end\n"
                          "scene:pin { ids[0] }\n"
                          "scene:force('pull', { particles = { ids[20] }, force = function(t)\n"
                          "  return { 5000 * t * t, 0, 0 } end })\n"
                          "scene:constraint('bars', { edges = edges })\n"
                          "return scene\n");
  runs("");
  double limit = test_json(r.out, "dt_limit"), wanted = sqrt(0.01 * 0.05 / 5000);
  if (!(limit > 0.8 * wanted && limit < 1.1 * wanted)) fail_msg("the limit is %g s, not %g s", limit, wanted);
}

/* The same rope at rest, whose end is struck after 0.1 s: its speed of 50 m/s is the first motion at all, and the end
 * turns about the other with the tension m v^2/R and more. */
static void an_impact_shortens_the_step_at_once(void **state) {
  (void)state;
  test_write("scene.lua",
             "local scene = hooke.scene { duration = 0.2, fps = 60, integrator = 'leapfrog' }\n"
             "local ids, edges = {}, {}\n"
             "for k = 0, 20 do\n"
             "  ids[k] = scene:particle { position = { 0.05 * k, 0, 0 }, mass = 0.01 }\n"
             "  if k > 0 then edges[k] = { ids[k - 1], ids[k] } end\n"
             "end\n"
             "scene:pin { ids[0] }\n"
             "scene:constraint('bars', { edges = edges })\n"
             "local hammer = scene:particle { position = { 1, 0, -5 }, velocity = { 0, 0, 50 }, mass = 1 }\n"
             "scene:corrector('contact', { radius = 0.02, thickness = 0.02, restitution = 1 })\n"
             "return scene\n");
  runs("");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_heavy_end_is_let_go_from_the_horizontal),
      cmocka_unit_test(tension_that_rises_slowly_shortens_the_step),
      cmocka_unit_test(an_impact_shortens_the_step_at_once),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
