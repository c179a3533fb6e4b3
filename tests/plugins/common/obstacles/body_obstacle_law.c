/* Rigid bodies on obstacles, by the points of their surface, against closed forms. Where the law of impact is exact at
 * the instant of landing, rounding is left; what rolls has order 2, also where the normal turns. */
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

/* Runs a scene of 9.81 m/s^2, with the body b. */
static void run(double duration, double dt, const char *body, const char *rest) {
  static char scene[8192];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = %g, fps = 20, integrator = 'leapfrog', dt = %g }\n"
           "local sin, cos, abs, sqrt, g = math.sin, math.cos, math.abs, math.sqrt, 9.81\nlocal b = scene:rigid %s\n"
           "local function measure(name, f) scene:measure(name, f) end\n"
           "local function fall() scene:force('gravity', { g = {0, 0, -g} }) end\n%s\nreturn scene\n",
           duration, dt, body, rest);
  test_write("bodies.lua", scene);
  test_hooke(&r, NULL, "run bodies.lua --json --quiet --no-output");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  assert_non_null(strstr(r.out, "\"warnings\":[]"));
}

static void small(const char *measure, double within) {
  double found = test_json(r.out, measure);
  print_message("%s: %.3g, at most %.1g\n", measure, found, within);
  if (!(fabs(found) <= within)) fail_msg("%s: %.17g is above %g", measure, found, within);
}

/* Between the first and the second bounce. */
static void a_box_that_falls_flat_rises_by_the_square_of_e(void **state) {
  (void)state;
  run(0.5, 1e-3, "{ shape = 'box', size = {0.2, 0.3, 0.2}, mass = 2, position = {0, 0, 0.6} }",
      "b:surface() fall()\nscene:corrector('obstacle', { shape = 'plane', restitution = 0.5, friction = 0.4 })\n"
      "local first = math.sqrt(2 * 0.5 / g)\n"
      "measure('off', function(s) local t = s.t - first; return b:position(s)[3] - 0.1 - 0.5 * g * first * t + g / 2 * "
      "t^2 end)\nmeasure('turn', function(s) local w = b:spin(s) return abs(w[1]) + abs(w[2]) + abs(w[3]) end)");
  small("off", 1e-12);
  small("turn", 1e-11);
}

/* Friction at x - R n: v falls and the spin rises until they meet at 5/7 of v, and then nothing rubs. */
static double rolls(double dt) {
  run(1.5, dt, "{ shape = 'sphere', radius = 0.1, mass = 2, position = {0, 0, 0.1}, velocity = {1, 0, 0} }",
      "b:surface { {0, 0, 0} } fall()\nscene:corrector('obstacle', { shape = 'plane', friction = 0.2, radius = 0.1 })\n"
      "measure('speed', function(s) return b:velocity(s)[1] - 5 / 7 end)\n"
      "measure('slip', function(s) return b:velocity(s)[1] - 0.1 * b:spin(s)[2] end)\n"
      "measure('aside', function(s) local w, v = b:spin(s), b:velocity(s); return abs(w[1]) + abs(w[3]) + abs(v[2]) + "
      "abs(v[3]) end)");
  small("slip", 1e-12);
  small("aside", 1e-12);
  return test_json(r.out, "speed");
}

static void a_ball_that_slides_rolls_at_five_sevenths(void **state) {
  (void)state;
  double long_steps = rolls(2e-3), short_steps = rolls(1e-3);
  print_message("off 5/7 by %.3g and %.3g m/s\n", long_steps, short_steps);
  assert_true(fabs(short_steps) < 1e-8 && fabs(long_steps) < 8e-8);
}

/* Its centre goes round at 2/7 of the table's rate, about a place that the start determines (Ehrlich and Tuszynski
 * 1995, Am. J. Phys. 63, 351). Returns how far its velocity is off, m/s. */
static double on_a_turntable(double dt) {
  run(2, dt,
      "{ shape = 'sphere', radius = 0.2, mass = 2, position = {1, 0, 0.2}, velocity = {0, 0.5, 0}, spin = {7.5, 0, 0} "
      "}",
      "b:surface { {0, 0, 0} } fall()\nscene:corrector('obstacle', { shape = 'plane', friction = 0.5, radius = 0.2,\n"
      "  rotation = function(t) return 0, 0, 2 * t end })\nlocal q = 4 / 7\n"
      "measure('off', function(s) local v = b:velocity(s); return abs(v[1] + 0.5 * sin(q * s.t)) + abs(v[2] - 0.5 * "
      "cos(q * s.t)) end)");
  return test_json(r.out, "off");
}

static void a_ball_on_a_turntable_goes_round_at_two_sevenths_of_its_rate(void **state) {
  (void)state;
  double long_steps = on_a_turntable(4e-3), short_steps = on_a_turntable(2e-3);
  print_message("turntable: off by %.3g and %.3g m/s\n", long_steps, short_steps);
  assert_true(long_steps < 2e-6 && short_steps < long_steps / 3);
}

/* It falls and rises at sqrt(2/7) of the rate at which it goes round (Gualtieri et al. 2006, Am. J. Phys. 74, 497):
 * 7/5 z'' = -g - 2/5 W^2 z. Without friction it only goes round. The normal turns: order 2. */
static double in_a_cylinder(double mu, double dt) {
  char rest[1024];
  snprintf(
      rest, sizeof rest,
      "b:surface { {0, 0, 0} } fall()\nscene:corrector('obstacle', { shape = 'cylinder', hollow = true, size = {1, "
      "1, 20}, friction = %g, radius = 0.1 })\nlocal q, W = sqrt(2 / 7) * 6, 6\n"
      "measure('z', function(s) local z = %g > 0 and 5 / 7 * g / q^2 * (cos(q * s.t) - 1) or -g / 2 * s.t^2\n"
      "  return b:position(s)[3] - z end)\n"
      "measure('x', function(s) local x = b:position(s); return abs(x[1] - 0.4 * cos(W * s.t)) + abs(x[2] - 0.4 * "
      "sin(W * s.t)) end)\n"
      "measure('speed', function(s) local v = b:velocity(s); return v[1]^2 + v[2]^2 - 2.4^2 end)",
      mu, mu);
  run(1, dt,
      "{ shape = 'sphere', radius = 0.1, mass = 2, position = {0.4, 0, 0}, velocity = {0, 2.4, 0}, spin = {0, 0, -24} "
      "}",
      rest);
  return fmax(fabs(test_json(r.out, "z")), fabs(test_json(r.out, "x")));
}

static void a_ball_in_a_cylinder_rises_again(void **state) {
  (void)state;
  for (double mu = 0; mu < 6; mu += 5) {
    double long_steps = in_a_cylinder(mu, 2e-3), short_steps = in_a_cylinder(mu, 1e-3);
    print_message("cylinder, mu = %g: off by %.3g and %.3g m\n", mu, long_steps, short_steps);
    assert_true(long_steps < 3e-4 && short_steps < long_steps / 3);
    small("speed", 1e-4);
  }
}

/* Moments of rolling = 2 mm and spinning = 1 mm times the normal force: 5/7 rolling g/r and 5/2 spinning g/r^2, to
 * rest. */
static void a_ball_is_slowed_by_rolling_and_spinning_friction(void **state) {
  (void)state;
  for (double t = 0.8; t < 9; t += 7.2) {
    run(t, 2e-3,
        "{ shape = 'sphere', radius = 0.1, mass = 2, position = {0, 0, 0.1}, velocity = {1, 0, 0}, spin = {0, 10, -4} "
        "}",
        "b:surface { {0, 0, 0} } fall()\nscene:corrector('obstacle', { shape = 'plane', friction = 0.5, radius = 0.1, "
        "rolling = 2e-3, spinning = 1e-3 })\nlocal a, c = 5 / 7 * 2e-3 * g / 0.1, 2.5e-3 * g / 0.1^2\n"
        "measure('speed', function(s) return b:velocity(s)[1] - math.max(0, 1 - a * s.t) end)\n"
        "measure('slip', function(s) return b:velocity(s)[1] - 0.1 * b:spin(s)[2] end)\n"
        "measure('spin', function(s) return b:spin(s)[3] + math.max(0, 4 - c * s.t) end)\n"
        "measure('way', function(s) local t = math.min(s.t, 1 / a); return b:position(s)[1] - t + a * t^2 / 2 end)");
    small("speed", 1e-8);
    small("slip", 1e-9);
    small("spin", 1e-6);
    small("way", 1e-7);
  }
}

/* Gravity's moment m g r sin a stays below rolling m g cos a. */
static void a_ball_with_rolling_friction_stays_on_a_gentle_slope(void **state) {
  (void)state;
  run(1, 2e-3, "{ shape = 'sphere', radius = 0.1, mass = 2, position = {0, 0, 0.1} }",
      "b:surface { {0, 0, 0} }\nlocal a = math.atan(0.99 * 0.02)\n"
      "scene:force('gravity', { g = {g * sin(a), 0, -g * cos(a)} })\n"
      "scene:corrector('obstacle', { shape = 'plane', friction = 0.5, radius = 0.1, rolling = 2e-3 })\n"
      "measure('creep', function(s) return b:position(s)[1] end)");
  small("creep", 1e-9);
}

/* A capsule across a beam, by its axis: what touches is 0.05 m below it, and it rolls at I/m r^2 of its moments. */
static void a_capsule_on_a_beam_rolls(void **state) {
  (void)state;
  run(0.6, 1e-3,
      "{ shape = 'capsule', radius = 0.05, length = 0.5, mass = 2, orientation = {math.pi / 2, 0, 0}, position = "
      "{-0.3, "
      "0, 0.05}, velocity = {1, 0, 0} }",
      "local p = b:surface { {0, 0, -0.25}, {0, 0, 0.25} } fall()\n"
      "scene:corrector('obstacle', { shape = 'box', size = {4, 0.02, 0.1}, position = {0, 0, -0.05}, friction = 0.5, "
      "radius = 0.05, edges = { p } })\n"
      "local I = math.min(b.inertia[1], b.inertia[2], b.inertia[3])\n"
      "measure('speed', function(s) return b:velocity(s)[1] - 1 / (1 + I / (2 * 0.05^2)) end)\n"
      "measure('slip', function(s) return b:velocity(s)[1] - 0.05 * b:spin(s)[2] end)");
  small("speed", 1e-6);
  small("slip", 1e-9);
}

/* J = (1 + e) |v|/(1/m + (r x n)^2/I). Without forces a flight is straight, and the step ends at the impact as well. */
static void falls_on_its_end(double dt) {
  run(0.05, dt,
      "{ shape = 'capsule', radius = 0.01, length = 0.8, mass = 1.3, position = {0, 0, 0.4 * sin(0.7) + 0.01}, "
      "velocity = {0, 0, -1}, orientation = {0, math.pi / 2 - 0.7, 0} }",
      "b:surface { {0, 0, -0.4}, {0, 0, 0.4} }\nscene:corrector('obstacle', { shape = 'plane', restitution = 0.6 })\n"
      "local I, r = math.max(b.inertia[1], b.inertia[2], b.inertia[3]), 0.4 * cos(0.7)\n"
      "local J = 1.6 / (1 / b.mass + r^2 / I)\n"
      "measure('speed', function(s) return b:velocity(s)[3] + 1 - J / b.mass end)\n"
      "measure('spin', function(s) return b:spin(s)[2] - r * J / I end)");
  small("speed", 1e-13);
  small("spin", 1e-12);
}

static void a_rod_that_falls_on_its_end_turns(void **state) {
  (void)state;
  falls_on_its_end(1e-3);
  falls_on_its_end(3e-3);
}

/* A box on a slope of 0.4 rad, tan 0.423: it slides with g (sin - mu cos), or stays. */
static void slides(double mu) {
  char rest[1024];
  snprintf(rest, sizeof rest,
           "local mu, n, d = %g, {-sin(0.4), 0, cos(0.4)}, {-cos(0.4), 0, -sin(0.4)}\nb:surface() fall()\n"
           "scene:corrector('obstacle', { shape = 'plane', normal = n, friction = mu })\n"
           "local a = g * math.max(0, sin(0.4) - mu * cos(0.4))\n"
           "measure('way', function(s) local x = b:position(s); return (x[1] - 0.05 * n[1]) * d[1] + (x[3] - 0.05 * "
           "n[3]) * d[3] - a / 2 * s.t^2 end)\n"
           "measure('speed', function(s) local v = b:velocity(s); return v[1] * d[1] + v[3] * d[3] - a * s.t end)",
           mu);
  run(0.4, 2e-3,
      "{ shape = 'box', size = {0.3, 0.2, 0.1}, mass = 2, orientation = {0, -0.4, 0}, position = {-0.05 * sin(0.4), 0, "
      "0.05 * cos(0.4)} }",
      rest);
  small("way", 1e-9);
  small("speed", 1e-10);
}

static void a_box_slides_below_the_slope_and_stays_above(void **state) {
  (void)state;
  slides(0.3);
  slides(0.6);
}

/* It tumbles, bounces and rubs: the largest rise of its energy between frames, J. */
static void tumbles(double e, double mu, double duration, double kept) {
  char rest[1024];
  snprintf(rest, sizeof rest,
           "b:surface() fall()\nscene:corrector('obstacle', { shape = 'plane', restitution = %g, friction = %g })\n"
           "local last, rise, first = 1e9, 0\nmeasure('rise', function(s)\n"
           "  local E = b:energy(s) + 2 * g * b:position(s)[3]\n  first = first or E\n"
           "  rise = math.max(rise, s.t > 0 and E - last or 0)\n  last = E\n  return rise\nend)\n"
           "measure('lost', function() return first - last end)",
           e, mu);
  run(duration, 1e-3,
      "{ shape = 'box', size = {0.2, 0.3, 0.1}, mass = 2, position = {0, 0, 0.6}, orientation = {0.3, 0.4, 0.2}, "
      "spin = {3, -2, 5}, velocity = {1, 0.3, 0} }",
      rest);
  small("rise", 1e-11);
  if (kept > 0) small("lost", kept);
}

static void energy_never_rises(void **state) {
  (void)state;
  tumbles(1, 0, 3, 1e-11);
  tumbles(1, 0.5, 3, 0);
  tumbles(0.6, 0.5, 1, 0);
}

/* The particles that have the mass are inside, and touch nothing: without a surface a body falls through, and that is
 * said. */
static void a_body_without_a_surface_is_told(void **state) {
  (void)state;
  test_write("told.lua",
             "local scene = hooke.scene { duration = 0.5, dt = 1e-3 }\n"
             "local b = scene:rigid { mass = 2, inertia = {1, 1, 1}, position = {0, 0, 0.5} }\n"
             "scene:force('gravity', { g = {0, 0, -9.81} })\nscene:corrector('obstacle', {})\n"
             "scene:measure('z', function(s) return b:position(s)[3] - 0.5 + 9.81 / 8 end)\nreturn scene\n");
  test_hooke(&r, NULL, "run told.lua --json --quiet --no-output");
  assert_int_equal(r.code, 0);
  small("z", 1e-12);
  assert_non_null(strstr(r.out, "obstacle meets 1 rigid bodies nowhere, such as that of particle 1"));
}

static void refused(const char *scene, int code, const char *sentence) {
  test_write("refused.lua", scene);
  test_hooke(&r, NULL, "run refused.lua --json --quiet --no-output");
  if (r.code != code || !strstr(r.err, sentence)) fail_msg("exit %d: %s", r.code, r.err);
}

static void a_body_that_starts_inside_is_refused(void **state) {
  (void)state;
  refused("local scene = hooke.scene { duration = 0.1, dt = 1e-3 }\n"
          "scene:rigid { shape = 'box', size = 0.2, mass = 1, position = {0, 0, 0.05} }:surface()\n"
          "scene:corrector('obstacle', {})\nreturn scene\n",
          1, "a rigid body starts inside the obstacle, by up to 0.05 m at its particle ");
}

/* A sphere, and a mesh, of which no point of the body is inside; beside the body, and hollow round it, they are fine.
 */
static void an_obstacle_within_a_body_is_refused(void **state) {
  static const char *const within[2] = {
      "shape = 'sphere', size = {0.1, 0.1, 0.1}, position = {0, 0, 0.2}",
      "shape = 'mesh', vertices = {0, 0, 0, 0.1, 0, 0, 0, 0.1, 0, 0, 0, 0.1}, position = {0, 0, 0.2}, "
      "faces = {1, 3, 2, 1, 2, 4, 1, 4, 3, 2, 3, 4}"};
  static const char *const apart[2] = {"shape = 'sphere', size = {0.1, 0.1, 0.1}, position = {0, 0, 0.7}",
                                       "shape = 'sphere', size = {4, 4, 4}, hollow = true"};
  static const char *const body = "local scene = hooke.scene { duration = 0.01, dt = 1e-3 }\n"
                                  "scene:rigid { shape = 'box', size = 1, mass = 1 }:surface()\n";
  char scene[1024];
  (void)state;
  for (int k = 0; k < 2; k++) {
    snprintf(scene, sizeof scene, "%sscene:corrector('obstacle', { %s })\nreturn scene\n", body, within[k]);
    refused(scene, 1, "(0, 0, 0.2) m is 0.3 m below the body's surface (particle ");
    snprintf(scene, sizeof scene, "%sscene:corrector('obstacle', { %s })\nreturn scene\n", body, apart[k]);
    refused(scene, 0, "");
    snprintf(scene, sizeof scene, "%sscene:force('penalty', { %s, k = 10 })\nreturn scene\n", body, within[k]);
    refused(scene, 0, "(0, 0, 0.2) m is 0.3 m below the body's surface (particle ");
  }
}

/* A rod that leans back and is pushed over a floor of friction 3: 1 + 3 cos a (cos a - mu sin a) is below 0 at a = 1.2.
 * Pulled the other way, or with a friction of 0.5, it slides. */
static void painleves_rod_ends_with_a_sentence(void **state) {
  static const struct { double speed, mu; } of[3] = {{3, 3}, {-3, 3}, {3, 0.5}};
  (void)state;
  for (int k = 0; k < 3; k++) {
    char scene[1024];
    snprintf(scene, sizeof scene,
             "local scene = hooke.scene { duration = 0.05, fps = 20, dt = 1e-3, integrator = 'leapfrog' }\n"
             "local c, s = 0.5 * math.cos(1.2), 0.5 * math.sin(1.2)\n"
             "local b = scene:rigid { points = { {c, 0, -s}, {0, 0, 0}, {-c, 0, s} }, masses = {1 / 6, 2 / 3, 1 / 6},\n"
             "  position = {0, 0, s}, velocity = {%g, 0, 0} }\nb:surface { {c, 0, -s}, {-c, 0, s} }\n"
             "scene:force('gravity', { g = {0, 0, -9.81} })\nscene:corrector('obstacle', { friction = %g })\nreturn "
             "scene\n",
             of[k].speed, of[k].mu);
    if (k == 0) {
      refused(scene, 2, "jams its body (Painleve's paradox)");
      continue;
    }
    test_write("rod.lua", scene);
    test_hooke(&r, NULL, "run rod.lua --json --quiet --no-output");
    assert_int_equal(r.code, 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_box_that_falls_flat_rises_by_the_square_of_e),
      cmocka_unit_test(a_ball_that_slides_rolls_at_five_sevenths),
      cmocka_unit_test(a_ball_on_a_turntable_goes_round_at_two_sevenths_of_its_rate),
      cmocka_unit_test(a_ball_in_a_cylinder_rises_again),
      cmocka_unit_test(a_capsule_on_a_beam_rolls),
      cmocka_unit_test(a_ball_is_slowed_by_rolling_and_spinning_friction),
      cmocka_unit_test(a_ball_with_rolling_friction_stays_on_a_gentle_slope),
      cmocka_unit_test(a_rod_that_falls_on_its_end_turns),
      cmocka_unit_test(a_box_slides_below_the_slope_and_stays_above),
      cmocka_unit_test(energy_never_rises),
      cmocka_unit_test(a_body_without_a_surface_is_told),
      cmocka_unit_test(a_body_that_starts_inside_is_refused),
      cmocka_unit_test(an_obstacle_within_a_body_is_refused),
      cmocka_unit_test(painleves_rod_ends_with_a_sentence),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
