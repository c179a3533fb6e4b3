/* material = "name": the numbers that it stands for, what goes before it, a scene's own materials, and names that there
 * are not. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static test_result r;

#define OPEN "local scene = hooke.scene { duration = 0 }\n"

/* The measure m of a scene with a square of 2 x 2 cells, 1 m^2. */
static double measured(const char *grid, const char *forces, const char *expression) {
  char scene[2048];
  snprintf(scene, sizeof scene,
           OPEN "local c = scene:grid { nx = 3, ny = 3, %s }\n%s\n"
                "scene:measure('m', function(s) return %s end)\nreturn scene\n",
           grid, forces, expression);
  test_write("material.lua", scene);
  test_hooke(&r, NULL, "run material.lua --json --quiet");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  return test_json(r.out, "m");
}

/* A corner has a quarter of a cell of 1/4 m^2. */
static void builders_take_the_density(void **state) {
  (void)state;
  assert_true(fabs(measured("material = 'cotton'", "", "s:mass(1)") - 0.220 / 16) < 1e-15);
  assert_true(fabs(measured("material = 'cotton', density = 2", "", "s:mass(1)") - 2.0 / 16) < 1e-15);
  assert_true(fabs(measured("material = 'rubber'", "", "s:mass(1)") - 930 * 0.3e-3 / 16) < 1e-15);
}

/* At a rest scale of 1/s all is pulled by s, and the energy is that of the model for the numbers of the table. */
static void forces_take_their_numbers(void **state) {
  (void)state;
  const double e = (1.1 * 1.1 - 1) / 2, area = 1 / (1.1 * 1.1);
  double cotton = area * e * e / 2 * (2016.55456 + 2 * 9.170511 + 2034.97644);
  double t = pow(1.1, 4), rubber = area * 0.39e6 * 0.3e-3 / 2 * (2 * 1.21 - 2 + 1 / t - 1);
  assert_true(
      fabs(measured("mass = 1", "scene:force('membrane', { material = 'cotton', rest = 1 / 1.1 })", "s:potential()") /
               cotton -
           1) < 1e-13);
  assert_true(
      fabs(measured("mass = 1", "scene:force('membrane', { material = 'rubber', rest = 1 / 1.1 })", "s:potential()") /
               rubber -
           1) < 1e-12);
  double twice = measured(
      "mass = 1", "scene:force('membrane', { material = 'rubber', rest = 1 / 1.1, stiffness = 702 })", "s:potential()");
  assert_true(fabs(twice / rubber - 2) < 1e-12); /* what is given goes first: 2 x 351 N/m */
}

static void every_material_has_all_its_numbers(void **state) {
  (void)state;
  static const char *const all[] = {"cotton", "denim", "polyester", "knit", "silk", "rubber"};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
    char grid[64], forces[512];
    snprintf(grid, sizeof grid, "material = '%s'", all[k]);
    snprintf(forces, sizeof forces,
             "scene:force('membrane', { material = '%s', rest = 0.9 })\n"
             "scene:force('hinges', { material = '%s', rest = 1 })\n"
             "scene:force('quadratic_bending', { material = '%s' })\n",
             all[k], all[k], all[k]);
    assert_true(measured(grid, forces, "s:potential()") > 0);
  }
}

static void a_scene_may_have_its_own(void **state) {
  (void)state;
  test_write("material_numbers.lua", "return { tin = { grid = { density = 3 } } }\n");
  double mass = measured("material = 'tin'", "", "s:mass(1)");
  const char *path = test_write("material_numbers.lua", "return 7\n");
  test_refused(OPEN "scene:grid { nx = 2, ny = 2, material = 'tin' }\n", "", 1,
               "bad.lua:2: grid: material: the module 'material_numbers' gives no table");
  assert_int_equal(remove(path), 0);
  assert_true(fabs(mass - 3.0 / 16) < 1e-15);
}

static void names_that_there_are_not_are_refused(void **state) {
  (void)state;
  test_refused(OPEN "scene:grid { nx = 2, ny = 2, material = 'coton' }\n", "", 1,
               "bad.lua:2: grid: material: there is no 'coton'; did you mean 'cotton'? There are cotton, denim, knit, "
               "polyester, rubber, silk");
  test_refused(OPEN "scene:grid { nx = 2, ny = 2, material = 7 }\n", "", 1, "grid: material: expected a name");
  test_refused(OPEN "scene:force('gravity', { material = 'silk' })\n", "", 1,
               "bad.lua:2: gravity: material: 'silk' has nothing for it, but for grid, hinges, membrane, mesh, "
               "quadratic_bending");
  test_refused(OPEN "scene:grid { nx = 2, ny = 2, mass = 1, material = 'silk' }\n", "", 1,
               "grid: give mass or density, not both");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(builders_take_the_density),
      cmocka_unit_test(forces_take_their_numbers),
      cmocka_unit_test(every_material_has_all_its_numbers),
      cmocka_unit_test(a_scene_may_have_its_own),
      cmocka_unit_test(names_that_there_are_not_are_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
