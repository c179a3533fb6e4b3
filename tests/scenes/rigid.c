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

/* Without the ball's blow each brick stays on those below: all of them, and the ball, are where they touch. */
static void the_wall_stands(void **state) {
  (void)state;
  const double g = 9.81, brick = 1800 * 0.24 * 0.115 * 0.07, ball = 3000 * 4 / 3.0 * 3.14159265358979 * 1e-3;
  test_scene(&r, "bricks", "rows=2 columns=1 duration=0.6 speed=0");
  near("energy of the bricks", g * (brick * (0.036 + 0.108) + ball * 0.101), 0.02);
}

/* Half of a period after the first ball is let go (of a pendulum of 0.2828 m from 0.6 rad) the last one is as high, up
 * to the gaps; two lift two; what each of four impacts leaves of the speed is (1 + e)/2. */
static void the_cradle_hands_on(void **state) {
  (void)state;
  test_scene(&r, "cradle", "--until 0.5457");
  double energy = test_json(r.out, "energy of the balls");
  near("angle of the last", 0.6, 1e-3);
  near("angle of the first", 0, 1e-4);
  test_scene(&r, "cradle", "--until 0");
  near("energy of the balls", energy, 1e-8 * energy);
  test_scene(&r, "cradle", "lifted=2 --until 0.5457");
  near("angle of the last", 0.6, 1e-3);
  near("angle of the next", 0.6, 1e-3);
  test_scene(&r, "cradle", "restitution=0.9 --until 0.5457");
  near("angle of the last", acos(1 - (1 - cos(0.6)) * pow(0.95, 8)), 1e-3);
}

/* The ball keeps its energy until it hits; then the wall falls, and the chain holds. At half the step all three bricks
 * are displaced, too, and the ball is slower by 9e-5 m/s (two rows show none or two by the step). */
static void the_wrecking_ball_breaks_the_wall(void **state) {
  (void)state;
  test_scene(&r, "wrecking_ball", "rows=2 columns=1 links=2 duration=0.36");
  near("displaced", 0, 0);
  if (!(test_json(r.out, "speed of the ball") > 2.5)) fail_msg("%g m/s", test_json(r.out, "speed of the ball"));
  test_scene(&r, "wrecking_ball", "rows=3 columns=1 links=2 duration=0.6");
  near("displaced", 3, 0);
  near("speed of the ball", 2.1865, 1e-3);
  near("intersections", 0, 0);
  near("constraint_violation", 0, 1e-10);
}

/* Of the closed form for a centre at rest; what the corners of the ring take falls as their number, and rolling takes
 * more. */
static void the_disc_goes_round_faster(void **state) {
  (void)state;
  test_scene(&r, "euler_disc", "n=200 rolling=0 --until 0.02");
  near("rate", 1, 0.015);
  test_scene(&r, "euler_disc", "n=40 rolling=0 --until 0");
  double first = test_json(r.out, "energy of the disc");
  test_scene(&r, "euler_disc", "n=40 rolling=0 duration=0.2");
  double lost = first - test_json(r.out, "energy of the disc");
  near("rate", 1, 0.06);
  test_scene(&r, "euler_disc", "n=80 rolling=0 duration=0.2");
  double less = first - test_json(r.out, "energy of the disc"), lean = test_json(r.out, "lean");
  near("rate", 1, 0.06);
  if (!(less > 0 && less < 0.65 * lost)) fail_msg("%g J of 80 corners, %g J of 40", less, lost);
  test_scene(&r, "euler_disc", "n=80 rolling=2e-3 duration=0.2");
  if (!(test_json(r.out, "lean") < 0.7 * lean)) fail_msg("leans by %g and %g rad", test_json(r.out, "lean"), lean);
}

/* One half of a pin's distance a swing, at the amplitude it began with; the period is the pendulum's own to what an
 * escapement whose impulse lies about the middle leaves of it (Airy 1830). */
static void the_escapement_ticks_with_its_pendulum(void **state) {
  (void)state;
  test_scene(&r, "escapement", "duration=4");
  near("intersections", 0, 0);
  near("swings", 8, 0);
  near("slips", 0, 0);
  near("amplitude", 0.106, 2e-3);
  near("period", test_json(r.out, "free period"), 5e-4);
}

/* It falls, no knee and no elbow bends the wrong way, and nothing passes. */
static void the_figure_falls_down_the_stairs(void **state) {
  (void)state;
  test_scene(&r, "ragdoll", "steps=2 duration=0.6");
  near("beyond", 0, 1e-9);
  near("intersections", 0, 0);
  if (!(test_json(r.out, "height") < 0.9)) fail_msg("the chest is at %g m", test_json(r.out, "height"));
}

/* Without wind what leans is the line at the outer pegs, by its sag over a sixth of its length. */
static void the_pegs_hold_the_washing(void **state) {
  (void)state;
  test_scene(&r, "washing_line", "sheets=1 N=5 duration=0.5 speed=0");
  near("peg", 0, 0.1);
  near("constraint_violation", 0, 1e-10);
  test_scene(&r, "washing_line", "sheets=1 N=5 duration=0.5");
  if (!(test_json(r.out, "peg") > 0.5)) fail_msg("the wind turns the pegs by %g rad", test_json(r.out, "peg"));
  near("constraint_violation", 0, 1e-10);
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
      cmocka_unit_test(the_wall_stands),
      cmocka_unit_test(the_cradle_hands_on),
      cmocka_unit_test(the_wrecking_ball_breaks_the_wall),
      cmocka_unit_test(the_disc_goes_round_faster),
      cmocka_unit_test(the_escapement_ticks_with_its_pendulum),
      cmocka_unit_test(the_figure_falls_down_the_stairs),
      cmocka_unit_test(the_pegs_hold_the_washing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
