/* Rolling and spinning friction of rigid bodies on each other and on what is pinned, against closed forms. */
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

static void run(double duration, const char *text) {
  static char scene[8192];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = %g, fps = 50, integrator = 'leapfrog', dt = 2e-3 }\n"
           "local abs, g, R, rho, sigma = math.abs, 9.81, 0.1, 2e-3, 1e-3\n"
           "local function measure(name, f) scene:measure(name, f) end\n"
           "%s\nreturn scene\n",
           duration, text);
  test_write("rolls.lua", scene);
  test_hooke(&r, NULL, "run rolls.lua --json --quiet --no-output");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
}

static void small(const char *measure, double within) {
  double found = test_json(r.out, measure);
  print_message("%s: %.3g, at most %.1g\n", measure, found, within);
  if (!(fabs(found) <= within)) fail_msg("%s: %.17g is above %g", measure, found, within);
}

static const char on_a_floor[] =
    "scene:body { shape = 'box', size = {6, 6, 0.2}, position = {0, 0, -0.1} }\n"
    "scene:force('gravity', { g = {0, 0, -g} })\n"
    "local function ball(v, w) local b = scene:rigid { shape = 'sphere', radius = R, mass = 2, position = {0, 0, R}, "
    "velocity = {v, 0, 0}, spin = {0, v / R, w} }; b:surface { {0, 0, 0} }; return b end\n"
    "scene:corrector('contact', { radius = R, friction = 0.5, rolling = rho, spinning = sigma })\n";

static void on_floor(double duration, const char *text) {
  char all[2048];
  snprintf(all, sizeof all, "%s%s", on_a_floor, text);
  run(duration, all);
}

/* It slows down by 5/7 rho g/R, and its spin about the normal by 5/2 sigma g/R^2, in steps of order 3. */
static void a_ball_is_slowed_by_rolling_and_spinning_friction(void **state) {
  (void)state;
  on_floor(0.5, "local b = ball(1, 6)\n"
                "measure('speed', function(s) return b:velocity(s)[1] - 1 + 5 / 7 * rho * g / R * s.t end)\n"
                "measure('spin', function(s) return b:spin(s)[3] - 6 + 5 / 2 * sigma * g / R^2 * s.t end)");
  small("speed", 1e-8);
  small("spin", 2e-7);
}

/* At v^2/(2 5/7 rho g/R) it rests, but for the step in which it stops: (a h)^2/a. */
static void a_ball_rolls_to_rest(void **state) {
  (void)state;
  on_floor(0.5, "local b = ball(0.05, 0)\n"
                "measure('way', function(s) return b:position(s)[1] - 0.05^2 / (2 * 5 / 7 * rho * g / R) end)\n"
                "measure('speed', function(s) return b:velocity(s)[1] end)");
  small("way", 1e-6);
  small("speed", 1e-9);
}

/* What the moments take from the spin of one ball they give to the other, where the line of their centres is the axis.
 */
static void two_balls_share_the_spin_about_their_normal(void **state) {
  (void)state;
  run(0.3,
      "local a = scene:rigid { shape = 'sphere', radius = R, mass = 1, position = {-0.15, 0, 0}, velocity = {1, 0, "
      "0}, spin = {9, 0, 0} }\n"
      "local b = scene:rigid { shape = 'sphere', radius = R, mass = 1, position = {0.1, 0, 0} }\n"
      "a:surface { {0, 0, 0} } b:surface { {0, 0, 0} }\n"
      "scene:corrector('contact', { radius = R, friction = 0.5, spinning = sigma })\n"
      "measure('sum', function(s) return a:spin(s)[1] + b:spin(s)[1] - 9 end)\n"
      "measure('given', function(s) return b:spin(s)[1] - 0.5 * sigma / (0.4 * R^2) end)");
  small("sum", 1e-12);
  small("given", 1e-9);
}

/* A ball that stands on a turning table of triangles is turned by it until it spins as fast. */
static void a_table_that_turns_takes_a_ball_along(void **state) {
  (void)state;
  run(0.4,
      "scene:body { shape = 'cylinder', radius = 0.5, length = 0.2, position = {0, 0, -0.1}, rotation = function(t) "
      "return 0, 0, 3 * t end }\n"
      "scene:force('gravity', { g = {0, 0, -g} })\n"
      "local b = scene:rigid { shape = 'sphere', radius = R, mass = 2, position = {0, 0, R} }\n"
      "b:surface { {0, 0, 0} }\n"
      "scene:corrector('contact', { radius = R, friction = 0.5, spinning = 5e-3 })\n"
      "measure('spin', function(s) return b:spin(s)[3] - 3 end)");
  small("spin", 1e-6);
}

/* Bodies with radii of their own, whatever that of contact. A capsule on its side that slides rolls at v/(1 + I/(m
 * R^2)), I about its axis; a box with round edges lies on its faces. */
static const char shapes[] =
    "scene:body { shape = 'box', size = {6, 6, 0.2}, position = {0, 0, -0.1} }\n"
    "scene:force('gravity', { g = {0, 0, -g} })\n"
    "local ball = scene:rigid { shape = 'sphere', radius = 0.05, mass = 2, position = {0, 0, 0.05}, velocity = {1, 0, "
    "0} }\n"
    "ball:surface({ {0, 0, 0} }, { radius = 0.05 })\n"
    "local pill = scene:rigid { shape = 'capsule', radius = R, length = 0.4, mass = 2, position = {0, 1, R}, velocity "
    "= "
    "{1, 0, 0}, orientation = {math.pi / 2, 0, 0} }\n"
    "local ends = pill:surface({ {0, 0, -0.2}, {0, 0, 0.2} }, { radius = R, joined = true })\n"
    "local box = scene:rigid { shape = 'box', size = 0.2, mass = 2, position = {0, -1, 0.1} }\n"
    "box:surface { radius = 0.03 }\n"
    "local I = math.min(table.unpack(pill.inertia))\n"
    "measure('ball', function(s) return ball:velocity(s)[1] - 5 / 7 end)\n"
    "measure('pill', function(s) return pill:velocity(s)[1] - 1 / (1 + I / (2 * R^2)) end)\n"
    "measure('box', function(s) return box:position(s)[3] - 0.1 end)\n"
    "measure('sinks', function(s) return ball:position(s)[3] - 0.05 + pill:position(s)[3] - R end)\n";

static void expect_shapes(void) {
  small("ball", 1e-7);
  small("pill", 1e-6);
  small("box", 1e-6);
  small("sinks", 1e-6);
}

static void round_bodies_have_radii_of_their_own(void **state) {
  char text[4096];
  (void)state;
  snprintf(text, sizeof text, "%sscene:corrector('contact', { friction = 0.3 })\n", shapes);
  run(0.3, text);
  expect_shapes();
  assert_true(test_json(r.out, "intersections") == 0);
}

/* The same radii hold against obstacles, which take what edges name. */
static void obstacles_know_the_radii(void **state) {
  char text[4096];
  (void)state;
  snprintf(text, sizeof text, "%sscene:corrector('obstacle', { friction = 0.3, edges = { ends } })\n",
           strchr(shapes, '\n') + 1);
  run(0.3, text);
  expect_shapes();
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_ball_is_slowed_by_rolling_and_spinning_friction),
      cmocka_unit_test(a_ball_rolls_to_rest),
      cmocka_unit_test(two_balls_share_the_spin_about_their_normal),
      cmocka_unit_test(a_table_that_turns_takes_a_ball_along),
      cmocka_unit_test(round_bodies_have_radii_of_their_own),
      cmocka_unit_test(obstacles_know_the_radii),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
