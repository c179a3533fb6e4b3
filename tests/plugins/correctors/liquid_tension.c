/* Surface tension in whole runs: a drop swings with the period of theory, and its steps are those that the shortest
 * waves allow. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

static const double pi = 3.14159265358979323846, sigma = 162, R = 0.3; /* N/m, m */

typedef struct drop {
  test_engine e;
  size_t n;
} drop;

/* A plane drop in the middle of a box of 1 m, longer along x by the part `longer`, and as much shorter along z. */
static void open_drop(drop *d, double cell, double longer) {
  uint64_t bits = 7;
  d->n = 0;
  test_engine_open(&d->e);
  d->e.options.integrator = "symplectic_euler";
  hk_plugin_spec *liquid = test_plugin(&d->e, HK_CORRECTOR, "liquid");
  test_vector(&d->e, liquid, "low", 0, 0, 0);
  test_vector(&d->e, liquid, "high", 1, 0, 1);
  test_number(&d->e, liquid, "cell", cell);
  test_number(&d->e, liquid, "tension", sigma);
  for (int i = 0; i < (int)(2 / cell + 0.5); i++)
    for (int j = 0; j < (int)(2 / cell + 0.5); j++) {
      double at[2] = {i, j};
      for (int c = 0; c < 2; c++) {
        bits = bits * 6364136223846793005u + 1442695040888963407u;
        at[c] = (at[c] + (double)(bits >> 11) * 0x1p-53) * cell / 2;
      }
      if (hypot((at[0] - 0.5) / (1 + longer), (at[1] - 0.5) * (1 + longer)) < R)
        test_particle(&d->e, at[0], 0, at[1], 1000 * cell * cell * cell / 4), d->n++;
    }
}

/* m^2: by how much it is longer than wide. */
static double length_of(drop *d) {
  double mean[3] = {0}, square[3] = {0};
  for (uint32_t id = 1; id <= d->n; id++)
    for (int c = 0; c < 3; c++) {
      double x = test_position(&d->e, id)[c];
      mean[c] += x / (double)d->n;
      square[c] += x * x / (double)d->n;
    }
  return square[0] - mean[0] * mean[0] - square[2] + mean[2] * mean[2];
}

/* w^2 = n (n^2 - 1) sigma / (rho R^3) with n = 2: Rayleigh 1879, of a jet's cross-section. 7.2 cells in the radius,
 * whose curvature is smoothed over 1.3 of them: the wave of four a circumference is 3 % weaker for it; found was 2.4 %.
 */
static void a_drop_swings_with_the_period_of_theory(void **state) {
  (void)state;
  drop d;
  const double dt = 0.005, half = pi / sqrt(6 * sigma / (1000 * R * R * R));
  double crossing[3], before = 1;
  size_t count = 0;
  open_drop(&d, 1 / 24.0, 0.05);
  test_run(&d.e);
  for (int step = 1; count < 3; step++) {
    assert_true(step < 400);
    test_advance(&d.e, step * dt);
    double now = length_of(&d);
    if (before * now < 0) crossing[count++] = (step - 1 + before / (before - now)) * dt;
    before = now;
  }
  double found = (crossing[2] - crossing[0]) / 2;
  if (!(fabs(found / half - 1) < 0.035)) fail_msg("%.4f instead of %.4f s", found, half);
  test_engine_close(&d.e);
}

/* sqrt(rho h^3 / (4 pi sigma)). */
static void the_shortest_waves_bound_the_step(void **state) {
  (void)state;
  drop d;
  const double cell = 1 / 16.0, wanted = sqrt(1000 * cell * cell * cell / (4 * pi * sigma));
  open_drop(&d, cell, 0);
  test_run(&d.e);
  double found = hk_loop_longest_step(&d.e.run->loop);
  if (!(fabs(found / wanted - 1) < 1e-12)) fail_msg("%g instead of %g s", found, wanted);
  test_engine_close(&d.e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_drop_swings_with_the_period_of_theory),
      cmocka_unit_test(the_shortest_waves_bound_the_step),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
