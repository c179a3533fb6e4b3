/* The corrector liquid has one density: particles with the masses of another, or of several, are evened to it in some
 * steps, and would then look right; and two liquids do not meet. All of it is found at the start. */
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

/* Two layers of `below` and `above` kg/m^3, of 12 x 12 cells each, in a liquid of `density`; in one corrector, or in
 * two, each of which has a tank of the same width, the second from x = apart on. */
static const char layers[] =
    "local filling = require('filling')\n"
    "local below, above, density = param('below', 1000, ''), param('above', 1000, ''), param('density', 1000, '')\n"
    "local liquids, apart = param('liquids', 1, ''), param('apart', 0, '')\n"
    "local scene = hooke.scene { duration = 0.1, fps = 20, dt = 0.005, integrator = 'symplectic_euler' }\n"
    "local function layer(x, z, d)\n"
    "  local w = filling.box { low = { x, 0, z }, high = { x + 0.6, 0, z + 0.6 }, cell = 0.05, density = d }\n"
    "  return scene:particles { positions = w.positions, mass = w.mass }\n"
    "end\n"
    "local lower, upper = layer(0, 0, below), layer(apart, 0.6, above)\n"
    "scene:force('gravity', { g = { 0, 0, -9.81 } })\n"
    "local function hold(x, which, name)\n"
    "  scene:corrector('liquid', { low = { x, 0, 0 }, high = { x + 0.6, 0, 1.4 }, cell = 0.05, density = density,\n"
    "    particles = which, label = name })\n"
    "end\n"
    "if liquids == 1 then hold(0, nil, 'liquid') else hold(0, lower, 'one') hold(apart, upper, 'two') end\n"
    "return scene\n";

/* The exit code: 5 is that of a run that is not accurate. */
static int run(const char *options) {
  char words[512];
  snprintf(words, sizeof words, "run %s --no-output --no-check %s", test_write("layers.lua", layers), options);
  test_hooke(&r, NULL, words);
  return r.code;
}

static void says(const char *words) {
  if (!strstr(r.err, words)) fail_msg("'%s' is not in: %s", words, r.err);
}

/* 1 % of the volume is what the verdict allows. Places at random, by 0.2 of their distances, change the mean by 1e-3.
 */
static void a_density_that_is_not_the_liquids_is_not_ok(void **state) {
  (void)state;
  assert_int_equal(run(""), 0);
  assert_int_equal(run("density=995"), 0);
  assert_int_equal(run("density=980"), 5);
  says("will swell by 2");
  assert_int_equal(run("density=1030"), 5);
  says("will shrink by 2.9");
}

/* Layers that differ by 2 %, and by 1 to 2, as heavy ones above, as light ones, and with the mean of the liquid. */
static void several_densities_are_not_ok(void **state) {
  (void)state;
  static const char *const all[] = {"below=1010 above=990", "below=900 above=1100", "below=667 above=1333"};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
    assert_int_equal(run(all[k]), 5);
    says("those of several densities");
  }
}

/* Columns that end at the level of a wave have particles whose masses differ by up to a tenth, and one density. */
static void masses_that_make_up_for_distances_are_ok(void **state) {
  (void)state;
  static const char wave[] =
      "local water = require('filling').box { low = { 0, 0, 0 }, high = { 1, 0, 0.6 }, cell = 0.05,\n"
      "  level = function(x) return 0.5 + 0.08 * math.cos(math.pi * x) end }\n"
      "local scene = hooke.scene { duration = 0.1, fps = 20, dt = 0.005, integrator = 'symplectic_euler' }\n"
      "scene:particles { positions = water.positions, masses = water.masses }\n"
      "scene:force('gravity', { g = { 0, 0, -9.81 } })\n"
      "scene:corrector('liquid', { low = { 0, 0, 0 }, high = { 1, 0, 1 }, cell = 0.05 })\n"
      "return scene\n";
  char words[512];
  snprintf(words, sizeof words, "run %s --no-output --no-check", test_write("level.lua", wave));
  test_hooke(&r, NULL, words);
  assert_int_equal(r.code, 0);
  assert_null(strstr(r.err, "densit"));
}

static void two_liquids_in_one_place_are_refused(void **state) {
  (void)state;
  assert_int_equal(run("liquids=2 apart=0.7"), 0);
  assert_int_equal(run("liquids=2"), 1);
  says("is of another liquid and in the box of this one");
  says("make them one");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_density_that_is_not_the_liquids_is_not_ok),
      cmocka_unit_test(several_densities_are_not_ok),
      cmocka_unit_test(masses_that_make_up_for_distances_are_ok),
      cmocka_unit_test(two_liquids_in_one_place_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
