/* Rigid bodies that a viscous liquid drags, in whole runs: liquid and body come to one motion and keep their momentum,
 * and without a viscosity a body slips. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static test_result r;

/* A disc of 11.8 kg in the middle of a ring of 40 kg of liquid that touches nothing else; it moves and spins at the
 * start, and the liquid is at rest. */
static const char ring[] =
    "local filling = require('filling')\n"
    "local cell = 1 / 12\n"
    "local scene = hooke.scene { duration = 1, fps = 100, dt = 0.01, integrator = 'symplectic_euler' }\n"
    "local function inside(x, _, z) local d = (x - 0.5)^2 + (z - 0.5)^2 return d < 0.42^2 and d > 0.15^2 end\n"
    "local water = filling.box { low = { 0, 0, 0 }, high = { 1, 0, 1 }, cell = cell, inside = inside }\n"
    "scene:particles { positions = water.positions, mass = water.mass }\n"
    "local body = scene:rigid { shape = 'cylinder', radius = 0.15, length = cell, density = 2000,\n"
    "  position = { 0.5, 0, 0.5 }, orientation = { math.pi / 2, 0, 0 }, velocity = { 0.2, 0, 0.1 }, spin = { 0, 1, 0 } "
    "}\n"
    "scene:corrector('liquid', { low = { -0.5, 0, -0.5 }, high = { 1.5, 0, 1.5 }, cell = cell,\n"
    "  viscosity = param('mu', 1e4, 'Pa s', {}) })\n"
    "local n = #water.positions\n"
    "local function flow(s) local sum = 0 for id = 1, n do sum = sum + s:velocity(id)[1] / n end return sum end\n"
    "scene:measure('momentum', function(s) return n * water.mass * flow(s) + body.mass * body:velocity(s)[1] end)\n"
    "scene:measure('body', function(s) return body:velocity(s)[1] end)\n"
    "scene:measure('flow', flow)\n"
    "scene:measure('spin', function(s) return body:spin(s)[2] end)\n"
    "return scene\n";

static void run(const char *words) {
  char arguments[512];
  snprintf(arguments, sizeof arguments, "run %s --json --no-output --no-check %s", test_write("ring.lua", ring), words);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0) fail_msg("%s%s", r.out, r.err);
}

/* In 0.05 s of 10 m^2/s the ring, 0.27 m wide, becomes one with the disc: a thousandth is left of the difference. Of
 * the momentum, 2.356 kg m/s, the first step takes 4 %: faces of the disc cover particles' kernels in a layer of a
 * quarter of a cell. */
static void a_disc_and_its_liquid_come_to_one_motion(void **state) {
  (void)state;
  run("--until 0.05");
  double momentum = test_json(r.out, "momentum"), body = test_json(r.out, "body"), flow = test_json(r.out, "flow");
  if (!(fabs(body / flow - 1) < 0.01)) fail_msg("%.5f and %.5f m/s", body, flow);
  if (!(fabs(momentum / 2.356 - 1) < 0.05)) fail_msg("%.4f kg m/s", momentum);
}

/* As one they turn, too: less than 1 rad/s by their moments of inertia, 0.13 and 4.0 kg m^2: 0.032. */
static void its_spin_is_shared(void **state) {
  (void)state;
  run("--until 0.05");
  double spin = test_json(r.out, "spin"), wanted = 0.1325 / (0.1325 + 4.0);
  if (!(fabs(spin / wanted - 1) < 0.1)) fail_msg("%.5f instead of %.5f rad/s", spin, wanted);
  run("--until 0.05 mu=0");
  spin = test_json(r.out, "spin");
  if (!(spin > 0.98)) fail_msg("%.5f rad/s without a viscosity", spin);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_disc_and_its_liquid_come_to_one_motion),
      cmocka_unit_test(its_spin_is_shared),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
