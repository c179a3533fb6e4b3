/* What a step of a gas costs a cell: a plume in space, all of the step counted (the corrector gas: MacCormack's scheme,
 * buoyancy, confinement, pressure to 1e-6). Time of the one thread, the least and the mean of pieces of five steps. */
#include "tests/support/engine.h"

#include <stdio.h>
#include <time.h>

enum { PIECE = 5, PIECES = 6 };

static double own(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void plume(int n, const char *open) {
  test_engine e;
  double least = INFINITY, sum = 0, dt = 0.25 / n, cells = (double)n * n * n;
  test_engine_open(&e);
  e.options.integrator = "symplectic_euler";
  e.options.dt = dt;
  e.options.threads = 1;
  double source = test_particle(&e, 0.5, 0.5, 0.15, 1);
  test_pin(&e, HK_PIN_FIXED, (uint32_t)source, NULL);
  hk_plugin_spec *gas = test_plugin(&e, HK_CORRECTOR, "gas");
  test_vector(&e, gas, "low", 0, 0, 0);
  test_vector(&e, gas, "high", 1, 1, 1);
  test_number(&e, gas, "cell", 1.0 / n);
  test_text(&e, gas, "open", open);
  test_list(&e, gas, "sources", &source, 1);
  test_number(&e, gas, "source_radius", 0.1);
  test_number(&e, gas, "source_temperature", 350);
  test_number(&e, gas, "source_smoke", 1e-3);
  test_number(&e, gas, "confinement", 0.1);
  test_run(&e);
  for (int k = 1; k <= PIECES; k++) {
    double begin = own();
    test_advance(&e, PIECE * k * dt);
    double time = (own() - begin) / (PIECE * cells);
    least = time < least ? time : least;
    sum += time;
  }
  printf("%8.0f cells, open: %-5s %.3f us a cell and step, %.3f in the mean\n", cells, open, 1e6 * least,
         1e6 * sum / PIECES);
  test_engine_close(&e);
}

int main(void) {
  plume(24, "none");
  plume(24, "sides");
  plume(40, "sides");
  return 0;
}
