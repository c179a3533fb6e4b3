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

/* A drop of a single particle falls into a round bowl, slides down and up in it. No pressure acts on it: it kept its
 * velocity into the wall, 0.57 m/s of it. */
static const char bowl[] =
    "local scene = hooke.scene { duration = 1, fps = 100, integrator = 'symplectic_euler' }\n"
    "scene:particle { position = { 0.2, 0, 0.3 }, mass = 0.01 }\n"
    "scene:force('gravity', { g = { 0, 0, -9.81 } })\n"
    "scene:corrector('obstacle', { shape = 'sphere', size = { 1, 1, 1 }, hollow = true, restitution = 0 })\n"
    "scene:corrector('liquid', { low = { -0.6, 0, -0.6 }, high = { 0.6, 0, 0.6 }, cell = 0.02 })\n"
    "local head, into, frames = -1, 0, 0\n"
    "scene:measure('head', function(s)\n"
    "  local p, v = s:position(1), s:velocity(1)\n"
    "  local r = math.sqrt(p[1]^2 + p[3]^2)\n"
    "  if r > 0.5 - 1e-9 then frames, into = frames + 1, math.max(into, (p[1] * v[1] + p[3] * v[3]) / r) end\n"
    "  head = math.max(head, (v[1]^2 + v[3]^2) / (2 * 9.81) + p[3])\n"
    "  return head end)\n"
    "scene:measure('into', function() return into end)\n"
    "scene:measure('frames', function() return frames end)\n"
    "return scene\n";

static void a_drop_on_a_wall_does_not_move_into_it(void **state) {
  (void)state;
  char arguments[512];
  snprintf(arguments, sizeof arguments, "run %s --json --no-output --no-check", test_write("bowl.lua", bowl));
  test_hooke(&r, NULL, arguments);
  assert_int_equal(r.code, 0);
  assert_true(test_json(r.out, "frames") > 10);
  double into = test_json(r.out, "into"), head = test_json(r.out, "head");
  if (!(into < 1e-12)) fail_msg("%g m/s into the wall", into);
  if (!(head < 0.3 + 1e-9)) fail_msg("%g m of head, from 0.3", head);
}

/* A vessel of 0.8 m, of which walls cut the grid's cells: liquid at rest in it up to a level, m, 10 cells across. */
static const char vessel[] =
    "local filling = require('filling')\n"
    "local shape, level, tilt, R = param('shape', 'sphere', ''), param('level', 1, 'm', {}), param('tilt', 0, 'rad', "
    "{}), 0.4\n"
    "local c, s = math.cos(tilt), math.sin(tilt)\n"
    "local function inside(x, y, z)\n"
    "  if z > level then return false end\n"
    "  x, z = c * x - s * z, s * x + c * z\n"
    "  if shape == 'sphere' then return x * x + y * y + z * z < R * R end\n"
    "  return x * x + y * y < R * R and math.abs(z) < R end\n"
    "local scene = hooke.scene { duration = 1, fps = 200, dt = 0.005, integrator = 'symplectic_euler' }\n"
    "local water = filling.box { low = { -0.5, -0.5, -0.5 }, high = { 0.5, 0.5, 0.5 }, cell = 1 / 12, inside = inside "
    "}\n"
    "scene:particles { positions = water.positions, mass = water.mass }\n"
    "scene:force('gravity', { g = { 0, 0, -9.81 } })\n"
    "scene:corrector('obstacle', { shape = shape, size = { 2 * R, 2 * R, 2 * R }, hollow = true, restitution = 0,\n"
    "  rotation = { 0, tilt, 0 } })\n"
    "scene:corrector('liquid', { low = { -0.5, -0.5, -0.5 }, high = { 0.5, 0.5, 0.5 }, cell = 1 / 12, tolerance = "
    "1e-11 })\n"
    "local first\n"
    "scene:measure('rise', function(s)\n"
    "  local sum = 0\n"
    "  for id = 1, s.n do sum = sum + s:position(id)[3] / s.n end\n"
    "  first = first or sum\n"
    "  return sum - first end)\n"
    "scene:measure('fastest', function(s)\n"
    "  local most = 0\n"
    "  for id = 1, s.n do for _, v in ipairs(s:velocity(id)) do most = math.max(most, math.abs(v)) end end\n"
    "  return most end)\n"
    "return scene\n";

static void run_vessel(const char *words) {
  char arguments[512];
  snprintf(arguments, sizeof arguments, "run %s --json --no-output --no-check %s", test_write("vessel.lua", vessel),
           words);
  test_hooke(&r, NULL, arguments);
  if (!(test_json(r.out, "in_walls") == 0)) fail_msg("%s%s", r.out, r.err);
}

/* Of 1e-10 m/s as a column in a box, by the same tolerance of the pressure. Kernels beside walls that cut cells had up
 * to 6 % less room than they have: the density of a full sphere was off by 4.1 %. 0.1 % now, by chance in places. */
static void full_round_vessels_are_as_dense_as_their_liquid_and_at_rest(void **state) {
  (void)state;
  static const char *const words[] = {"--until 0.1", "shape=cylinder tilt=0.3 --until 0.1"};
  for (int k = 0; k < 2; k++) {
    run_vessel(words[k]);
    double off = test_json(r.out, "volume_drift"), fastest = test_json(r.out, "fastest");
    if (!(fabs(off) < 5e-3)) fail_msg("%s: off by %.5f", words[k], off);
    if (!(fastest < 1e-10)) fail_msg("%s: %g m/s", words[k], fastest);
  }
}

/* The density there was evened until the liquid of a half full sphere was 7 % larger, its middle 11 mm higher. By the
 * surface's own level, a hundredth of a cell, and the room's half percent it may be 2 mm. */
static void a_half_full_round_vessel_keeps_its_volume(void **state) {
  (void)state;
  run_vessel("level=0 --until 0.3");
  double rise = test_json(r.out, "rise");
  if (!(fabs(rise) < 2e-3)) fail_msg("%.5f m", rise);
}

/* A lid slides over a full plane box, on a plane of faces of a grid of 40 cells, from which rounding moves its surface
 * by 4e-17 m: the cells behind it were taken for liquid, and moved with it through the side of the box. They drew the
 * particles into the corner, and left the middle of the vortex empty. */
static void a_lid_on_the_grid_lets_nothing_in(void **state) {
  (void)state;
  test_write(
      "lid.lua",
      "local n = 40\n"
      "local scene = hooke.scene { duration = 1.5, fps = 4, dt = 1 / 80, integrator = 'symplectic_euler' }\n"
      "local water = require('filling').box { low = { 0, 0, 0 }, high = { 1, 0, 1 }, cell = 1 / n }\n"
      "scene:particles { positions = water.positions, mass = water.mass }\n"
      "scene:corrector('obstacle', { shape = 'box', size = { 6, 1, 4 / n },\n"
      "  position = function(t) return 0.5 + t, 0, 1 + 2 / n end })\n"
      "scene:corrector('liquid', { low = { 0, 0, 0 }, high = { 1, 0, 1 + 2 / n }, cell = 1 / n, viscosity = 10 })\n"
      "scene:measure('core', function(s)\n"
      "  local count = 0\n"
      "  for id = 1, s.n do\n"
      "    local p = s:position(id)\n"
      "    if (p[1] - 0.6)^2 + (p[3] - 0.73)^2 < 0.01 then count = count + 1 end\n"
      "  end\n"
      "  return count / (4 * n * n * math.pi * 0.01) end)\n"
      "return scene\n");
  test_hooke(&r, NULL, "run lid.lua --json --no-output --no-check");
  assert_int_equal(r.code, 0);
  /* About the vortex's middle are 201 particles; of those on the rim of that disc, some 45 within half of their
   * distance, half are in by chance: 3 of them more or less. It was 0.52. */
  double core = test_json(r.out, "core"), drift = test_json(r.out, "volume_drift");
  if (!(fabs(core - 1) < 0.05 && fabs(drift) < 1e-3)) fail_msg("%.3f of the density, volume_drift %.5f", core, drift);
}

/* A jet of water, 0.1 m wide and of 3 m/s, without gravity, meets a plate of 0.7 m: `top` m above the middle the plate
 * ends, and its face is at `front`. Drains beyond take the water. */
static const char jet[] =
    "local c, front, top = 0.02, param('front', 0.75, 'm'), param('top', 0.36, 'm')\n"
    "local mass = 1000 * c^3 / 4\n"
    "local scene = hooke.scene { duration = 0.8, fps = 20, dt = 0.005, integrator = 'symplectic_euler' }\n"
    "scene:source('emitter', { rate = 1000 * 3 * 0.1 * c / mass, mass = mass, shape = 'line', speed = 3,\n"
    "  places = 'even', position = { 0.1, 0, 0.45 }, ['end'] = { 0.1, 0, 0.55 }, direction = { 1, 0, 0 } })\n"
    "scene:source('drain', { low = { 0, -1, 0 }, high = { 2, 1, 0.06 } })\n"
    "scene:source('drain', { low = { 0, -1, 0.94 }, high = { 2, 1, 1 } })\n"
    "local body\n"
    "if param('free', 0, '') == 1 then\n"
    "  body = scene:rigid { shape = 'box', size = { 0.1, c, 2 * top }, density = 2e6, position = { front + 0.05, 0, "
    "0.5 } }\n"
    "else\n"
    "  scene:corrector('obstacle', { shape = 'box', size = { 0.1, 4, 2 * top }, position = { front + 0.05, 0, 0.5 } "
    "})\n"
    "end\n"
    "scene:corrector('liquid', { low = { 0, 0, 0 }, high = { 1.2, 0, 1 }, cell = c })\n"
    "scene:measure('aside', function(s)\n"
    "  local sum, all = 0, 0\n"
    "  for _, id in ipairs(s:ids()) do\n"
    "    if s:mass(id) < 1 and math.abs(s:position(id)[3] - 0.5) > 0.38 then\n"
    "      sum, all = sum + s:velocity(id)[1], all + math.abs(s:velocity(id)[3])\n"
    "    end\n"
    "  end\n"
    "  return all > 0 and sum / all or 0\n"
    "end)\n"
    "scene:measure('push', function(s) return body and body.mass * body:velocity(s)[1] or 0 end)\n"
    "return scene\n";

static void run_jet(const char *words) {
  char arguments[512];
  snprintf(arguments, sizeof arguments, "run %s --json --no-output --no-check %s", test_write("jet.lua", jet), words);
  test_hooke(&r, NULL, arguments);
  assert_int_equal(r.code, 0);
}

/* By free streamlines it turns by a right angle, but for exp(-pi 0.3/0.05). Where the plate's end cuts the grid does
 * not matter; where its face cut cells and its end was on faces the jet was drawn round it by 0.27. */
static void a_jet_leaves_a_plate_along_it(void **state) {
  (void)state;
  static const char *const plates[] = {"top=0.36", "top=0.35", "front=0.76 top=0.36", "front=0.757 top=0.355"};
  for (size_t k = 0; k < sizeof plates / sizeof *plates; k++) {
    run_jet(plates[k]);
    double aside = test_json(r.out, "aside");
    if (!(fabs(aside) < 0.02)) fail_msg("%s: %.4f", plates[k], aside);
  }
}

/* A plate that is heavy and free takes the momentum of the jet, rho A v^2 = 18 N, between 0.5 and 0.8 s, with five
 * cells in the jet: 4.5 % too little, by the 0.05 of the speed that films still have at its end. It was 28 % too
 * little. */
static void a_jet_pushes_a_plate_with_its_momentum(void **state) {
  (void)state;
  run_jet("free=1 --until 0.5");
  double before = test_json(r.out, "push");
  run_jet("free=1 --until 0.8");
  double force = (test_json(r.out, "push") - before) / 0.3, wanted = 1000 * 0.1 * 0.02 * 3 * 3;
  if (!(fabs(force / wanted - 1) < 0.1)) fail_msg("%.3f N instead of %.3f N", force, wanted);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_drum_turns_its_liquid_as_fast_as_itself),
      cmocka_unit_test(obstacles_take_no_step_back),
      cmocka_unit_test(memory_is_said_with_the_viscosity),
      cmocka_unit_test(full_round_vessels_are_as_dense_as_their_liquid_and_at_rest),
      cmocka_unit_test(a_half_full_round_vessel_keeps_its_volume),
      cmocka_unit_test(a_lid_on_the_grid_lets_nothing_in),
      cmocka_unit_test(a_drop_on_a_wall_does_not_move_into_it),
      cmocka_unit_test(a_jet_leaves_a_plate_along_it),
      cmocka_unit_test(a_jet_pushes_a_plate_with_its_momentum),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
