/* Scenes of what melts: numbers that are known, and what has to happen. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static test_result r;

/* The link of 2 g starts at 270 K and takes 0.002 (2100 x 3.15 + 333600) J = 680 J until nothing of it holds, of which
 * 0.6 W come from the air: with 500 W 1.36 s, and the fall by three links, 0.1 s, is seen at the next frame. */
static void a_chain_of_ice_fails_when_its_link_has_molten(void **state) {
  (void)state;
  test_scene(&r, "ice_chain", "--until 1.6 --trust");
  double broke = test_json(r.out, "broke");
  if (!(broke > 1.36 && broke < 1.52)) fail_msg("it broke at %g s", broke);
  test_scene(&r, "ice_chain", "--until 1.6 --trust power=100");
  assert_true(test_json(r.out, "broke") == 0);
}

/* Without the lamp it stands; with it the head, a quarter of the figure, melts and the highest place sinks. */
static void a_figure_of_wax_stands_until_it_melts(void **state) {
  (void)state;
  test_scene(&r, "wax_figure", "power=0 --until 0.01");
  double start = test_json(r.out, "height");
  test_scene(&r, "wax_figure", "power=0 --until 0.25");
  double cold = test_json(r.out, "height");
  assert_true(test_json(r.out, "molten") == 0);
  test_scene(&r, "wax_figure", "power=80000 --until 0.25");
  double hot = test_json(r.out, "height");
  if (!(cold > start - 1e-3 && hot < cold - 0.01 && test_json(r.out, "molten") > 0.2))
    fail_msg("%g m, %g m, %g m", start, cold, hot);
}

/* What runs over a cold ball sets on it, over a warm one nothing does; all heat that leaves it is on the account: its
 * enthalpy of 0.05 kg x 64 kJ/kg at the start, to the rounding of an implicit step. */
static void chocolate_sets_on_what_is_cold(void **state) {
  (void)state;
  test_scene(&r, "chocolate", "cell=0.008 --until 0.01");
  double start = test_json(r.out, "balance");
  test_scene(&r, "chocolate", "cell=0.008 --until 0.4");
  double set = test_json(r.out, "set"), balance = test_json(r.out, "balance");
  test_scene(&r, "chocolate", "cell=0.008 cold=318 --until 0.4");
  double warm = test_json(r.out, "set");
  if (!(set > 0.1 && warm == 0 && fabs(balance / start - 1) < 1e-9))
    fail_msg("set %g, %g; %.12g J, %.12g J", set, warm, start, balance);
}

/* A sheet of ice holds its lantern, and lets it and what is molten fall where a burner is; the conduction keeps the
 * enthalpy to rounding, 1e-12 (the verdict takes 1e-6). Without the burner nothing falls. */
static void a_sheet_of_ice_melts_and_lets_go(void **state) {
  (void)state;
  test_scene(&r, "ice_sheet", "n=9 --until 1.2");
  double fallen = test_json(r.out, "fallen"), height = test_json(r.out, "lantern");
  if (!(fallen > 0 && height < 0.05)) fail_msg("%g fell, the lantern is at %g m", fallen, height);
  test_scene(&r, "ice_sheet", "n=9 burner=0 --until 1.2");
  assert_true(test_json(r.out, "fallen") == 0 && test_json(r.out, "lantern") > 0.12);
}

/* Ice rises in water, and melts; nobody gives or takes heat, so the sum of 5 x 10^5 J stays, to the rounding of an
 * implicit step. */
static void a_cube_of_ice_rises_and_melts(void **state) {
  (void)state;
  test_scene(&r, "ice_cube", "cell=0.02 --until 0.01");
  double heat = test_json(r.out, "heat"), ice = test_json(r.out, "ice"), height = test_json(r.out, "height");
  test_scene(&r, "ice_cube", "cell=0.02 --until 0.4");
  double left = test_json(r.out, "ice"), rose = test_json(r.out, "height") - height;
  if (!(fabs(test_json(r.out, "heat") / heat - 1) < 1e-9 && left < 0.9 * ice && left > 0 && rose > 0.005))
    fail_msg("%g of %g kg are left, it rose by %g m", left, ice, rose);
}

/* Damp sand stands beside shallow water and is taken by a wave; the water's content is kept to rounding. */
static void a_wave_takes_a_sand_castle(void **state) {
  (void)state;
  test_scene(&r, "sand_castle", "cell=0.04 --until 0.01");
  double water = test_json(r.out, "balance");
  test_scene(&r, "sand_castle", "cell=0.04 --until 0.5");
  double taken = test_json(r.out, "standing");
  assert_true(fabs(test_json(r.out, "balance") / water - 1) < 1e-9);
  test_scene(&r, "sand_castle", "cell=0.04 wave=0.04 --until 0.5");
  double calm = test_json(r.out, "standing");
  if (!(calm > 0.95 && taken < 0.9)) fail_msg("%g stand, and %g", calm, taken);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_chain_of_ice_fails_when_its_link_has_molten),
      cmocka_unit_test(a_figure_of_wax_stands_until_it_melts),
      cmocka_unit_test(chocolate_sets_on_what_is_cold),
      cmocka_unit_test(a_sheet_of_ice_melts_and_lets_go),
      cmocka_unit_test(a_cube_of_ice_rises_and_melts),
      cmocka_unit_test(a_wave_takes_a_sand_castle),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
