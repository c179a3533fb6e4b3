/* The corrector liquid and walls that move along themselves, in whole runs: a drum turns its liquid as fast as itself,
 * and obstacles leave the liquid's particles to it. And the memory that a viscosity takes is said before the start. */
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

/* A full round drum, 0.8 m wide, in a box of 1 m, which turns with 1 rad/s. */
static const char drum[] =
    "local filling = require('filling')\n"
    "local n, R, start = 12, 0.4, param('start', 0, 'rad/s', {})\n"
    "local scene = hooke.scene { duration = 2, fps = 50, dt = 0.02, integrator = 'symplectic_euler' }\n"
    "local function inside(x, _, z) return (x - 0.5)^2 + (z - 0.5)^2 < R * R end\n"
    "local water = filling.box { low = { 0, 0, 0 }, high = { 1, 0, 1 }, cell = 1 / n, inside = inside }\n"
    "for _, p in ipairs(water.positions) do\n"
    "  scene:particle { position = p, mass = water.mass, velocity = { -start * (p[3] - 0.5), 0, start * (p[1] - 0.5) } "
    "}\n"
    "end\n"
    "scene:corrector('obstacle', { shape = 'sphere', size = { 2 * R, 2 * R, 2 * R }, hollow = true,\n"
    "  position = { 0.5, 0, 0.5 }, rotation = function(t) return 0, -t, 0 end })\n"
    "scene:corrector('liquid', { low = { 0, 0, 0 }, high = { 1, 0, 1 }, cell = 1 / n,\n"
    "  viscosity = param('mu', 100, 'Pa s', {}), memory = param('memory', 4, 'GB', {}) })\n"
    "scene:measure('turn', function(s)\n"
    "  local sum, all = 0, 0\n"
    "  for id = 1, s.n do\n"
    "    local p, v = s:position(id), s:velocity(id)\n"
    "    local x, z = p[1] - 0.5, p[3] - 0.5\n"
    "    if x * x + z * z < 0.09 then sum, all = sum + x * v[3] - z * v[1], all + x * x + z * z end\n"
    "  end\n"
    "  return sum / all end)\n"
    "return scene\n";

static void run(const char *words) {
  char arguments[512];
  snprintf(arguments, sizeof arguments, "run %s --json --no-output --no-check %s", test_write("drum.lua", drum), words);
  test_hooke(&r, NULL, arguments);
}

/* Within 2 s the liquid has the drum's spin but for exp(-18): 1 % with ten cells across, where walls cut faces. A wall
 * that moved as fast as the faces behind it made it 14 % faster. */
static void a_drum_turns_its_liquid_as_fast_as_itself(void **state) {
  (void)state;
  run("");
  double turn = test_json(r.out, "turn");
  if (!(fabs(turn - 1) < 0.01)) fail_msg("%.5f rad/s", turn);
}

/* Particles that go round in a drum would meet it in each step, twice and more: in the fifth, obstacles took back every
 * step. Without a viscosity what turns keeps turning, a little slower by walls that cut faces. */
static void obstacles_take_no_step_back(void **state) {
  (void)state;
  run("start=1 mu=0 --until 0.2");
  assert_true(test_json(r.out, "rejected_steps") == 0);
  double turn = test_json(r.out, "turn");
  if (!(turn > 0.9 && turn < 1.01)) fail_msg("%.5f rad/s", turn);
}

/* 14 x 14 x 3 cells of 0.5 kB, and for 288 faces 0.8 kB each. */
static void memory_is_said_with_the_viscosity(void **state) {
  (void)state;
  run("memory=4e-4 mu=0 --until 0.02");
  if (strstr(r.err, "memory")) fail_msg("%s", r.err);
  run("memory=4e-4 --until 0.02");
  assert_int_equal(r.code, 1);
  if (!strstr(r.err, "its viscosity up to") || !strstr(r.err, "take larger cells")) fail_msg("%s", r.err);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_drum_turns_its_liquid_as_fast_as_itself),
      cmocka_unit_test(obstacles_take_no_step_back),
      cmocka_unit_test(memory_is_said_with_the_viscosity),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
