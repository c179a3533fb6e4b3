/* Rigid bodies in contact with each other, by the points of their surfaces: an impulse on these moves the whole body.
 * Balls and boxes against closed forms, momenta, energy, cloth. */
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

static void run(double duration, double dt, const char *text) {
  static char scene[8192];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = %g, fps = 50, integrator = 'leapfrog', dt = %g }\n"
           "local sin, cos, abs, g = math.sin, math.cos, math.abs, 9.81\n"
           "local function measure(name, f) scene:measure(name, f) end\n"
           "local function fall() scene:force('gravity', { g = {0, 0, -g} }) end\n"
           "local function turn(b, s) local w = b:spin(s); return abs(w[1]) + abs(w[2]) + abs(w[3]) end\n"
           "%s\nreturn scene\n",
           duration, dt, text);
  test_write("bodies.lua", scene);
  test_hooke(&r, NULL, "run bodies.lua --json --quiet --no-output");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
}

static void small(const char *measure, double within) {
  double found = test_json(r.out, measure);
  print_message("%s: %.3g, at most %.1g\n", measure, found, within);
  if (!(fabs(found) <= within)) fail_msg("%s: %.17g is above %g", measure, found, within);
}

/* J = (1 + e) |u.n|/(1/m + 1/M) along the line of the centres at the instant at which they touch; spins stay. */
static void balls_collide_along_their_centres(void **state) {
  (void)state;
  run(0.2, 2.5e-4,
      "local R, e, d, u = 0.1, 0.8, {-0.3, 0.05, 0.02}, {1.2, -0.05, 0}\n"
      "local v, w = {1, 0, 0}, {-0.2, 0.05, 0}\n"
      "local a = scene:rigid { shape = 'sphere', radius = R, mass = 1, position = d, velocity = v, spin = {1, 2, 3} }\n"
      "local b = scene:rigid { shape = 'sphere', radius = R, mass = 3, velocity = w }\n"
      "a:surface { {0, 0, 0} } b:surface { {0, 0, 0} }\n"
      "scene:corrector('contact', { radius = R, restitution = e })\n"
      "local function dot(p, q) return p[1] * q[1] + p[2] * q[2] + p[3] * q[3] end\n"
      "local A, B, C = dot(u, u), dot(d, u), dot(d, d) - 4 * R^2\n"
      "local t, n = (-B - math.sqrt(B^2 - A * C)) / A, {}\n"
      "for c = 1, 3 do n[c] = (d[c] + t * u[c]) / (2 * R) end\n"
      "local J = -(1 + e) * dot(u, n) / (1 + 1 / 3)\n"
      "measure('off', function(s) local p, q, most = a:velocity(s), b:velocity(s), 0\n"
      "  for c = 1, 3 do most = math.max(most, abs(p[c] - v[c] - J * n[c]), abs(q[c] - w[c] + J * n[c] / 3)) end\n"
      "  return most end)\n"
      "measure('spin', function(s) local w = a:spin(s); return abs(w[1] - 1) + abs(w[2] - 2) + abs(w[3] - 3) end)");
  small("off", 1e-7);
  small("spin", 1e-12);
  assert_true(test_json(r.out, "intersections") == 0);
}

static const char floor_of[] = "scene:body { shape = 'box', size = {6, 6, 0.1}, position = {0, 0, -0.05} }\n";

/* On a floor of triangles, with half of the thickness between. */
static void a_box_that_falls_flat_rises_by_the_square_of_e(void **state) {
  char text[2048];
  (void)state;
  snprintf(
      text, sizeof text,
      "%slocal b = scene:rigid { shape = 'box', size = {0.2, 0.3, 0.2}, mass = 2, position = {0, 0, 0.601} }\n"
      "b:surface() fall()\n"
      "scene:corrector('contact', { thickness = 0.002, restitution = 0.5, friction = 0.4 })\n"
      "local first = math.sqrt(2 * 0.5 / g)\n"
      "measure('off', function(s) local t = s.t - first; return b:position(s)[3] - 0.101 - 0.5 * g * first * t + g "
      "/ 2 * t^2 end)\nmeasure('turn', function(s) return turn(b, s) end)",
      floor_of);
  run(0.5, 1e-3, text);
  small("off", 1e-7);
  small("turn", 1e-3);
  assert_true(test_json(r.out, "intersections") == 0);
}

/* A slope of 0.4 rad, tan 0.423: a = g (sin - mu cos), until a box that is thrown down it stops. */
static void slides(double mu, double speed) {
  char text[2048];
  snprintf(
      text, sizeof text,
      "local mu, u, h, n, d = %g, %g, 0.051, {-sin(0.4), 0, cos(0.4)}, {-cos(0.4), 0, -sin(0.4)}\n"
      "local b = scene:rigid { shape = 'box', size = {0.3, 0.2, 0.1}, mass = 2, orientation = {0, -0.4, 0}, "
      "position = {h * n[1], 0, h * n[3]}, velocity = {u * d[1], 0, u * d[3]} }\nb:surface() fall()\n"
      "scene:body { shape = 'box', size = {4, 4, 0.1}, orientation = {0, -0.4, 0}, position = {-0.05 * n[1], 0, "
      "-0.05 * n[3]} }\n"
      "scene:corrector('contact', { thickness = 0.002, friction = mu })\n"
      "local a = g * (sin(0.4) - mu * cos(0.4))\nlocal stop = a < 0 and -u / a or 9\n"
      "measure('way', function(s) local x, t = b:position(s), math.min(s.t, stop); return (x[1] - h * n[1]) * d[1] "
      "+ (x[3] - h * n[3]) * d[3] - u * t - a / 2 * t^2 end)",
      mu, speed);
  run(0.3, 1e-3, text);
  small("way", 2e-4 * speed + 1e-6); /* friction of a step takes the way since its start: order 1 at the stop */
}

static void a_box_slides_below_the_slope_and_stops_above(void **state) {
  (void)state;
  slides(0.3, 0);
  slides(0.6, 0.2);
}

/* Two boxes hit each other off their centres and go on turning. */
static void collides(double mu, double angular) {
  char text[4096];
  snprintf(
      text, sizeof text,
      "local a = scene:rigid { shape = 'box', size = 0.2, mass = 1, position = {-0.2, 0.05, 0.01}, velocity = {1, 0, "
      "0}, orientation = {0.1, 0.2, 0.3} }\n"
      "local b = scene:rigid { shape = 'box', size = 0.2, mass = 3, position = {0.2, 0, 0} }\na:surface() b:surface()\n"
      "scene:corrector('contact', { thickness = 0.002, restitution = 0.5, friction = %g })\nlocal P, L, E\n"
      "local function sum(p, q) return { p[1] + q[1], p[2] + q[2], p[3] + q[3] } end\n"
      "local function most(p, q) return math.max(abs(p[1] - q[1]), abs(p[2] - q[2]), abs(p[3] - q[3])) end\n"
      "measure('momentum', function(s) local p = sum(a:momentum(s), b:momentum(s)); P = P or p; return most(p, P) "
      "end)\n"
      "measure('angular', function(s) local o = {0, 0, 0}\n"
      "  local l = sum(a:angular_momentum(s, o), b:angular_momentum(s, o)); L = L or l; return most(l, L) end)\n"
      "measure('speed', function(s) return b:velocity(s)[1] end)",
      mu);
  run(0.5, 1e-3, text);
  small("momentum", 1e-13);
  small("angular", angular);
  assert_true(test_json(r.out, "speed") > 0.2);
}

/* What touches is a thickness apart, and both sides are rubbed in the middle. */
static void momenta_are_kept(void **state) {
  (void)state;
  collides(0, 1e-7);
  collides(0.3, 1e-7);
}

/* A box falls onto another one and both onto the floor. */
static void tumbles(double e, double mu, double most) {
  char text[4096];
  snprintf(text, sizeof text,
           "%slocal b = scene:rigid { shape = 'box', size = {0.2, 0.3, 0.1}, mass = 2, position = {0, 0, 0.6}, "
           "orientation = {0.3, 0.4, 0.2}, spin = {3, -2, 5}, velocity = {0.3, 0.3, 0} }\n"
           "local a = scene:rigid { shape = 'box', size = 0.2, mass = 1, position = {0.05, 0, 0.2}, "
           "orientation = {0.1, 0.3, 0.2} }\nb:surface() a:surface() fall()\n"
           "scene:corrector('contact', { thickness = 0.002, restitution = %g, friction = %g })\n"
           "local last, rise = 1e9, 0\nmeasure('rise', function(s)\n"
           "  local E = b:energy(s) + 2 * g * b:position(s)[3] + a:energy(s) + g * a:position(s)[3]\n"
           "  rise = math.max(rise, s.t > 0 and E - last or 0)\n  last = E\n  return rise\nend)",
           floor_of, e, mu);
  run(1, 1e-3, text);
  small("rise", most); /* of 14 J */
  assert_true(test_json(r.out, "intersections") == 0);
}

static void energy_does_not_rise(void **state) {
  (void)state;
  tumbles(1, 0, 1e-4);
  tumbles(0.6, 0.5, 1e-3);
}

/* It stays in the sheet, which hangs by its corners; nothing passes. */
static void a_box_falls_into_cloth(void **state) {
  (void)state;
  run(0.5, 1e-3,
      "local s = scene:grid { nx = 11, ny = 11, width = 1, height = 1, origin = {-0.5, -0.5, 0}, u = {1, 0, 0}, v = "
      "{0, 1, 0}, mass = 0.3 }\nscene:pin { 1, 11, 111, 121 } fall()\n"
      "scene:force('springs', { edges = s:edges(), k = 200, damping = 0.05 })\n"
      "local b = scene:rigid { shape = 'box', size = {0.2, 0.2, 0.1}, mass = 0.3, position = {0.03, 0, 0.2}, "
      "orientation = {0.3, 0.2, 0} }\nb:surface()\n"
      "scene:corrector('contact', { thickness = 0.004, friction = 0.3 })\n"
      "measure('above', function(t) local z = -9; for c = 60, 62 do z = math.max(z, t:position(c)[3]) end\n"
      "  return b:position(t)[3] - z end)");
  double above = test_json(r.out, "above");
  assert_true(above > 0.02 && above < 0.2);
  assert_true(test_json(r.out, "intersections") == 0);
}

/* 5/7 of its speed, with the floor's half of the thickness below it. */
static double rolls(double dt) {
  char text[1024];
  snprintf(text, sizeof text,
           "%slocal b = scene:rigid { shape = 'sphere', radius = 0.1, mass = 2, position = {0, 0, 0.1}, velocity = {1, "
           "0, 0} }\nb:surface { {0, 0, 0} } fall()\n"
           "scene:corrector('contact', { radius = 0.1, friction = 0.2 })\n"
           "measure('speed', function(s) return b:velocity(s)[1] - 5 / 7 end)\n"
           "measure('slip', function(s) return b:velocity(s)[1] - 0.1 * b:spin(s)[2] end)",
           floor_of);
  run(1.2, dt, text);
  small("slip", 1e-12);
  return test_json(r.out, "speed");
}

static void a_ball_that_slides_rolls_at_five_sevenths(void **state) {
  (void)state;
  double long_steps = rolls(2e-3), short_steps = rolls(1e-3);
  print_message("off 5/7 by %.3g and %.3g m/s\n", long_steps, short_steps);
  assert_true(fabs(short_steps) < 1e-8 && fabs(long_steps) < 8e-8);
  assert_true(strstr(r.out, "\"warnings\":[]") != NULL);
}

/* One ball slides along another one: with J = (1 + e)/2 m u.n the impulse mu J across n gives both the spin 5/2 mu J/(m
 * R), so slow that it goes on sliding; momenta are kept. */
static void balls_rub_each_other_at_their_surfaces(void **state) {
  (void)state;
  run(0.2, 2.5e-4,
      "local R, d, u, mu = 0.1, {-0.3, 0.12, 0}, 2, 0.1\n"
      "local a = scene:rigid { shape = 'sphere', radius = R, mass = 1, position = d, velocity = {u, 0, 0} }\n"
      "local b = scene:rigid { shape = 'sphere', radius = R, mass = 1 }\n"
      "a:surface { {0, 0, 0} } b:surface { {0, 0, 0} }\n"
      "scene:corrector('contact', { radius = R, restitution = 0.8, friction = mu })\n"
      "local J, w = 0.9 * u * 0.8, 2.5 / R * mu\n" /* u.n = -0.8 u */
      "measure('spin', function(s) return abs(abs(a:spin(s)[3]) - w * J) + abs(a:spin(s)[3] - b:spin(s)[3]) end)\n"
      "measure('speed', function(s) local v = b:velocity(s)\n"
      "  return abs(v[1] - J * (0.8 + mu * 0.6)) + abs(v[2] - J * (-0.6 + mu * 0.8)) end)\n"
      "local o, L = {0, 0, 0}\nmeasure('angular', function(s)\n"
      "  local p, q = a:angular_momentum(s, o), b:angular_momentum(s, o); L = L or p[3] + q[3]\n"
      "  return p[3] + q[3] - L end)");
  small("spin", 1e-6);
  small("speed", 1e-6);
  small("angular", 1e-9);
}

/* The impulse acts at its centre, which friction does not turn. */
static void a_round_point_of_a_flat_body_is_told_of_friction(void **state) {
  (void)state;
  static const char *const correctors[] = {"'contact', { radius = 0.1,",
                                           "'obstacle', { shape = 'plane', position = {0, 0, -1},"};
  for (int k = 0; k < 4; k++) {
    char text[512];
    snprintf(text, sizeof text,
             "scene:rigid { points = { {0, 0, 0}, {1, 0, 0}, {0, 1, 0} }, masses = {1, 1, 1} }"
             ":surface({ {0, 0, 0} }, { radius = 0.11 })\nscene:corrector(%s friction = %d })",
             correctors[k / 2], k % 2);
    run(0.01, 1e-3, text);
    if ((strstr(r.out, "is rubbed at its centre: particle 4") != NULL) != (k % 2 > 0)) fail_msg("%s: %s", text, r.out);
  }
}

static void balls_that_start_in_each_other_are_refused(void **state) {
  (void)state;
  test_write("overlap.lua", "local scene = hooke.scene { duration = 0.1, dt = 1e-3 }\n"
                            "for k = 0, 1 do scene:rigid { shape = 'sphere', radius = 0.1, mass = 1, position = "
                            "{0.15 * k, 0, 0} }:surface { {0, 0, 0} } end\n"
                            "scene:corrector('contact', { radius = 0.1 })\nreturn scene\n");
  test_hooke(&r, NULL, "run overlap.lua --json --quiet --no-output");
  assert_int_not_equal(r.code, 0);
  assert_non_null(strstr(r.err, "rigid bodies overlap at the start, by 0.05 m (particle 5 and particle 10)"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(balls_collide_along_their_centres),
      cmocka_unit_test(a_box_that_falls_flat_rises_by_the_square_of_e),
      cmocka_unit_test(a_box_slides_below_the_slope_and_stops_above),
      cmocka_unit_test(momenta_are_kept),
      cmocka_unit_test(energy_does_not_rise),
      cmocka_unit_test(a_box_falls_into_cloth),
      cmocka_unit_test(a_ball_that_slides_rolls_at_five_sevenths),
      cmocka_unit_test(balls_rub_each_other_at_their_surfaces),
      cmocka_unit_test(balls_that_start_in_each_other_are_refused),
      cmocka_unit_test(a_round_point_of_a_flat_body_is_told_of_friction),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
