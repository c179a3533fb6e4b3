/* What a rod of a chain in hinges costs: us a rod and step of leapfrog, in one thread, of chains of 25 to 400 rods that
 * fall from the horizontal; in proportion to their number where the figures are alike. Asked for is 1 us. Runs take
 * turns, and each figure is the least of its runs.
 *
 * A rod takes 48,800 instructions a step (callgrind, 100 rods, 200 steps): 9,300 to factorize, 9,100 for four solutions
 * (three rounds of SHAKE, one of RATTLE), 8,900 to assemble A, 6,200 to add impulses, 4,500 to move riders. Columns of
 * L updated in vectors where their blocks lie below each other, which most do, but few at a time, saved 11 % of the
 * factorization, 2 % of all, and were left out. */
#include "tests/support/command.h"

#include <math.h>
#include <stdio.h>

enum { RUNS = 5, LENGTHS = 5 };

static const char scene[] =
    "local n = param('n', 100, 'rods')\n"
    "local scene = hooke.scene { duration = 0.3, fps = 10, dt = 1 / 2000, integrator = 'leapfrog' }\n"
    "scene:force('gravity', { g = { 0, 0, -9.81 } })\n"
    "local before\n"
    "for k = 1, n do\n"
    "  local rod = scene:rigid { shape = 'box', size = { 0.1, 0.02, 0.02 }, mass = 0.1, position = { 0.1 * k - 0.05, "
    "0, 0 } }\n"
    "  scene:joint { kind = 'hinge', a = rod, b = before, at = { 0.1 * (k - 1), 0, 0 }, axis = { 0, 1, 0 } }\n"
    "  before = rod\n"
    "end\n"
    "return scene\n";

/* us a rod and step. */
static double once(int rods) {
  static test_result result;
  char arguments[256];
  snprintf(arguments, sizeof arguments, "run chain.lua n=%d --threads 1 --no-output --no-check --json", rods);
  test_hooke(&result, NULL, arguments);
  return 1e6 * test_json(result.out, "step_wall_s") / test_json(result.out, "steps") / rods;
}

int main(void) {
  static const int rods[LENGTHS] = {25, 50, 100, 200, 400};
  double least[LENGTHS] = {INFINITY, INFINITY, INFINITY, INFINITY, INFINITY};
  test_write("chain.lua", scene);
  for (int r = 0; r < RUNS; r++)
    for (int k = 0; k < LENGTHS; k++) least[k] = fmin(least[k], once(rods[k]));
  puts("us a rod and step");
  for (int k = 0; k < LENGTHS; k++) printf("%4d rods %8.2f\n", rods[k], least[k]);
  return 0;
}
