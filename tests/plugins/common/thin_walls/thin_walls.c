/* Cloth in a liquid, in whole runs: under a column of water it sags as the closed form says and holds it, a hull of it
 * floats as deep as its mass says, a closed bag keeps its water, and pins forbid what they do elsewhere. */
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

/* A strip across a tank of 1 m, as deep as a cell, of springs without a length of their own: their pull is T = 10 kN/m
 * along the tank wherever they go. 0.5 m of thick water stand on it, with air below. y'' = -(rho g (H + y - mean) +
 * w)/T, with the mass 20 kg/m^2 of the strip: y in the middle is `expect`. */
static const char strip[] =
    "local cell, z0, flat = 0.0625, param('z0', 0.5, 'm', {}), param('flat', 0, '', {})\n"
    "local n, depth, mass, pull = 16, 0.5, 20, 10000\n"
    "local scene = hooke.scene { duration = 0.6, fps = 20, dt = 0.0025, integrator = 'symplectic_euler' }\n"
    "local water = require('filling').box { low = { 0, 0, z0 }, high = { 1, cell, z0 + depth }, cell = cell }\n"
    "scene:particles { positions = water.positions, mass = water.mass }\n"
    "local strip = scene:grid { nx = n + 1, ny = 2, width = 1, height = cell, mass = mass * cell,\n"
    "  origin = { 0, 0, z0 - 1e-4 }, u = { 1, 0, 0 }, v = { 0, 1, 0 } }\n"
    "local edges = {}\n"
    "for j = 1, 2 do\n"
    "  for i = 1, n do edges[#edges + 1] = { strip:at(i, j), strip:at(i + 1, j) } end\n"
    "  for i = 2, n do if flat == 1 then scene:pin(strip:at(i, j), { normal = { 0, 0, 1 } }) end end\n"
    "  scene:pin(strip:at(1, j)) scene:pin(strip:at(n + 1, j))\n"
    "end\n"
    "scene:force('springs', { edges = edges, k = pull * cell / 2 * n, rest = 0 })\n"
    "scene:force('gravity', { g = { 0, 0, -9.81 } })\n"
    "scene:corrector('liquid', { low = { 0, 0, 0 }, high = { 1, cell, z0 + 0.75 }, cell = cell, viscosity = 20 })\n"
    "scene:measure('sag', function(s)\n"
    "  return z0 - (s:position(strip:at(9, 1))[3] + s:position(strip:at(9, 2))[3]) / 2 end)\n"
    "scene:measure('lowest', function(s)\n"
    "  local least = 1\n"
    "  for id = 1, #water.positions do least = math.min(least, s:position(id)[3]) end\n"
    "  return z0 - least end)\n"
    "scene:measure('expect', function()\n"
    "  local k = math.sqrt(9810 / pull) local b = math.tan(k / 2) / (k / 2) - 1\n"
    "  return (depth + mass / 1000) / (1 + b) * (1 / math.cos(k / 2) - 1) end)\n"
    "return scene\n";

/* Found: 0.7 and 0.8 % off with 16 cells, wherever the strip is among them. Water that had run through would lie on the
 * floor, 0.5 m below. */
static void a_strip_sags_under_water_and_holds_it(void **state) {
  (void)state;
  static const char *const words[] = {"", "z0=0.52"};
  for (int k = 0; k < 2; k++) {
    run("strip.lua", strip, words[k]);
    double sag = test_json(r.out, "sag"), expected = test_json(r.out, "expect"), lowest = test_json(r.out, "lowest");
    if (!(fabs(sag / expected - 1) < 0.015)) fail_msg("%.5f instead of %.5f m", sag, expected);
    if (!(lowest < 1.05 * expected)) fail_msg("water %.5f m below the strip's ends", lowest);
  }
}

/* Pins that let the strip slide along itself alone make it a floor. */
static void a_strip_that_pins_keep_flat_is_a_floor(void **state) {
  (void)state;
  run("floor.lua", strip, "flat=1 --until 0.2");
  assert_true(fabs(test_json(r.out, "sag") - 1e-4) < 1e-12);
  double lowest = test_json(r.out, "lowest");
  if (!(lowest < 1e-4)) fail_msg("water %.5f m below the strip", lowest);
}

/* A hull of cloth, stiffened by springs between all of its points, half as wide as its tank, with the mass of 0.15 m of
 * water below it. It starts 0.03 m too high, over 0.03 m more of water: half of this is how much higher it floats. */
static const char hull[] =
    "local cell, H, W, draft, off = 0.0625, 0.4, 0.5, 0.15, 0.03\n"
    "local scene = hooke.scene { duration = 1, fps = 20, dt = 0.0025, integrator = 'symplectic_euler' }\n"
    "local water = require('filling').box { low = { 0, 0, 0 }, high = { 1, cell, H }, cell = cell,\n"
    "  inside = function(x, _, z) return math.abs(x - 0.5) > W / 2 or z < H - draft + off end }\n"
    "scene:particles { positions = water.positions, mass = water.mass }\n"
    "local profile, vertices, faces, edges = {}, {}, {}, {}\n"
    "for k = 6, 1, -1 do profile[#profile + 1] = { -W / 2, 0.05 * k } end\n"
    "for k = 0, 10 do profile[#profile + 1] = { 0.05 * k - W / 2, 0 } end\n"
    "for k = 1, 6 do profile[#profile + 1] = { W / 2, 0.05 * k } end\n"
    "for _, p in ipairs(profile) do\n"
    "  for j = 0, 1 do vertices[#vertices + 1] = { 0.5 + p[1], j * cell, H - draft + off + p[2] } end\n"
    "end\n"
    "for a = 1, #vertices - 3, 2 do\n"
    "  faces[#faces + 1] = { a, a + 2, a + 1 } faces[#faces + 1] = { a + 1, a + 2, a + 3 } end\n"
    "local boat = scene:mesh { vertices = vertices, faces = faces, mass = 1000 * draft * W * cell }\n"
    "local ids = boat:ids()\n"
    "for a = 1, #ids do for b = a + 1, #ids do edges[#edges + 1] = { ids[a], ids[b] } end end\n"
    "scene:force('springs', { edges = edges, k = 300, damping = 0.02 })\n"
    "scene:force('gravity', { g = { 0, 0, -9.81 } })\n"
    "scene:corrector('liquid', { low = { 0, 0, 0 }, high = { 1, cell, 0.8 }, cell = cell, viscosity = 5 })\n"
    "local function height(s)\n"
    "  local sum, mass = 0, 0\n"
    "  for _, id in ipairs(ids) do\n"
    "    sum, mass = sum + s:mass(id) * s:position(id)[3], mass + s:mass(id) end\n"
    "  return sum / mass end\n"
    "local start\n"
    "scene:measure('rise', function(s) start = start or height(s) - off return height(s) - start end)\n"
    "return scene\n";

/* 2 % of the draft; found were 1.1 %, and 0.1 % with cells of half the size. */
static void a_hull_of_cloth_floats_as_deep_as_its_mass_says(void **state) {
  (void)state;
  run("hull.lua", hull, "");
  double rise = test_json(r.out, "rise");
  if (!(fabs(rise - 0.015) < 0.02 * 0.15)) fail_msg("%.5f instead of 0.015 m", rise);
}

/* A tube of cloth full of water, as long as a cell is deep, hangs on its highest points, falls into them and swings.
 * Its springs are of 40 kN/m, and its points stay in their planes, so that its ends stay shut. */
static const char bag[] =
    "local cell, n, R, X, Z = 0.0625, 32, 0.3, 0.5, 0.6\n"
    "local scene = hooke.scene { duration = 0.4, fps = 20, dt = 0.0005, integrator = 'symplectic_euler' }\n"
    "local water = require('filling').box { low = { 0, 0, 0 }, high = { 1, cell, 1 }, cell = cell,\n"
    "  inside = function(x, _, z) return (x - X)^2 + (z - Z)^2 < R * R * 0.96 end }\n"
    "scene:particles { positions = water.positions, mass = water.mass }\n"
    "local vertices, faces = {}, {}\n"
    "for k = 0, n - 1 do\n"
    "  local t, a, b = 2 * math.pi * k / n, 2 * k + 1, 2 * ((k + 1) % n) + 1\n"
    "  for j = 0, 1 do vertices[#vertices + 1] = { X + R * math.sin(t), j * cell, Z + R * math.cos(t) } end\n"
    "  faces[#faces + 1] = { a, b, a + 1 } faces[#faces + 1] = { a + 1, b, b + 1 }\n"
    "end\n"
    "local tube = scene:mesh { vertices = vertices, faces = faces, mass = 8 }\n"
    "local ids = tube:ids()\n"
    "for k = 1, 2 * n do scene:pin(ids[k], k > 2 and { normal = { 0, 1, 0 } } or nil) end\n"
    "scene:force('springs', { edges = tube:edges(), k = 40000, damping = 5 })\n"
    "scene:force('gravity', { g = { 0, 0, -9.81 } })\n"
    "scene:corrector('liquid', { low = { 0, 0, 0 }, high = { 1, cell, 1.2 }, cell = cell })\n"
    "local function ring(s)\n"
    "  local r = {}\n"
    "  for k = 1, n do\n"
    "    local p, q = s:position(ids[2 * k - 1]), s:position(ids[2 * k])\n"
    "    r[k] = { (p[1] + q[1]) / 2, 0, (p[3] + q[3]) / 2 } end\n"
    "  return r end\n"
    "scene:measure('area', function(s)\n"
    "  local r, sum = ring(s), 0\n"
    "  for k = 1, n do local p, q = r[k], r[k % n + 1] sum = sum + (q[1] * p[3] - p[1] * q[3]) / 2 end\n"
    "  return sum end)\n"
    "scene:measure('outside', function(s)\n"
    "  local r, count = ring(s), 0\n"
    "  for id = 1, #water.positions do\n"
    "    local x, odd = s:position(id), false\n"
    "    for k = 1, n do\n"
    "      local p, q = r[k], r[k % n + 1]\n"
    "      if (p[3] > x[3]) ~= (q[3] > x[3]) and x[1] < p[1] + (q[1] - p[1]) * (x[3] - p[3]) / (q[3] - p[3]) then\n"
    "        odd = not odd end\n"
    "    end\n"
    "    if not odd then count = count + 1 end\n"
    "  end\n"
    "  return count end)\n"
    "return scene\n";

/* The tube's polygon is 0.281 m^2, of which water is 96 %; it stays between these. Pressures of a closed part that were
 * known but for a constant blew it up, and cells that cloth cuts, taken for air, let it empty. */
static void a_closed_bag_keeps_its_water(void **state) {
  (void)state;
  run("bag.lua", bag, "");
  double area = test_json(r.out, "area"), outside = test_json(r.out, "outside");
  if (!(outside == 0)) fail_msg("%g particles outside", outside);
  if (!(area > 0.265 && area < 0.285)) fail_msg("%.4f m^2", area);
}

static void threads_do_not_change_bits(void **state) {
  (void)state;
  run("hull1.lua", hull, "--until 0.1 --threads 1");
  double one = test_json(r.out, "rise");
  run("hull3.lua", hull, "--until 0.1 --threads 3");
  assert_true(test_json(r.out, "rise") == one && one != 0.03);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_strip_sags_under_water_and_holds_it),
      cmocka_unit_test(a_strip_that_pins_keep_flat_is_a_floor),
      cmocka_unit_test(a_hull_of_cloth_floats_as_deep_as_its_mass_says),
      cmocka_unit_test(a_closed_bag_keeps_its_water),
      cmocka_unit_test(threads_do_not_change_bits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
