/* What a frame of a melt costs: a figure of wax, head and body, in a box of 64 x 64 x 64 cells, eight particles a cell,
 * whose head a lamp of 4 kW warms from just below its solidus: gravity, heating, grid_conduction, melt and the
 * corrector liquid with a contrast of viscosities of 2e7. Of each frame of 1/30 s the steps, the processor time of all
 * threads and the time that passed, with two threads; the last argument is the number of cells along an axis. */
#include "tests/support/engine.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { FRAMES = 4 };

static const double side = 0.12, density = 780, solidus = 319, capacity = 2000; /* m, kg/m^3, K, J/(kg K) */

static double clock_of(clockid_t which) {
  struct timespec t;
  clock_gettime(which, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static bool in_head(double x, double y, double z) { return x * x + y * y + (z - 0.09) * (z - 0.09) < 0.026 * 0.026; }

static bool in_body(double x, double y, double z) { return z < 0.075 && sqrt(x * x + y * y) < 0.036 - 0.25 * z; }

/* Returns how many particles are in the head, whose ids are `lit`. */
static size_t mould(test_engine *e, double cell, double *lit) {
  const double s = cell / 2, mass = density * s * s * s;
  size_t count = 0;
  int n = (int)(side / s + 0.5);
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++)
      for (int k = 0; k < n; k++) {
        double x = (i + 0.5) * s - side / 2, y = (j + 0.5) * s - side / 2, z = (k + 0.5) * s;
        if (!in_head(x, y, z) && !in_body(x, y, z)) continue;
        uint32_t id = test_particle(e, x, y, z, mass);
        if (in_head(x, y, z)) lit[count++] = id;
      }
  return count;
}

static hk_plugin_spec *wax(test_engine *e, const char *force, bool conducts) {
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, force);
  test_text(e, spec, "channel", "enthalpy");
  test_number(e, spec, "solidus", solidus);
  test_number(e, spec, "liquidus", 329);
  test_number(e, spec, "latent", 200e3);
  test_number(e, spec, "capacity", capacity);
  test_number(e, spec, "capacity_liquid", 2200);
  if (conducts) test_number(e, spec, "conductivity", 0.24), test_number(e, spec, "conductivity_liquid", 0.15);
  return spec;
}

static void box(test_engine *e, hk_plugin_spec *spec, double cell) {
  test_vector(e, spec, "low", -side / 2, -side / 2, 0);
  test_vector(e, spec, "high", side / 2, side / 2, side);
  test_number(e, spec, "cell", cell);
  test_number(e, spec, "density", density);
}

int main(int argc, char **argv) {
  const int n = argc > 1 ? atoi(argv[1]) : 64;
  const double cell = side / n, cold = capacity * (315 - solidus);
  double *lit = malloc(8 * (size_t)n * (size_t)n * (size_t)n * sizeof *lit);
  test_engine e;
  if (!lit) return 1;
  test_engine_open(&e);
  e.options.integrator = "symplectic_euler";
  e.options.threads = 2;
  e.scene->fps = 30;
  e.scene->duration = 10;
  if (hk_scene_add_channel(e.scene, "enthalpy", 1, &cold, NAN, NULL, &e.error) != HK_OK) return 1;
  size_t count = mould(&e, cell, lit);
  test_vector(&e, test_plugin(&e, HK_FORCE, "gravity"), "g", 0, 0, -9.81);
  hk_plugin_spec *lamp = wax(&e, "heating", false);
  test_list(&e, lamp, "particles", lit, count);
  test_number(&e, lamp, "power", 4000 / (double)count);
  box(&e, wax(&e, "grid_conduction", true), cell);
  hk_plugin_spec *melt = wax(&e, "melt", false), *liquid = test_plugin(&e, HK_CORRECTOR, "liquid");
  test_number(&e, melt, "viscosity", 0.05);
  test_number(&e, melt, "solid", 1e6);
  box(&e, liquid, cell);
  test_text(&e, liquid, "viscosity_of", "melt");
  test_run(&e);
  hk_summary s;
  size_t before = 0;
  for (int k = 1; k <= FRAMES; k++) {
    double own = clock_of(CLOCK_PROCESS_CPUTIME_ID), wall = clock_of(CLOCK_MONOTONIC);
    test_advance(&e, k / 30.0);
    hk_run_summary(e.run, &s);
    printf("%d^3 cells, %zu particles, frame %d: %zu steps, %.2f s of the processor, %.2f s\n", n,
           hk_run_view(e.run)->n, k, (size_t)s.steps - before, clock_of(CLOCK_PROCESS_CPUTIME_ID) - own,
           clock_of(CLOCK_MONOTONIC) - wall);
    before = (size_t)s.steps;
  }
  test_engine_close(&e);
  free(lit);
  return 0;
}
