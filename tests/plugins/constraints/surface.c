/* Particles on surfaces and curves: known paths and periods, conserved quantities, forces of the surface, functions of
 * the script against the shapes that they describe, surfaces that move, and what has no direction. */
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

static void run(const char *options) {
  char arguments[1024];
  snprintf(arguments, sizeof arguments, "run %s/scene.lua --json --quiet --no-output %s", test_folder(), options);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0) fail_msg("%s: exit %d: %s%s", options, r.code, r.err, r.out);
}

static double measured(const char *key) { return test_json(strstr(r.out, "\"measures\""), key); }

static void near(const char *key, double wanted, double tolerance) {
  double got = measured(key);
  if (!(fabs(got - wanted) <= tolerance)) fail_msg("%s is %.17g, not %.17g +- %g", key, got, wanted, tolerance);
}

/* A bead on a circle of 0.4 m whose plane is upright: a pendulum of that length. From the horizontal it passes the
 * bottom after a quarter of its period, 4 K(sin 45) sqrt(L/g) = 4 1.8540746773013719 sqrt(L/g), with v^2 = 2 g L, and
 * the circle bears 3 m g there: rk4 at 400 steps to a quarter is right to (h w)^4/120 of some 5 rad/s: 1e-9. */
static void a_bead_on_a_circle_is_a_pendulum(void **state) {
  (void)state;
  test_write("scene.lua", "local fps = 1 / (1.8540746773013719 * math.sqrt(0.4 / 9.81))\n"
                          "local scene = hooke.scene { duration = 1 / fps, fps = fps, integrator = 'rk4',\n"
                          "  dt = 1 / (400 * fps) }\n"
                          "local p = scene:particle { position = { 1.4, 0, 2 }, mass = 0.3 }\n"
                          "scene:force('gravity')\n"
                          "scene:constraint('surface', { particles = { p }, shape = 'circle', position = { 1, 0, 2 },\n"
                          "  axis = { 0, 2, 0 }, radius = 0.4 })\n"
                          "scene:measure('x', function(s) return s:position(p)[1] - 1 end)\n"
                          "scene:measure('z', function(s) return s:position(p)[3] - 2 end)\n"
                          "scene:measure('v', function(s) return s:velocity(p)[1] end)\n"
                          "scene:measure('force', function(s) return s:force('surface', p)[3] end)\n"
                          "scene:measure('radial', function(s) return s:constraint_forces('surface')[1] end)\n"
                          "return scene\n");
  run("");
  near("x", 0, 1e-8);
  near("z", -0.4, 1e-12);
  near("v", -sqrt(2 * 9.81 * 0.4), 1e-8);
  near("force", 3 * 0.3 * 9.81, 1e-7);
  near("radial", -3 * 0.3 * 9.81, 1e-7);
}

/* Without forces a particle runs along a geodesic at its speed: a great circle of a sphere, a straight line in a plane,
 * a helix on a cylinder, a straight line along a line; at t = 2 rk4 in steps of 1/200 s is right to 1e-8. */
static void free_particles_run_along_geodesics(void **state) {
  (void)state;
  test_write("scene.lua",
             "local scene = hooke.scene { duration = 2, fps = 1, integrator = 'rk4', dt = 1 / 200 }\n"
             "local function on(shape, x, v, more)\n"
             "  local p = scene:particle { position = x, velocity = v, mass = 2 }\n"
             "  local values = { particles = { p }, shape = shape, label = shape, axis = { 0, 0, 1 }, radius = 2 }\n"
             "  for key, value in pairs(more or {}) do values[key] = value end\n"
             "  scene:constraint('surface', values)\n"
             "  for c, name in ipairs { 'x', 'y', 'z' } do\n"
             "    scene:measure(shape .. ' ' .. name, function(s) return s:position(p)[c] end)\n"
             "  end\n"
             "end\n"
             "on('sphere', { 2, 0, 0 }, { 0, 1.5, 2 })\n"
             "on('cylinder', { 2, 0, 0 }, { 0, 3, 0.5 })\n"
             "on('plane', { 1, 2, 3 }, { 1, 1, -1 }, { position = { 1, 2, 3 }, axis = { 1, 0, 1 } })\n"
             "on('line', { 1, 2, 3 }, { 1, 0, 1 }, { position = { 0, 2, 2 }, axis = { 1, 0, 1 } })\n"
             "return scene\n");
  run("");
  const double tolerance = 1e-8, angle = 2.5 * 2 / 2, turn = 3.0 * 2 / 2;
  near("sphere x", 2 * cos(angle), tolerance);
  near("sphere y", 2 * 0.6 * sin(angle), tolerance);
  near("sphere z", 2 * 0.8 * sin(angle), tolerance);
  near("cylinder x", 2 * cos(turn), tolerance);
  near("cylinder y", 2 * sin(turn), tolerance);
  near("cylinder z", 1, tolerance);
  near("plane x", 3, tolerance);
  near("plane y", 4, tolerance);
  near("plane z", 1, tolerance);
  near("line x", 3, tolerance);
  near("line y", 2, tolerance);
  near("line z", 5, tolerance);
}

/* The shapes written as functions, with and without their gradients, in other units: the same paths and forces. The
 * differences are right to 1e-12 of the gradient, and the end is less so by the motion, ten radians. */
static void functions_do_what_the_shapes_do(void **state) {
  (void)state;
  test_write(
      "scene.lua",
      "local how = param('how', 0, 'shape, function, with gradients')\n"
      "local scene = hooke.scene { duration = 2, fps = 4, integrator = 'rk4', dt = 1 / 200 }\n"
      "local a = scene:particle { position = { 0.6, 0, -0.8 }, velocity = { 0, 1, 0 }, mass = 2 }\n"
      "local b = scene:particle { position = { 0, 0.6, 0.8 }, velocity = { 1, 0, 0 }, mass = 3 }\n"
      "scene:force('gravity')\n"
      "local function g(t, x, y, z) return 100 * (x * x + y * y + z * z - 1) end\n"
      "local function dg(t, x, y, z) return 200 * x, 200 * y, 200 * z end\n"
      "local function h(t, x, y, z) return 1e-3 * (z - 0.8) end\n"
      "local function dh() return 0, 0, 1e-3 end\n"
      "if how == 0 then\n"
      "  scene:constraint('surface', { particles = { a }, label = 'a' })\n"
      "  scene:constraint('surface', { particles = { b }, shape = 'circle', radius = 0.6, position = { 0, 0, 0.8 } })\n"
      "else\n"
      "  local with = how == 2\n"
      "  scene:constraint('surface', { particles = { a }, g = g, g_gradient = with and dg or nil, label = 'a' })\n"
      "  scene:constraint('surface', { particles = { b }, g = g, g_gradient = with and dg or nil, h = h,\n"
      "    h_gradient = with and dh or nil })\n"
      "end\n"
      "scene:measure('force', function(s) return s:constraint_forces('a')[1] end)\n"
      "scene:measure('held', function(s) return s:force('surface', b)[3] end)\n"
      "for c = 1, 3 do scene:measure('a' .. c, function(s) return s:position(a)[c] end) end\n"
      "for c = 1, 3 do scene:measure('b' .. c, function(s) return s:position(b)[c] end) end\n"
      "return scene\n");
  static const char *const keys[] = {"force", "held", "a1", "a2", "a3", "b1", "b2", "b3"};
  double wanted[8];
  for (int how = 0; how < 3; how++) {
    char option[32];
    snprintf(option, sizeof option, "how=%d", how);
    run(option);
    for (int k = 0; k < 8; k++)
      if (how == 0)
        wanted[k] = measured(keys[k]);
      else
        near(keys[k], wanted[k], 1e-9 * fmax(1, fabs(wanted[k])));
  }
}

/* A bead on a straight wire that turns in a plane at the rate w: r'' = w^2 r, so r = r0 cosh(w t) from rest on the
 * wire; the wire pushes it sideways with 2 m w r'. Its work is that of the push: the energy balance knows it. */
static void a_turning_wire_flings_its_bead(void **state) {
  (void)state;
  test_write("scene.lua",
             "local w = 2\n"
             "local scene = hooke.scene { duration = 1, fps = 10, integrator = 'rk4', dt = 1 / 200 }\n"
             "local p = scene:particle { position = { 0.5, 0, 0 }, velocity = { 0, 1, 0 }, mass = 3 }\n"
             "scene:constraint('surface', { particles = { p },\n"
             "  g = function(t, x, y) return y * math.cos(w * t) - x * math.sin(w * t) end,\n"
             "  h = function(t, x, y, z) return z end })\n"
             "scene:measure('r', function(s) local x = s:position(p) return math.sqrt(x[1]^2 + x[2]^2) end)\n"
             "scene:measure('push', function(s) return s:constraint_forces('surface')[1] end)\n"
             "return scene\n");
  run("");
  near("r", 0.5 * cosh(2), 1e-7);
  near("push", 2 * 3 * 2 * 0.5 * 2 * sinh(2), 1e-5);
  assert_true(fabs(test_json(r.out, "drift")) < 1e-7);
  assert_true(fabs(test_json(r.out, "work")) > 1);
}

/* A plate that shakes with 1 mm at 10, 100 and 1000 Hz carries a particle: its force is m (g + z''), also where the
 * plate turns and nothing moves. The differences in time have to find out how short they are: right to 1e-4/255, and
 * the rounding of z over the square of a step. */
static void a_shaking_plate_pushes_with_what_it_shakes(void **state) {
  (void)state;
  test_write("scene.lua",
             "local rate, method = param('rate', 10, 'Hz'), param('method', 1, '')\n"
             "local w, A, m = 2 * math.pi * rate, 1e-3, 2\n"
             "local scene = hooke.scene { duration = 1.25 / rate, fps = 40 * rate, dt = 1 / (80 * rate),\n"
             "  integrator = ({ 'leapfrog', 'rk4' })[method] }\n"
             "local p = scene:particle { position = { 1, 0, 0 }, velocity = { 0, 0.3, A * w }, mass = m }\n"
             "scene:force('gravity')\n"
             "scene:constraint('surface', { particles = { p }, g = function(t, x, y, z) return z - A * math.sin(w * t) "
             "end })\n"
             "local worst = 0\n"
             "scene:measure('off', function(s)\n"
             "  local known = m * (9.81 - A * w * w * math.sin(w * s.t))\n"
             "  worst = math.max(worst, math.abs(s:constraint_forces('surface')[1] - known) / (m * A * w * w))\n"
             "  return worst\n"
             "end)\n"
             "return scene\n");
  for (int method = 1; method <= 2; method++)
    for (int rate = 10; rate <= 1000; rate *= 10) {
      char option[64];
      snprintf(option, sizeof option, "rate=%d method=%d", rate, method);
      run(option);
      near("off", 0, 2e-6);
    }
}

/* A plane that is at 0 at every step of 1/60 s and every half of one, and hums between them: the run cannot see it. The
 * function is called for the particles of the surface alone. */
static void what_a_surface_does_between_the_steps_is_noticed(void **state) {
  (void)state;
  char arguments[512];
  test_write("scene.lua", "local rate = param('rate', 1800, '1/s')\n"
                          "local scene = hooke.scene { duration = 0.5, fps = 60, dt = 1 / 60 }\n"
                          "local p = scene:particle { mass = 1, velocity = { 1, 0, 0 } }\n"
                          "scene:particle { mass = 1, position = { 1, 1, 1 } }\n"
                          "scene:constraint('surface', { particles = { p }, g = function(t, x, y, z, id)\n"
                          "  assert(id == p)\n"
                          "  return z - 0.01 * math.sin(2 * math.pi * rate * t) ^ 2\n"
                          "end })\n"
                          "return scene\n");
  for (int slow = 0; slow < 2; slow++) {
    snprintf(arguments, sizeof arguments, "run %s/scene.lua --no-output %s", test_folder(), slow ? "rate=2" : "");
    test_hooke(&r, NULL, arguments);
    assert_int_equal(r.code, slow ? 0 : 5);
    assert_true((strstr(r.out, "scene.lua:5: surface: g does something within") != NULL) == !slow);
  }
}

/* ---- the start ---- */

/* 0.3 m off the sphere and 1 m/s away from it; and a start that is off by the rounding of its numbers. */
static void a_start_off_the_surface_is_moved_onto_it_and_said(void **state) {
  (void)state;
  char arguments[512];
  test_write("scene.lua", "local off = param('off', 1, 'a bad start')\n"
                          "local scene = hooke.scene { duration = 0.1, fps = 10, dt = 0.01 }\n"
                          "local q = scene:particle { position = { 0.6, 0.8, 0 }, velocity = { 0, 0, 2 } }\n"
                          "local p = scene:particle { position = { off == 1 and 1.3 or 1 + 1e-9, 0, 0 },\n"
                          "  velocity = { off == 1 and 1 or 0, 1, 0 } }\n"
                          "scene:constraint('surface', { particles = { p, q } })\n"
                          "scene:measure('x', function(s) return s:position(p)[1] end)\n"
                          "return scene\n");
  for (int off = 0; off < 2; off++) {
    snprintf(arguments, sizeof arguments, "run %s/scene.lua --no-output --until 0 off=%d", test_folder(), off);
    test_hooke(&r, NULL, arguments);
    assert_int_equal(r.code, 0);
    assert_true((strstr(r.err, "particle 2 is moved onto them by 0.3 m, others by less") != NULL) == (off == 1));
    assert_true((strstr(r.err, "the velocity of particle 2 is changed by 1 m/s, of others by less") != NULL) ==
                (off == 1));
    if (off == 0 && strstr(r.err, "constraints")) fail_msg("%s", r.err);
  }
}

/* ---- with other methods and constraints ---- */

/* A spherical pendulum keeps its energy and angular momentum about the vertical, for explicit and implicit methods. */
static void a_spherical_pendulum_keeps_energy_and_angular_momentum(void **state) {
  (void)state;
  test_write("scene.lua",
             "local scene = hooke.scene { duration = 4, fps = 5, dt = 1 / 500 }\n"
             "local p = scene:particle { position = { 0.6, 0, -0.8 }, velocity = { 0, 1.7, 0 }, mass = 2 }\n"
             "scene:force('gravity')\n"
             "scene:constraint('surface', { particles = { p } })\n"
             "scene:measure('L', function(s)\n"
             "  local x, v = s:position(p), s:velocity(p)\n"
             "  return (x[1] * v[2] - x[2] * v[1]) / (0.6 * 1.7) - 1\n"
             "end)\n"
             "return scene\n");
  /* the methods' errors at h w = 4/500: order 2 leaves (h w)^2/10 or less, order 4 (h w)^4; dopri5 takes 1e-6 */
  static const struct {
    const char *method;
    double momentum, energy;
  } cases[] = {
      {"leapfrog", 1e-5, 1e-5}, {"rk4", 1e-8, 1e-8}, {"implicit_midpoint", 1e-4, 1e-4}, {"dopri5", 1e-4, 1e-4}};
  for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
    char option[64];
    snprintf(option, sizeof option, "--integrator %s", cases[k].method);
    run(option);
    if (!(fabs(measured("L")) < cases[k].momentum && fabs(test_json(r.out, "drift")) < cases[k].energy))
      fail_msg("%s: %g, %g", cases[k].method, measured("L"), test_json(r.out, "drift"));
    assert_true(test_json(r.out, "constraint_violation") < 1e-11);
  }
}

/* ---- errors ---- */

#define HEAD                                                                                                           \
  "local scene = hooke.scene { duration = 1, fps = 10, dt = 0.01, integrator = 'rk4' }\n"                              \
  "local p = scene:particle { position = { 1, 0, 0 }, velocity = { -1, 0, 0 } }\n"

static void what_has_no_direction_is_named_with_particle_time_and_place(void **state) {
  (void)state;
  test_refused(HEAD "scene:constraint('surface', { particles = { p }, position = { 1, 0, 0 } })\nreturn scene\n",
               "--quiet", 1,
               "bad.lua:3: surface: particle 1 at (1, 0, 0) m, t = 0 s: this is the middle of the sphere");
  test_refused(HEAD "scene:constraint('surface', { particles = { p }, shape = 'cylinder', axis = { 1, 0, 0 } })\n"
                    "return scene\n",
               "--quiet", 1, "bad.lua:3: surface: particle 1 at (1, 0, 0) m, t = 0 s: this is on the axis");
  test_refused(HEAD "scene:constraint('surface', { particles = { p }, axis = { 0, 0, 0 } })\nreturn scene\n", "--quiet",
               1, "bad.lua:3: surface: axis: it has no length, so no direction");
  /* y^2 + z^2 = x^4: the bead runs into the tip, where the gradient is zero, at t = 1/sqrt 5 or later */
  test_refused(HEAD "scene:constraint('surface', { particles = { p },\n"
                    "  g = function(t, x, y, z) return y end, h = function(t, x, y, z) return x * x * x * z end })\n"
                    "return scene\n",
               "--quiet", 2, "the gradient of h vanishes, so it has no direction");
}

static void functions_that_do_not_fit_are_refused(void **state) {
  (void)state;
  test_refused(HEAD "local function f() return 0 end\n"
                    "scene:constraint('surface', { particles = { p }, h = f })\nreturn scene\n",
               "--quiet", 1, "bad.lua:4: surface: h is for a curve, which g and h state together");
  test_refused(HEAD "local function f() return 0, 0, 1 end\n"
                    "scene:constraint('surface', { particles = { p }, g_gradient = f })\nreturn scene\n",
               "--quiet", 1, "bad.lua:4: surface: g_gradient needs g, whose gradient it is");
  test_refused(
      HEAD "scene:constraint('surface', { particles = { p }, g = function(t, x, y, z) return x * x - y - 1 end,\n"
           "  g_gradient = function(t, x, y, z) return 2 * x, 1, 0 end })\nreturn scene\n",
      "--quiet", 1,
      "bad.lua:3: surface: g_gradient: at the start of particle 1 it is (2, 1, 0), and differences of g give (2, -1, ");
  test_refused(HEAD "scene:constraint('surface', { particles = { p },\n"
                    "  g = function(t, x, y, z) return y + 1e-3 * math.sin(3000 * (x - 1)) end })\nreturn scene\n",
               "--quiet", 1, "it changes within less than length = 1 m, give that, or g_gradient");
  test_refused(HEAD "scene:constraint('surface', { particles = { p },\n"
                    "g = function(t, x, y, z) return x, 2 end })\nreturn scene\n",
               "--quiet", 1, "bad.lua:4: this function returned more numbers than are expected at t = 0 s, particle 1");
  test_refused(HEAD "scene:constraint('surface', { particles = { p },\n"
                    "g = function(t, x, y, z) return t > 0.5 and 0/0 or y end })\nreturn scene\n",
               "--quiet", 1, "bad.lua:4: this function returned nan at t = 0.5");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_bead_on_a_circle_is_a_pendulum),
      cmocka_unit_test(free_particles_run_along_geodesics),
      cmocka_unit_test(functions_do_what_the_shapes_do),
      cmocka_unit_test(a_turning_wire_flings_its_bead),
      cmocka_unit_test(a_shaking_plate_pushes_with_what_it_shakes),
      cmocka_unit_test(what_a_surface_does_between_the_steps_is_noticed),
      cmocka_unit_test(a_start_off_the_surface_is_moved_onto_it_and_said),
      cmocka_unit_test(a_spherical_pendulum_keeps_energy_and_angular_momentum),
      cmocka_unit_test(what_has_no_direction_is_named_with_particle_time_and_place),
      cmocka_unit_test(functions_that_do_not_fit_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
