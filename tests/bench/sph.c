/* The plugins of a liquid by particles: the time of an evaluation of sph and of viscosity per particle, of rows that
 * are there, and of ten iterations of incompressible, on lattices shaken by a tenth of their spacing. Times are the
 * processor's, the least of repeats.
 *
 * Ten iterations of incompressible take 0.80 us, 1.13 us with 64,000 particles, of neighbours that are listed once for
 * all of them (plugins/common/sph/sph_list.h), and a whole step with one iteration of each solve 0.57 and 0.73 us. Ten
 * took 4.2 and 5.1 us with neighbours gathered, and their kernels computed, in every pass. An evaluation of sph, two
 * passes of that kind, takes 0.34 to 0.37 us with 32 neighbours.
 */
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

/* A step of the corrector with a given number of iterations of either solve, less one without any, by ten. */
static double step_of(double reach, int side, double iterations) {
  test_engine e;
  test_engine_open(&e);
  fill(&e, side);
  e.scene->threads = 1;
  e.options.dt = 1e-3;
  e.options.integrator = "symplectic_euler";
  hk_plugin_spec *spec = test_plugin(&e, HK_CORRECTOR, "incompressible");
  test_number(&e, spec, "spacing", spacing);
  test_number(&e, spec, "reach", reach);
  test_number(&e, spec, "iterations", iterations);
  test_number(&e, spec, "tolerance", 1e-12);
  test_number(&e, spec, "divergence", 1e-12);
  test_run(&e);
  double least = INFINITY;
  for (int k = 1; k <= 5; k++) {
    double before = now();
    test_advance(&e, 1e-3 * k);
    least = fmin(least, now() - before);
  }
  test_engine_close(&e);
  return least / (side * side * side);
}

int main(void) {
  for (int side = 20; side <= 40; side *= 2) {
    measure("sph", "c", 20, 2.05, side);
    measure("sph", "c", 20, 3, side);
    measure("viscosity", "mu", 1, 3, side);
    double one = 1e9 * step_of(2.05, side, 1), ten = (1e9 * step_of(2.05, side, 11) - one) / 2;
    printf("incompressible, kernel of 2.05 spacings: %.0f ns a particle for 10 iterations, %.0f for a step with one "
           "each\n",
           ten, one);
  }
  return 0;
}
