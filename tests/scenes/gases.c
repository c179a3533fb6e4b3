/* Scenes of gases, of grains and on grids: numbers that are known, and what has to happen. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static test_result r;

static void near(double found, double wanted, double tolerance) {
  if (!(fabs(found - wanted) <= tolerance)) fail_msg("%.17g instead of %.17g", found, wanted);
}

/* T^(-1/2) grows by 1/tau a second. Measured by some 8,000 collisions, 1 %; they last 1.6 ms of the 16 ms between two
 * of them at first, which Enskog's rate of hard discs leaves out, and discs that have met fly alongside: up to 10 %
 * less. Without the collisions across the faces it is 0.18. */
static void a_granular_gas_cools_by_haffs_law(void **state) {
  (void)state;
  test_scene(&r, "granular_gas", "n=900 stiffness=2000 restitution=0.9 --until 0.3 --trust");
  near(test_json(r.out, "haff"), 0.95, 0.1);
  assert_true(test_json(r.out, "momentum_drift") < 1e-13); /* rounding */
}

/* A tracer in the smoke, 0.25 m high, goes up the side of the ball, which is from 0.47 to 0.77 m high; without warmth
 * the smoke is heavier than air, and it sinks. */
static void a_plume_passes_a_ball(void **state) {
  (void)state;
  test_scene(&r, "plume", "cell=0.1 --until 2");
  assert_true(test_json(r.out, "height") > 0.55);
  assert_true(test_json(r.out, "divergence_left") < 1e-6 &&
              test_json(r.out, "divergence_left") > 0); /* its tolerance */
  assert_true(test_json(r.out, "courant") > 0.01 && test_json(r.out, "courant") <= 2);
  test_scene(&r, "plume", "cell=0.1 warm=0 --until 0.5");
  assert_true(test_json(r.out, "height") < 0.25);
}

/* A wall that moves into a box without an opening leaves the gas no room: 30 % of it is lost, without a word of its
 * pressure, which has no solution. With an open top it goes out. */
static void a_gas_that_has_no_way_out_is_not_ok(void **state) {
  (void)state;
  static const char piston[] =
      "local scene = hooke.scene { duration = 1, fps = 20, dt = 0.02, integrator = 'symplectic_euler' }\n"
      "scene:particle { position = { 0.5, 0, 0.93 }, mass = 1e-3 }\n"
      "scene:corrector('obstacle', { shape = 'box', size = { 1, 4, 4 },\n"
      "  position = function(t) return -0.5 + 0.3 * t, 0, 0.5 end })\n"
      "scene:corrector('gas', { low = { 0, 0, 0 }, high = { 1, 0, 1 }, cell = 0.05, open = param('open', 'none', '') "
      "})\n"
      "return scene\n";
  char words[512];
  snprintf(words, sizeof words, "run %s --json --no-output --no-check", test_write("piston.lua", piston));
  test_hooke(&r, NULL, words);
  assert_int_equal(r.code, 5);
  assert_true(test_json(r.out, "swelled") > 0.25); /* -log(1 - 0.3) if all cells lose the same */
  snprintf(words, sizeof words, "run %s --json --no-output --no-check open=top", test_write("piston.lua", piston));
  test_hooke(&r, NULL, words);
  assert_int_equal(r.code, 0);
  assert_true(test_json(r.out, "swelled") < 1e-3); /* tolerance, 1e-6 a step, of 60 */
}

/* The vapour comes with 1200 K, and is hotter where it burns: by 1400 K at most. */
static void a_candle_burns(void **state) {
  (void)state;
  test_scene(&r, "candle", "cell=0.008 --until 0.1");
  double hot = test_json(r.out, "hottest");
  test_scene(&r, "candle", "cell=0.008 rate=0 --until 0.1");
  double cold = test_json(r.out, "hottest");
  if (!(hot > cold + 20 && hot < 2600 && cold <= 1200)) fail_msg("%.0f K with and %.0f K without fire", hot, cold);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_granular_gas_cools_by_haffs_law),
      cmocka_unit_test(a_plume_passes_a_ball),
      cmocka_unit_test(a_gas_that_has_no_way_out_is_not_ok),
      cmocka_unit_test(a_candle_burns),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
