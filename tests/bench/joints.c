/* What a rod of a chain in hinges costs: us a rod and step of leapfrog, in one thread, of chains of 25 to 400 rods that
 * fall from the horizontal; in proportion to their number where the figures are alike. Asked for is 1 us. Runs take
 * turns, and each figure is the least of its runs.
 *
 * A rod takes 9,100 instructions a step (callgrind, the difference of 140 and 40 steps; of 10 rods 9,800, as bodies are
 * kept eight at a time and steps have their own cost, of 1,000 rods 8,800). It took 11,900 (12,700, 11,400) while links
 * were evaluated through their constraints and the riders' places, and 47,800 while all equations were factorized
 * together. By the processor's time of runs that take turns it is 1.35 us in place of 1.7; 1 us is not reached. It goes
 * into four solutions of the tree (1,500: three rounds of SHAKE, one of RATTLE), its factors (1,200), gradients as
 * wrenches (1,000), what the equations are in each round (730), distances within bodies (880), riders in the
 * evaluation (1,200), turning bodies (440), and the step and the rest of the evaluation (2,000). The third round is the
 * last one that counts: violations are 2e-9, 3e-12 and 1e-14 m, the last being rounding of coordinates of 10 m.
 *
 * MuJoCo 4.0.0's Euler (tests/bench/joints.py), in reduced coordinates, takes 0.4 us of 10 rods, 0.7 of 100, 6.4 of
 * 400: its mass matrix fills in along the chain. */
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
