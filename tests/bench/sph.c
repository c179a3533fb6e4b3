/* The forces of a liquid by particles, sph and viscosity: the time of an evaluation per particle, of rows that are
 * there and of rows that are found at every fifth one as in a run, on lattices shaken by a tenth of their spacing.
 * Times are the processor's, the least of repeats. */
#include "tests/support/force_check.h"

#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { REPEATS = 15 };
static const double spacing = 0.05, shake = 0.1;

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void fill(test_engine *e, int side) {
  uint64_t seed[4];
  hk_random_seed(seed, 1);
  for (int i = 0; i < side * side * side; i++) {
    double x[3];
    for (int c = 0, at = i; c < 3; c++, at /= side)
      x[c] = spacing * (at % side + shake * (hk_random_uniform(seed) - 0.5));
    test_particle(e, x[0], x[1], x[2], 1000 * spacing * spacing * spacing);
  }
}

static void measure(const char *name, const char *parameter, double value, double reach, int side) {
  test_engine e;
  test_engine_open(&e);
  fill(&e, side);
  e.scene->threads = 1;
  e.options.dt = 1e-5;
  hk_plugin_spec *spec = test_plugin(&e, HK_FORCE, name);
  test_number(&e, spec, "spacing", spacing);
  test_number(&e, spec, "reach", reach);
  test_number(&e, spec, parameter, value);
  test_run(&e);
  hk_instance *force = test_instance(&e, spec);
  hk_view view = force_view(&e, force);
  double *F = calloc(3 * view.n, sizeof *F), least = INFINITY;
  if (!F) exit(1);
  for (int r = 0; r < REPEATS; r++) {
    double before = now();
    if (force->plugin->force->add(force->self, &view, F) != HK_OK) exit(1);
    least = fmin(least, now() - before);
  }
  printf("%-9s %6zu particles, kernel of %.2f spacings: %5.0f ns a particle\n", name, view.n, reach,
         1e9 * least / (double)view.n);
  free(F);
  test_engine_close(&e);
}

int main(void) {
  for (int side = 20; side <= 40; side *= 2) {
    measure("sph", "c", 20, 2.05, side);
    measure("sph", "c", 20, 3, side);
    measure("viscosity", "mu", 1, 3, side);
  }
  return 0;
}
