/* Scenes of rigid bodies, each with numbers that are known. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static test_result r;

static void near(const char *key, double wanted, double tolerance) {
  double got = test_json(r.out, key);
  if (!(fabs(got - wanted) <= tolerance)) fail_msg("%s: %.17g is not within %g of %.17g", key, got, tolerance, wanted);
}

/* The capsule of the bar and the cylinder of the stem, by their exact integrals; energy and angular momentum are those
 * of a spin of 6 rad/s about the stem, up to the wobble of 1e-2, and do not change. After half of the time between two
 * flips it is the other way round. */
static void the_handle_turns_over(void **state) {
  (void)state;
  test_scene(&r, "t_handle", "--until 0");
  double energy = test_json(r.out, "kinetic energy"), L = test_json(r.out, "angular momentum");
  near("spin", 6, 1e-12);
  if (!(fabs(2 * energy / L - 6) < 6e-3)) fail_msg("2 E/L is %g", 2 * energy / L);
  double least = 6;
  for (int k = 1; k < 12; k++) {
    char options[40];
    snprintf(options, sizeof options, "--until %g", k / 3.0);
    test_scene(&r, "t_handle", options);
    near("kinetic energy", energy, 1e-11 * energy);
    near("angular momentum", L, 1e-11 * L);
    least = fmin(least, test_json(r.out, "spin"));
  }
  if (!(least < -5)) fail_msg("the least spin is %g", least);
}

/* A fast top goes round at m g l/L up to terms of the order of (rate/spin) and of its nod: 3 % here. */
static void the_gyroscope_goes_round(void **state) {
  (void)state;
  test_scene(&r, "gyroscope", "duration=3");
  near("rate", 1, 0.03);
  if (!(test_json(r.out, "height") > 0.45)) fail_msg("it has fallen to %g m", test_json(r.out, "height"));
}

/* Each pushes the next one over; what rubs and lands takes energy, and nothing passes. */
static void the_dominoes_fall(void **state) {
  (void)state;
  test_scene(&r, "dominoes", "n=2 duration=0.1");
  double before = test_json(r.out, "energy of the row");
  near("fallen", 0, 0);
  test_scene(&r, "dominoes", "n=2 duration=0.5");
  near("fallen", 2, 0);
  near("intersections", 0, 0);
  if (!(test_json(r.out, "energy of the row") < before))
    fail_msg("the energy is %g of %g J", test_json(r.out, "energy of the row"), before);
}

/* Friction alone holds the wall until the ball comes; then bricks leave their places, and energy goes. */
static void the_ball_breaks_the_wall(void **state) {
  (void)state;
  test_scene(&r, "bricks", "rows=2 columns=1 duration=0.1 --until 0.04 speed=0");
  near("displaced", 0, 0);
  test_scene(&r, "bricks", "rows=2 columns=1 --until 0");
  double before = test_json(r.out, "energy of the bricks");
  test_scene(&r, "bricks", "rows=2 columns=1 duration=0.12");
  near("intersections", 0, 0);
  if (!(test_json(r.out, "displaced") >= 1)) fail_msg("%g bricks are displaced", test_json(r.out, "displaced"));
  if (!(test_json(r.out, "energy of the bricks") < before)) fail_msg("the energy rises from %g J", before);
}

/* 5/7 of 6 m/s at 0.87 s, before the first pin; then something falls, and nothing passes. */
static void the_bowling_ball_rolls_and_hits(void **state) {
  (void)state;
  test_scene(&r, "bowling", "rows=1 duration=1.1");
  near("slip", 0, 1e-6);
  near("intersections", 0, 0);
  if (!(test_json(r.out, "fallen") == 1)) fail_msg("the pin stands");
  test_scene(&r, "bowling", "rows=1 speed=3 duration=0.6");
  near("slip", 0, 1e-9);
  near("speed of the ball", 3 * 5 / 7.0, 1e-6);
}

static void balls_go_round_on_the_turntable(void **state) {
  (void)state;
  test_scene(&r, "turntable", "duration=1");
  near("rate", 1, 1e-6);
  near("off", 0, 1e-7);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_handle_turns_over),
      cmocka_unit_test(the_gyroscope_goes_round),
      cmocka_unit_test(the_dominoes_fall),
      cmocka_unit_test(the_ball_breaks_the_wall),
      cmocka_unit_test(the_bowling_ball_rolls_and_hits),
      cmocka_unit_test(balls_go_round_on_the_turntable),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
