/* What a force in Lua costs: a step of particles under the force `field`, as a function and as a potential, beside one
 * under `gravity`, in one thread. Runs take turns, and each figure is the least of its runs. */
#include "tests/support/command.h"

#include <math.h>
#include <stdio.h>

enum { RUNS = 7, KINDS = 3, SIDE = 100 };

static const char scene[] =
    "local kind = param('kind', 'gravity', 'of the force')\n"
    "local scene = hooke.scene { duration = 0.1, dt = 0.002, integrator = 'leapfrog' }\n"
    "scene:grid { nx = 100, ny = 100, width = 1, height = 1, mass = 1 }\n"
    "if kind == 'gravity' then scene:force('gravity') end\n"
    "if kind == 'f' then\n"
    "  scene:force('field', { f = function(t, x, y, z, vx, vy, vz, id) return -x, -y, -z end })\n"
    "end\n"
    "if kind == 'potential' then\n"
    "  scene:force('field', { potential = function(t, x, y, z) return 0.5 * (x * x + y * y + z * z) end })\n"
    "end\n"
    "return scene\n";

/* ns a particle and step. */
static double once(const char *kind) {
  static test_result result;
  char arguments[256];
  snprintf(arguments, sizeof arguments, "run field.lua kind=%s --threads 1 --no-output --no-check --json", kind);
  test_hooke(&result, NULL, arguments);
  return 1e9 * test_json(result.out, "step_wall_s") / test_json(result.out, "steps") / (SIDE * SIDE);
}

int main(void) {
  static const char *const kinds[KINDS] = {"gravity", "f", "potential"};
  double least[KINDS] = {INFINITY, INFINITY, INFINITY};
  test_write("field.lua", scene);
  for (int r = 0; r < RUNS; r++)
    for (int k = 0; k < KINDS; k++) least[k] = fmin(least[k], once(kinds[k]));
  puts("ns a particle and step");
  for (int k = 0; k < KINDS; k++) printf("%-10s %8.1f\n", kinds[k], least[k]);
  return 0;
}
