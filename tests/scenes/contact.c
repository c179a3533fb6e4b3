/* Scenes of contact whose end is known. */
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
  test_scene(&r, scene, options);
  assert_true(test_json(r.out, "intersections") == 0);
}

static double measure(const char *name) { return test_json(strstr(r.out, "\"measures\""), name); }

/* The middle of the topmost of three sheets is 2.5 thicknesses above the floor; sheets are apart by their thickness to
 * the corrector's tolerance, and sag between their particles by less than a hundredth of that. */
static void a_stack_is_as_high_as_its_sheets(void **state) {
  (void)state;
  run("stack", "sheets=3 N=7 --until 0.4");
  assert_true(fabs(measure("height of the stack") / (2.5 * 8e-3) - 1) < 0.01);
}

/* Pairs lean by 20 degrees: their feet stand from mu = tan(20)/2 = 0.18 on where nothing lies on them, and from less
 * than tan(20) = 0.36 on below any load. The house sinks by some millimetres as its cards bend, and by some centimetres
 * in 0.2 s where feet slide; from 0.5346 m, two storeys of 0.28 cos(20) m and two thicknesses. */
static void a_house_of_cards_stands_by_friction(void **state) {
  (void)state;
  run("card_house", "--until 0.2 --dt 8e-5");
  double standing = measure("height");
  run("card_house", "friction=0.05 --until 0.2 --dt 8e-5");
  assert_true(standing > 0.52 && measure("height") < 0.5);
}

/* It falls by g (t - 1 + exp(-t)) against drag of 1/s until it meets the net at 0.5 m, which sags by its weight but
 * lets nothing through: a tube of 0.055 m would hang by more than its width below where one slipped past a thread. */
static void a_knot_falls_and_a_net_holds_it(void **state) {
  (void)state;
  run("knot_in_net", "n=60 around=8 meshes=5 --until 0");
  double start = measure("lowest");
  run("knot_in_net", "n=60 around=8 meshes=5 --until 0.1");
  assert_true(fabs(start - measure("lowest") - 9.81 * (0.1 - 1 + exp(-0.1))) < 1e-4);
  run("knot_in_net", "n=60 around=8 meshes=5 --until 0.5 --trust");
  double lowest = measure("lowest");
  if (!(lowest > 0.28 && lowest < 0.49)) fail_msg("the lowest point is at %g m", lowest);
}

/* Contacts that land change from sticking to sliding and back. Where they were as stiff at once as those that rest,
 * Newton's iteration and the steps that were halved for it took 34,353 evaluations of the forces, and 769 now. */
static void a_stack_lands_by_the_barrier_in_few_iterations(void **state) {
  (void)state;
  run("stack", "N=8 sheets=3 contact=barrier --integrator bdf2 --dt 0.00833333 --until 0.2 --no-check");
  assert_true(test_json(r.out, "force_evaluations") < 2000);
}

static const char card[] =
    "local s = hooke.scene { duration = 0.5, fps = 60, integrator = 'bdf2' }\n"
    "local card = s:grid { nx = 4, ny = 4, width = 0.1, height = 0.1, mass = 0.01, origin = { 0, 0, 0.012 },\n"
    "  u = { 1, 0, 0 }, v = { 0, 1, 0 } }\n"
    "s:force('gravity', { g = { 4, 0, -8.96 }, only = card:ids() })\n"
    "s:force('springs', { edges = card:structural() .. card:shear(), k = 50, damping = 0.05 })\n"
    "local floor = s:mesh { vertices = { { -5, -5, 0 }, { 5, -5, 0 }, { 5, 5, 0 }, { -5, 5, 0 } },\n"
    "  faces = { { 1, 2, 3 }, { 1, 3, 4 } }, mass = 1 }\n"
    "s:pin(floor:ids())\n"
    "s:force('barrier', { thickness = 0.004, friction = 0.6, d_hat = 5e-4 })\n"
    "s:measure('way', function(state)\n"
    "  local sum = 0\n"
    "  for _, id in ipairs(card:ids()) do sum = sum + state:position(id)[1] / 16 end\n"
    "  return sum\n"
    "end)\n"
    "return s\n";

static double way_until(double t) {
  char arguments[256];
  test_write("card.lua", card);
  snprintf(arguments, sizeof arguments, "run card.lua --until %g --json --quiet --no-check --no-output", t);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0) fail_msg("%s: exit %d: %s%s", arguments, r.code, r.out, r.err);
  return measure("way");
}

/* A card that falls a centimetre onto a slope of tan = 0.45 at mu = 0.6 slides a little, and then rests: by a law of
 * velocities it would creep with a part of the speed below which that smooths. Newton's tolerance is 1e-6 of a step's
 * change of speed, 1e-7 m/s, at most. */
static void what_has_landed_on_a_slope_rests(void **state) {
  (void)state;
  double early = way_until(0.3), late = way_until(0.5);
  print_message("%.3g m, and %.1e m more\n", early - 0.05, late - early);
  assert_true(early > 0.05 + 1e-4 && fabs(late - early) < 0.2 * 1e-7);
}

static const char sled[] =
    "local slip = param('slip', 2.5e-7)\n"
    "local s = hooke.scene { duration = 0.3, fps = 60, integrator = 'bdf2' }\n"
    "local card = s:grid { nx = 4, ny = 4, width = 0.1, height = 0.1, mass = 0.01, origin = { 0, 0, 0.00435 },\n"
    "  u = { 1, 0, 0 }, v = { 0, 1, 0 } }\n"
    "s:force('gravity', { only = card:ids() })\n"
    "s:force('springs', { edges = card:structural() .. card:shear(), k = 50, damping = 0.05 })\n"
    "local floor = s:mesh { vertices = { { -5, -5, 0 }, { 5, -5, 0 }, { 5, 5, 0 }, { -5, 5, 0 } },\n"
    "  faces = { { 1, 2, 3 }, { 1, 3, 4 } }, mass = 1 }\n"
    "s:pin(floor:ids(), { path = function(t) return 2 * math.max(t - 0.1, 0)^2, 0, 0 end })\n"
    "s:force('barrier', { thickness = 0.004, friction = 0.2, d_hat = 5e-4, elastic_slip = slip })\n"
    "return s\n";

static double missed_with(const char *slip) {
  char arguments[256];
  snprintf(arguments, sizeof arguments, "run sled.lua slip=%s --json --quiet --no-output", slip);
  test_hooke(&r, NULL, arguments);
  return test_json(r.out, "friction_missed");
}

/* A floor at rest starts at 4 m/s^2, twice what friction of mu = 0.2 can give the card on it, which slides back by
 * (4 - 0.2 g)/2 t^2 = 4.1 cm in 0.2 s. Friction that begins after 0.1 mm misses a part of 0.1 mm/4.1 cm, less what the
 * first step covers of it: more than the thousandth that a run may miss. */
static void friction_that_comes_late_is_not_ok(void **state) {
  (void)state;
  test_write("sled.lua", sled);
  double at_once = missed_with("2.5e-7");
  assert_int_equal(r.code, 0);
  double late = missed_with("1e-4"), part = 1e-4 / ((4 - 0.2 * 9.81) / 2 * 0.04);
  print_message("%.2g of its work missed, and %.2g\n", at_once, late);
  assert_true(r.code == 5 && strstr(r.out, "friction_missed is") && strstr(r.out, "try a smaller elastic_slip"));
  assert_true(at_once < 1e-3 && late > 0.5 * part && late < 1.1 * part);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_stack_is_as_high_as_its_sheets),
      cmocka_unit_test(a_house_of_cards_stands_by_friction),
      cmocka_unit_test(a_knot_falls_and_a_net_holds_it),
      cmocka_unit_test(a_stack_lands_by_the_barrier_in_few_iterations),
      cmocka_unit_test(what_has_landed_on_a_slope_rests),
      cmocka_unit_test(friction_that_comes_late_is_not_ok),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
