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

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_stack_is_as_high_as_its_sheets),
      cmocka_unit_test(a_house_of_cards_stands_by_friction),
      cmocka_unit_test(a_knot_falls_and_a_net_holds_it),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
