/* Rigid bodies in a liquid, in whole runs: they float as deep as their density says, heave with the frequency of
 * potential theory, accelerate with their added mass, and keep momentum with the liquid; what is held is a wall, and
 * what is not a liquid's is said. */
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

static void run(const char *name, const char *scene, const char *words) {
  char arguments[1024];
  snprintf(arguments, sizeof arguments, "run %s --json --no-output --no-check %s", test_write(name, scene), words);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0) fail_msg("%s%s", r.out, r.err);
}

/* A block of half the density of water, 0.6 m x 0.4 m, in a plane tank of 1 m x 0.5 m of water. `off`: m, above its
 * place of rest; the water fills what it leaves, to the level that keeps its volume. */
static const char block[] =
    "local cell, off = param('cell', 0.0625, 'm', {}), param('off', 0, 'm', {})\n"
    "local filling = require('filling')\n"
    "local scene = hooke.scene { duration = 1, fps = 100, dt = 0.16 * cell, integrator = 'symplectic_euler' }\n"
    "local function fill(from, to, top)\n"
    "  local water = filling.box { low = { from, 0, 0 }, high = { to, 0, top }, cell = cell }\n"
    "  scene:particles { positions = water.positions, mass = water.mass } end\n"
    "fill(0, 0.2, 0.5 - 1.5 * off) fill(0.2, 0.8, 0.3 + off) fill(0.8, 1, 0.5 - 1.5 * off)\n"
    "local body = scene:rigid { shape = 'box', size = { 0.6, param('deep', 1, 'cells', {}) * cell, 0.4 },\n"
    "  density = 500 / param('deep', 1, 'cells', {}), position = { 0.5, 0, 0.5 + off } }\n"
    "scene:force('gravity', { g = { 0, 0, -9.81 } })\n"
    "scene:corrector('liquid', { low = { 0, 0, 0 }, high = { 1, 0, 1 }, cell = cell })\n"
    "local function height(s) return body:position(s)[3] - 0.5 end\n"
    "local sum, count, before, last, first = 0, 0, off, 0, nil\n"
    "scene:measure('mean', function(s) sum, count = sum + height(s), count + 1 return sum / count end)\n"
    "scene:measure('half', function(s)\n"
    "  local now = height(s)\n"
    "  if before * now < 0 then\n"
    "    last = s.t - 0.01 * now / (now - before) first = first or last end\n"
    "  before = now\n"
    "  return last - (first or 0) end)\n"
    "return scene\n";

/* Its draft is 0.2 m: 0.4 % of it with 16 cells across the tank, 3 of which are between block and wall, 0.1 % with 32.
 * With 20 its faces lie on those of the grid, as its bottom passes one: 0.4 %. Particles that are all at random in
 * their places made it 0.6 %. */
static void a_block_floats_as_deep_as_its_density_says(void **state) {
  (void)state;
  run("block.lua", block, "");
  double coarse = test_json(r.out, "mean");
  assert_null(strstr(r.err, "does not know rigid bodies"));
  run("block.lua", block, "cell=0.03125 --until 0.6");
  double fine = test_json(r.out, "mean");
  run("block.lua", block, "cell=0.05");
  double aligned = test_json(r.out, "mean");
  if (!(fabs(coarse) < 2e-3)) fail_msg("16 cells: %.5f m off", coarse);
  if (!(fabs(aligned) < 2e-3)) fail_msg("20 cells: %.5f m off", aligned);
  if (!(fabs(fine) < 2e-4)) fail_msg("32 cells: %.6f m off", fine);
}

/* What is across a plane is not in it: a block as deep as a cell, whose ends are half a cell away, moves as one that is
 * nine cells deep, to rounding. With the ends taken for walls it heaved 15 % too fast where its bottom passes a face.
 */
static void the_depth_of_a_block_across_a_plane_is_nothing(void **state) {
  (void)state;
  run("block.lua", block, "off=0.01 --until 0.3");
  double one = test_json(r.out, "mean");
  run("block.lua", block, "off=0.01 deep=9 --until 0.3");
  assert_true(fabs(test_json(r.out, "mean") - one) < 1e-10 && fabs(one) > 1e-3);
}

/* Potential theory with the block and the surface, linear, in this tank: w = 5.460 1/s, from finite volumes of 1/80 and
 * 1/160 m, extrapolated by h^(4/3); the block's motion is that mode alone. Without the water's mass it would be 11.
 * Halves of a period that begin high and low differ by the amplitude; their mean is found to 0.3 %. */
static void a_block_heaves_as_in_potential_theory(void **state) {
  (void)state;
  run("block.lua", block, "off=0.02 cell=0.03125 --until 0.95");
  double half = test_json(r.out, "half") / 2;
  run("block.lua", block, "off=-0.02 cell=0.03125 --until 0.95");
  half += test_json(r.out, "half") / 2;
  if (!(fabs(half / (3.14159265 / 5.460) - 1) < 0.01)) fail_msg("%.4f s", half);
}

/* A ball of 0.2 m in the middle of a full cube of 1 m of water, open above. */
static const char ball[] =
    "local ratio, g, speed = param('ratio', 4, '', {}), param('g', 9.81, 'm/s^2', {}), param('speed', 0, 'm/s', {})\n"
    "local filling = require('filling')\n"
    "local scene = hooke.scene { duration = 1, fps = 100, dt = 0.01, integrator = 'symplectic_euler' }\n"
    "local function free(x, y, z) return (x - 0.5)^2 + (y - 0.5)^2 + (z - 0.5)^2 > 0.04 end\n"
    "local water = filling.box { low = { 0, 0, 0 }, high = { 1, 1, 1 }, cell = 0.0625, inside = free }\n"
    "scene:particles { positions = water.positions, mass = water.mass }\n"
    "local body = scene:rigid { shape = 'sphere', radius = 0.2, density = 1000 * ratio, position = { 0.5, 0.5, 0.5 },\n"
    "  velocity = { speed, 0, 0 } }\n"
    "scene:force('gravity', { g = { 0, 0, -g } })\n"
    "local far = speed ~= 0 and 0.5 or 0\n"
    "scene:corrector('liquid', { low = { -far, -far, -far }, high = { 1 + far, 1 + far, 1 + far }, cell = 0.0625 })\n"
    "scene:measure('speed', function(s) return body:velocity(s)[3] end)\n"
    "scene:measure('momentum', function(s)\n"
    "  local p = body:momentum(s)[1]\n"
    "  for id = 1, #water.positions do p = p + water.mass * s:velocity(id)[1] end\n"
    "  return p / body.mass end)\n"
    "return scene\n";

static double acceleration(const char *words) {
  run("ball.lua", ball, words);
  return test_json(r.out, "speed") / 0.03;
}

/* g (B - ratio)/(ratio + C) of a light and of a heavy one give the buoyancy B, 1, and the added mass C: 1/2 in open
 * water and 0.603 in a spherical shell that fits into the cube, (b^3 + 2 a^3)/(b^3 - a^3)/2 (Lamb, Hydrodynamics, art.
 * 93). With six cells across the ball B is 0.945, with 13 0.987, of which its facets are 0.01. */
static void a_ball_accelerates_with_its_added_mass(void **state) {
  (void)state;
  double down = -acceleration("--until 0.03 ratio=4") / 9.81, up = acceleration("--until 0.03 ratio=0.1") / 9.81;
  double mass = (4 - 0.1 - 4 * down - 0.1 * up) / (down + up), lift = up * (0.1 + mass) + 0.1;
  if (!(mass > 0.48 && mass < 0.603)) fail_msg("added mass %.4f", mass);
  if (!(fabs(lift - 1) < 0.07)) fail_msg("buoyancy %.4f", lift);
}

/* A ball that moves in a cube of water that nothing holds: 1 % of it in five steps, in which the ball gives a tenth to
 * the water at once; kinetic energy falls. */
static void momentum_is_kept(void **state) {
  (void)state;
  run("ball.lua", ball, "--until 0.05 g=0 speed=1");
  double momentum = test_json(r.out, "momentum");
  if (!(fabs(momentum - 1) < 0.01)) fail_msg("%.5f", momentum);
}

static void threads_do_not_change_bits(void **state) {
  (void)state;
  static const char *const words[] = {"--until 0.1 --threads 1", "--until 0.1 --threads 2", "--until 0.1 --threads 7"};
  double first = 0;
  for (int k = 0; k < 3; k++) {
    run("block.lua", block, words[k]);
    double mean = test_json(r.out, "mean");
    if (k == 0) first = mean;
    assert_true(mean == first && mean != 0);
  }
}

/* A block on a hinge. */
static void what_is_held_is_a_wall_and_said(void **state) {
  (void)state;
  char scene[sizeof block + 128];
  const char *before = strstr(block, "scene:force");
  snprintf(scene, sizeof scene, "%.*sscene:joint { kind = 'fixed', a = body, at = { 0.5, 0, 0.5 } }\n%s",
           (int)(before - block), block, before);
  run("held.lua", scene, "--until 0.1");
  assert_non_null(strstr(r.err, "its pressure does not move it"));
  assert_true(fabs(test_json(r.out, "mean")) < 1e-9);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_block_floats_as_deep_as_its_density_says),
      cmocka_unit_test(the_depth_of_a_block_across_a_plane_is_nothing),
      cmocka_unit_test(a_block_heaves_as_in_potential_theory),
      cmocka_unit_test(a_ball_accelerates_with_its_added_mass),
      cmocka_unit_test(momentum_is_kept),
      cmocka_unit_test(threads_do_not_change_bits),
      cmocka_unit_test(what_is_held_is_a_wall_and_said),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
