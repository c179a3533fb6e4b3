/* What is too thin for the cells of a liquid is in its summary, and a run of little else is not ok. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>

#include <cmocka.h>

static test_result r;

/* Cells of 1 cm with eight particles each: a ball, or what fills a box in the one of 20 cells a side. */
static const char *const scene =
    "local cell, radius, deep = 0.01, param('radius', 0, 'cells'), param('deep', 0, 'cells')\n"
    "local s, d = hooke.scene { duration = 0.1, fps = 50, integrator = 'symplectic_euler' }, cell / 2\n"
    "for i = -20, 19 do for j = -20, 19 do for k = -20, 19 do\n"
    "  local x, y, z = (i + 0.5) * d, (j + 0.5) * d, (k + 0.5) * d\n"
    "  if x * x + y * y + z * z < (radius * cell) ^ 2 or z + 10 * cell < deep * cell then\n"
    "    s:particle { position = { x, y, z }, mass = 1000 * d ^ 3 }\n"
    "  end\n"
    "end end end\n"
    "local side = 10 * cell\n"
    "s:corrector('liquid', { low = { -side, -side, -side }, high = { side, side, side }, cell = cell })\n"
    "return s\n";

static double thin(const char *options, int code) {
  char call[512];
  snprintf(call, sizeof call, "run %s --json --no-output --quiet --no-check %s", test_write("scene.lua", scene),
           options);
  test_hooke(&r, NULL, call);
  assert_int_equal(r.code, code);
  return test_json(r.out, "below_3_cells");
}

/* A block of three cells has the centres of those at its corners 1.7 cells from its middle, so that a ball of less
 * holds none; one of five cells in radius is full of them. */
static void small_drops_are_not_ok(void **state) {
  (void)state;
  assert_true(thin("radius=1.4", 5) == 1);
  assert_true(thin("radius=1.8", 5) == 1);
  assert_true(thin("radius=5", 0) < 0.1);
}

/* Walls count as liquid: what lies on them is held by them. */
static void films_on_walls_are_ok(void **state) {
  (void)state;
  assert_true(thin("deep=2", 0) == 0);
}

/* By cells: a ball of 32 beside 800 of a pool is 0.04 of all. */
static void a_drop_beside_a_pool_is_little(void **state) {
  (void)state;
  double part = thin("deep=2 radius=1.8", 0);
  assert_true(part > 0.03 && part < 0.05);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(small_drops_are_not_ok),
      cmocka_unit_test(films_on_walls_are_ok),
      cmocka_unit_test(a_drop_beside_a_pool_is_little),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
