/* The force of gravitation is such that the acceleration that the host makes of it, by 1/m, has no bias. */
#include "tests/support/engine.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

enum { BODIES = 20000 };

static double noise(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) * 0x1.0p-53;
}

/* A mass between 1 and 2 whose inverse is off by nearly half of its last digit, to either side. */
static double mass_of(int side) {
  double most = 0, found = 1;
  for (int k = 1; k < 1000; k++) {
    double m = 1 + k / 1000.0, off = side * fma(1 / m, m, -1);
    if (off > most) most = off, found = m;
  }
  assert_true(most > 0.9 * DBL_EPSILON / 2);
  return found;
}

/* The mean relative error of the components of F (1/m), of many bodies about one at the origin. */
static double bias(double m) {
  test_engine e;
  uint64_t seed = 7;
  double *F = malloc(3 * (BODIES + 1) * sizeof *F), sun = 1, inverse = 1 / m;
  long double sum = 0;
  test_engine_open(&e);
  test_plugin(&e, HK_INTEGRATOR, "leapfrog");
  test_particle(&e, 0, 0, 0, 1);
  for (int k = 0; k < BODIES; k++) test_particle(&e, 1 + noise(&seed), 1 + noise(&seed), 1 + noise(&seed), m);
  hk_plugin_spec *nbody = test_plugin(&e, HK_FORCE, "nbody");
  test_number(&e, nbody, "G", 1);
  test_text(&e, nbody, "method", "direct");
  test_list(&e, nbody, "sources", &sun, 1);
  e.options.dt = 1e-3;
  test_run(&e);
  assert_int_equal(hk_run_forces(e.run, 0, F, &e.error), HK_OK);
  const double *x = hk_run_view(e.run)->x;
  for (size_t i = 1; i <= BODIES; i++) {
    long double r2 = 0;
    for (size_t c = 0; c < 3; c++) r2 += (long double)x[3 * i + c] * x[3 * i + c];
    for (size_t c = 0; c < 3; c++) {
      long double a = -x[3 * i + c] / (r2 * sqrtl(r2));
      sum += (F[3 * i + c] * inverse - a) / a;
    }
  }
  test_engine_close(&e);
  free(F);
  return (double)(sum / (3 * BODIES));
}

/* Roundings of some 2e-16 leave 2e-18 in the mean of 20,000 forces. */
static void accelerations_have_no_bias_for_any_mass(void **state) {
  (void)state;
  double of_one = bias(1);
  for (int side = -1; side <= 1; side += 2) {
    double of_mass = bias(mass_of(side));
    print_message("mass %g: %.1e, mass 1: %.1e\n", mass_of(side), of_mass, of_one);
    assert_true(fabs(of_mass - of_one) < 1e-17);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(accelerations_have_no_bias_for_any_mass)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
