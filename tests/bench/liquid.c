/* What a step of a liquid costs a particle: a dam that breaks in space, eight particles a cell, all of the step counted
 * (gravity, symplectic Euler, the corrector liquid). Time of the one thread, the least and the mean of pieces of ten
 * steps, from the column at rest to the front at the other wall. */
#include "tests/support/engine.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { PIECE = 10 };

static double own(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static uint64_t bits = 7;

static double draw(void) {
  bits = bits * 6364136223846793005u + 1442695040888963407u;
  return (double)(bits >> 11) * 0x1p-53;
}

static size_t pour(test_engine *e, double cell) {
  const double s = cell / 2;
  size_t n = 0;
  for (int i = 0; i < (int)(0.5 / s + 0.5); i++)
    for (int j = 0; j < (int)(0.5 / s + 0.5); j++)
      for (int k = 0; k < (int)(1 / s + 0.5); k++, n++)
        test_particle(e, (i + draw()) * s, (j + draw()) * s, (k + draw()) * s, 1000 * s * s * s);
  return n;
}

static void dam(double cell, const char *transfer, int pieces) {
  test_engine e;
  double least = INFINITY, sum = 0, dt = 0.16 * cell;
  test_engine_open(&e);
  e.options.integrator = "symplectic_euler";
  e.options.dt = dt;
  e.options.threads = 1;
  hk_plugin_spec *gravity = test_plugin(&e, HK_FORCE, "gravity");
  test_vector(&e, gravity, "g", 0, 0, -9.81);
  hk_plugin_spec *liquid = test_plugin(&e, HK_CORRECTOR, "liquid");
  test_vector(&e, liquid, "low", 0, 0, 0);
  test_vector(&e, liquid, "high", 2, 0.5, 1.5);
  test_number(&e, liquid, "cell", cell);
  test_text(&e, liquid, "transfer", transfer);
  size_t n = pour(&e, cell);
  test_run(&e);
  for (int k = 1; k <= pieces; k++) {
    double begin = own();
    test_advance(&e, PIECE * k * dt);
    double time = (own() - begin) / (PIECE * (double)n);
    least = fmin(least, time);
    sum += time;
  }
  printf("%-5s %8zu particles, cells of %g m: %.3f us a particle and step, %.3f in the mean\n", transfer, n, cell,
         1e6 * least, 1e6 * sum / pieces);
  test_engine_close(&e);
}

int main(void) {
  dam(1 / 16.0, "apic", 8);
  dam(1 / 32.0, "apic", 8);
  dam(1 / 32.0, "flip", 8);
  dam(1 / 80.0, "apic", 2); /* 1,024,000 */
  return 0;
}
