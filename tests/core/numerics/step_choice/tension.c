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

/* A rope of bars under gravity along it that rises with t^2, and is 0 at first. Its shortest waves have the frequency
 * 2 sqrt(T/(m l)) = 2 n sqrt(g/L) where it is held: leapfrog's limit at the end of the run is 1/(n sqrt(g/L)). The
 * waves are a little slower over the whole length (6 %), and the limit has headroom (5 % of the frequency's square). */
static void tension_that_rises_slowly_shortens_the_step(void **state) {
  (void)state;
  test_write("scene.lua", "local scene = hooke.scene { duration = 1, fps = 60, integrator = 'leapfrog' }\n"
                          "local s = scene:strand { n = 21, from = { 0, 0, 0 }, to = { 1, 0, 0 }, mass = 1 }\n"
                          "scene:pin { s:at(1) }\n"
                          "scene:force('gravity', { g = function(t) return { 500 * t * t, 0, 0 } end })\n"
                          "scene:constraint('bars', { edges = s:structural() })\n"
                          "return scene\n");
  runs("");
  double limit = test_json(r.out, "dt_limit"), wanted = 1 / (20 * sqrt(500));
  if (!(limit > 0.95 * wanted && limit < 1.06 * wanted)) fail_msg("the limit is %g s, not %g s", limit, wanted);
}

/* A rope of bars at rest, whose free end is struck by a body 100 times as heavy: there is no motion before, and the end
 * then turns about the other at more than its 50 m/s. */
static void an_impact_shortens_the_step_at_once(void **state) {
  (void)state;
  test_write("scene.lua", "local scene = hooke.scene { duration = 0.2, fps = 60, integrator = 'leapfrog' }\n"
                          "local s = scene:strand { n = 21, from = { 0, 0, 0 }, to = { 1, 0, 0 }, mass = 0.2 }\n"
                          "scene:pin { s:at(1) }\n"
                          "scene:constraint('bars', { edges = s:structural() })\n"
                          "scene:particle { position = { 1, 0, -5 }, velocity = { 0, 0, 50 }, mass = 1 }\n"
                          "scene:corrector('contact', { radius = 0.02, restitution = 1 })\n"
                          "return scene\n");
  runs("");
  assert_true(test_json(r.out, "dt_min") < 0.1 * test_json(r.out, "dt_max"));
  double drift = fabs(test_json(r.out, "drift"));
  if (!(drift < 0.01)) fail_msg("the energy drifts by %g", drift);
}

/* A cloth of undamped springs that hangs by two corners, beside a chain of bars: what stiffens as its edges turn into
 * one direction is followed as it is without the chain, where the energy drifts by 1e-5. */
static void what_forces_state_is_followed_beside_constraints(void **state) {
  (void)state;
  test_write("scene.lua", "local scene = hooke.scene { duration = 0.3, fps = 60, integrator = 'leapfrog' }\n"
                          "local g = scene:grid { nx = 20, ny = 20, width = 1, height = 1, mass = 0.05 }\n"
                          "scene:pin { g:at(1, 1), g:at(20, 1) }\n"
                          "scene:force('gravity')\n"
                          "scene:force('springs', { edges = g:edges(), k = 20 })\n"
                          "local s = scene:strand { n = 4, from = { 2, 0, 0 }, to = { 2.3, 0, 0 }, mass = 0.3 }\n"
                          "scene:pin { s:at(1) }\n"
                          "scene:constraint('bars', { edges = s:structural() })\n"
                          "return scene\n");
  runs("");
  double drift = fabs(test_json(r.out, "drift"));
  if (!(drift < 1e-3)) fail_msg("the energy drifts by %g", drift);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_heavy_end_is_let_go_from_the_horizontal),
      cmocka_unit_test(tension_that_rises_slowly_shortens_the_step),
      cmocka_unit_test(an_impact_shortens_the_step_at_once),
      cmocka_unit_test(what_forces_state_is_followed_beside_constraints),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
