/* Pressures between particles and what they move: bodies that liquid hits, hangs on or stands on, cloth, a box that is
 * full. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

/* A cube of 4 x 4 x 4 particles flies with 1 m/s beside the middle of a free body of 27 points; the momentum of all
 * and, about the origin, their angular momentum, by what they were. */
static const char *const blow =
    "local ratio, steps = param('ratio', 1, ''), param('steps', 10, 'of 0.1 spacings')\n"
    "local dx, m, ids = 0.05, 1000 * 0.05 ^ 3, {}\n"
    "local s = hooke.scene { duration = 0.3, fps = 20, dt = dx / steps, integrator = 'symplectic_euler' }\n"
    "for i = 1, 4 do for j = 1, 4 do for k = 1, 4 do\n"
    "  ids[#ids + 1] = s:particle { position = { (i - 5) * dx, j * dx, k * dx }, velocity = { 1, 0, 0 }, mass = m }\n"
    "end end end\n"
    "local body = s:rigid { shape = 'box', size = { 3 * dx, 3 * dx, 3 * dx }, density = ratio * 1000,\n"
    "  position = { 1.5 * dx, 3.5 * dx, 2.5 * dx } }\n"
    "local points = {}\n"
    "for i = -1, 1 do for j = -1, 1 do for k = -1, 1 do points[#points + 1] = { i * dx, j * dx, k * dx } end end end\n"
    "body:surface(points)\n"
    "s:corrector('incompressible', { spacing = dx })\n"
    "local start = {}\n"
    "local function off(name, of, about) s:measure(name, function(at)\n"
    "  local sum, size = of(at), 0\n"
    "  sum = { sum[1], sum[2], sum[3] }\n"
    "  for _, id in ipairs(ids) do\n"
    "    local x, v = at:position(id), at:velocity(id)\n"
    "    for c = 1, 3 do\n"
    "      local a, b = c % 3 + 1, (c + 1) % 3 + 1\n"
    "      sum[c] = sum[c] + m * (about and x[a] * v[b] - x[b] * v[a] or v[c])\n"
    "    end\n"
    "  end\n"
    "  start[name] = start[name] or sum\n"
    "  for c = 1, 3 do size = math.max(size, math.abs(sum[c] - start[name][c])) end\n"
    "  return size / math.sqrt(start[name][1] ^ 2 + start[name][2] ^ 2 + start[name][3] ^ 2)\n"
    "end) end\n"
    "off('momentum', function(at) return body:momentum(at) end)\n"
    "off('turning', function(at) return body:angular_momentum(at, { 0, 0, 0 }) end, true)\n"
    "s:measure('speed', function(at) return body:velocity(at)[1] end)\n"
    "return s\n";

static void run(const char *scene, const char *options) {
  char call[512];
  snprintf(call, sizeof call, "run %s --json --no-output --quiet %s", test_write("scene.lua", scene), options);
  test_hooke(&r, NULL, call);
}

/* Momentum is kept to rounding, 300 products a step at most; a body a hundred times lighter than the liquid does not
 * throw it back, and one a hundred times heavier is hardly moved. Were the blow inelastic, the body of the same density
 * had 64/91 of the speed of the liquid, 0.7 m/s; the jet slips past with a part of it. */
static void what_hits_a_body_moves_it(void **state) {
  (void)state;
  static const struct {
    const char *options;
    double least, most;
  } of[] = {{"ratio=0.01", 0.9, 1.6}, {"", 0.2, 0.7}, {"ratio=100", 0.002, 0.03}};
  for (size_t k = 0; k < sizeof of / sizeof *of; k++) {
    run(blow, of[k].options);
    double momentum = test_json(r.out, "momentum"), speed = test_json(r.out, "speed");
    print_message("%s: momentum off by %.1e, turning by %.1e, the body at %.4f m/s\n", of[k].options, momentum,
                  test_json(r.out, "turning"), speed);
    assert_int_equal(r.code, 0);
    assert_true(momentum < 1e-13);
    assert_true(speed > of[k].least && speed < of[k].most);
  }
}

/* Angular momentum is kept by each impulse, and by what turns to the order of the step. */
static void angular_momentum_is_kept_to_the_order_of_the_step(void **state) {
  (void)state;
  double off[2];
  for (int k = 0; k < 2; k++) {
    run(blow, k ? "steps=80" : "steps=10");
    off[k] = test_json(r.out, "turning");
  }
  print_message("off by %.1e and %.1e\n", off[0], off[1]);
  assert_true(off[0] < 1e-3 && off[1] < off[0] / 2);
}

/* A column of a plane liquid between faces that repeat, 10 particles wide and 6 high, stands on a plate that a spring
 * holds: the spring bears both. */
static const char *const plate =
    "local dx, g = 0.1, 10\n"
    "local s = hooke.scene { duration = 2, fps = 10, dt = 2e-3, integrator = 'symplectic_euler' }\n"
    "local water = {}\n"
    "for i = 0, 9 do for k = 0, 5 do\n"
    "  water[#water + 1] = s:particle { position = { (i + 0.5) * dx, 0, (k + 0.5) * dx }, mass = 1000 * dx ^ 3 }\n"
    "end end\n"
    "s:pin(water, { normal = { 0, 1, 0 } })\n"
    "local body = s:rigid { shape = 'box', size = { 1, dx, 3 * dx }, density = 2000, position = { 0.5, 0, -1.5 * dx } "
    "}\n"
    "local points = {}\n"
    "for i = 0, 9 do for k = -1, 1 do points[#points + 1] = { (i + 0.5) * dx - 0.5, 0, k * dx } end end\n"
    "body:surface(points)\n"
    "s:joint { kind = 'slider', a = body, at = { 0.5, 0, 0 }, axis = { 0, 0, 1 } }\n"
    "local hook = s:particle { position = { 0.5, 0, 1.85 }, mass = 1 }\n"
    "s:pin { hook }\n"
    "s:force('springs', { edges = { { hook, body:point { 0, 0, 0 } } }, k = 20000, damping = 3000 })\n"
    "s:periodic { high = { 1, 1, 1 }, axes = 'x' }\n"
    "s:force('gravity', { g = { 0, 0, -g } })\n"
    "local liquid = { spacing = dx, dimensions = 2, wall_volume = dx ^ 3, particles = water }\n"
    "s:corrector('incompressible', liquid)\n"
    "s:force('viscosity', { spacing = dx, dimensions = 2, wall_volume = dx ^ 3, particles = water, mu = 60 })\n"
    "s:measure('bears', function(at) return 20000 * (-1.5 * dx - body:position(at)[3]) / (g * (60 + 60)) end)\n"
    "return s\n";

/* To 1 %: the column swings on as the tolerance of its density lets it, also with this viscosity. */
static void a_plate_bears_what_stands_on_it(void **state) {
  (void)state;
  run(plate, "");
  double bears = test_json(r.out, "bears");
  if (!(r.code == 0 && fabs(bears - 1) < 1e-2)) fail_msg("it bears %g of the weight; %s", bears, r.err);
}

/* Where there is no room for a particle in twenty, pressures would have no end. */
static void a_box_that_is_too_full_is_refused(void **state) {
  (void)state;
  const char *scene = "local s = hooke.scene { duration = 0.1, fps = 10, dt = 1e-2, integrator = 'symplectic_euler' }\n"
                      "for i = 0, 7 do for j = 0, 7 do for k = 0, 7 do\n"
                      "  s:particle { position = { i * 0.1, j * 0.1, k * 0.1 }, mass = 1.05 }\n"
                      "end end end\n"
                      "s:periodic { high = { 0.8, 0.8, 0.8 } }\n"
                      "s:corrector('incompressible', { spacing = 0.1 })\nreturn s\n";
  test_refused(scene, "", 2, "incompressible: the liquid needs 1.05 times the volume of the box that repeats");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_hits_a_body_moves_it),
      cmocka_unit_test(angular_momentum_is_kept_to_the_order_of_the_step),
      cmocka_unit_test(a_plate_bears_what_stands_on_it),
      cmocka_unit_test(a_box_that_is_too_full_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
