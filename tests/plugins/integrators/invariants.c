/* What integrators keep: the circle, the way back, the energy of orbits over long times. */
#include "tests/support/fake_system.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static void oscillator(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                       double *dy) {
  (void)context, (void)t, (void)v, (void)y, (void)dy;
  for (size_t c = 0; c < 3; c++) a[c] = -x[c];
}

static void kepler(const void *context, double t, const double *x, const double *v, const double *y, double *a,
                   double *dy) {
  (void)context, (void)t, (void)v, (void)y, (void)dy;
  double r2 = x[0] * x[0] + x[1] * x[1], r3 = r2 * sqrt(r2);
  a[0] = -x[0] / r3;
  a[1] = -x[1] / r3;
}

static const fake_problem unit_oscillator = {1, 0, HK_DEPENDS_ON_X, oscillator, NULL};
static const fake_problem unit_kepler = {1, 0, HK_DEPENDS_ON_X, kepler, NULL};

/* 4 roundings of x, v, their squares and the root: 1e-15. */
static void euler_leaves_the_circle_by_its_factor_each_step(void **state) {
  (void)state;
  const double h = 0.1;
  fake_system *f = fake_system_create(&unit_oscillator);
  double *X = f->system.X;
  X[0] = 1;
  fake_method m = fake_method_open("euler", f);
  for (int i = 0; i < 100; i++) {
    double before = hypot(X[0], X[3]);
    assert_int_equal(fake_method_step(&m, h, NULL), HK_OK);
    assert_true(fabs(hypot(X[0], X[3]) / before - sqrt(1 + h * h)) < 1e-15);
  }
  fake_method_close(&m);
  fake_system_destroy(f);
}

static double stated(const fake_method *m, double hw) { return fake_method_growth(m, hw, 0, 0); }

/* The last h w at which the method states no growth. */
static double limit(const fake_method *method) {
  double low = 0, high = 10;
  for (double z = 0.01; z < 10 && stated(method, z) <= 1 + 1e-9; z += 0.01) low = z;
  for (high = low + 0.01; high - low > 1e-9;) {
    double middle = (low + high) / 2;
    if (stated(method, middle) <= 1 + 1e-9)
      low = middle;
    else
      high = middle;
  }
  return low;
}

/* How far from the start one ends after `steps` forwards and as many with the velocity reversed, at 0.9 of the limit.
 */
static double way_back(const char *name, size_t steps, bool *claims) {
  fake_system *f = fake_system_create(&unit_oscillator);
  double *X = f->system.X;
  for (size_t e = 0; e < 6; e++) X[e] = 1 - (double)e / 7;
  fake_method m = fake_method_open(name, f);
  const hk_integrator *method = m.plugin->integrator;
  *claims = fake_method_explicit(&m) && (method->flags & HK_REVERSIBLE);
  double h = 0.9 * limit(&m), error = 0;
  for (int leg = 0; leg < 2; leg++) {
    fake_method_run(&m, f->system.t + h * (double)steps, steps);
    for (size_t c = 3; c < 6; c++) X[c] = -X[c];
    if (method->reset) method->reset(m.self, HK_STATE_CHANGED);
  }
  for (size_t e = 0; e < 6; e++) error = fmax(error, fabs(X[e] - (1 - (double)e / 7)));
  fake_method_close(&m);
  fake_system_destroy(f);
  return error;
}

/* 1000 steps there and back; rounding of 1e-16 a step, at most doubled by the shear of the motion near the limit:
 * 1e-11. rk4 damps there: at 0.9 of its limit by 0.63 a step. */
static void reversible_methods_return_at_nine_tenths_of_their_limit(void **state) {
  const char *names[FAKE_METHODS];
  size_t count = fake_integrator_names(names), claimed = 0;
  (void)state;
  for (size_t k = 0; k < count; k++) {
    bool claims;
    fake_system *f = fake_system_create(&unit_oscillator);
    fake_method m = fake_method_open(names[k], f);
    claims = fake_method_explicit(&m) && m.plugin->integrator->flags & HK_REVERSIBLE;
    fake_method_close(&m);
    fake_system_destroy(f);
    if (!claims) continue;
    claimed++;
    double error = way_back(names[k], 1000, &claims);
    if (!(error < 1e-11)) fail_msg("%s comes back to %g", names[k], error);
  }
  assert_true(claimed > 0);
  bool claims;
  assert_true(way_back("rk4", 100, &claims) > 0.1 && !claims);
}

static double orbit_energy(const double *X) {
  return (X[3] * X[3] + X[4] * X[4]) / 2 - 1 / sqrt(X[0] * X[0] + X[1] * X[1]);
}

/* Largest error of the energy, -1/2, in the first `early` orbits and in all; e = 0.6, references.md 10.6. */
static void energy_errors(const char *name, size_t orbits, size_t early, size_t steps, double *first, double *all) {
  fake_system *f = fake_system_create(&unit_kepler);
  double *X = f->system.X, h = 2 * acos(-1) / (double)steps;
  X[0] = 0.4;
  X[4] = 2;
  fake_method m = fake_method_open(name, f);
  *first = *all = 0;
  for (size_t i = 0; i < orbits * steps; i++) {
    assert_int_equal(fake_method_step(&m, h, NULL), HK_OK);
    *all = fmax(*all, fabs(orbit_energy(X) + 0.5));
    if (i < early * steps) *first = *all;
  }
  fake_method_close(&m);
  fake_system_destroy(f);
}

/* A bounded error has shown its size after a while: as the ellipse turns, steps meet the pericentre at all phases
 * within some orbits. 5 % is what rarer phases may add. rk4, given as many evaluations, drifts. */
static void symplectic_methods_keep_keplers_energy_over_10000_orbits(void **state) {
  double first, all;
  (void)state;
  energy_errors("leapfrog", 10000, 500, 240, &first, &all);
  print_message("leapfrog: energy error %.2e after 500 orbits, %.2e after 10000\n", first, all);
  assert_true(all < 1.05 * first && all < 0.05);
  energy_errors("blanes_moan", 10000, 500, 40, &first, &all);
  print_message("blanes_moan: energy error %.2e after 500 orbits, %.2e after 10000\n", first, all);
  assert_true(all < 1.05 * first && all < 0.01);
  energy_errors("kahan_li8", 10000, 500, 60, &first, &all);
  print_message("kahan_li8: energy error %.2e after 500 orbits, %.2e after 10000\n", first, all);
  /* Its ellipse turns so slowly that 500 orbits do not meet all phases of the steps; an error that grows with time
   * would have grown 20 times. */
  assert_true(all < 3 * first && all < 1e-7);
  energy_errors("rk4", 200, 10, 60, &first, &all);
  assert_true(all > 2 * first);
}

/* x = 1 + t needs no force; the sum of 1e6 roundings of 1e-16 of x <= 11 is below 1e-9 even if all have one sign, where
 * x' - 2x + x_before would have let them grow to their count squared, 1e-4. */
static void stoermer_does_not_let_rounding_grow(void **state) {
  (void)state;
  fake_system *f = fake_system_create(&(fake_problem){1, 0, HK_DEPENDS_ON_X, oscillator, NULL});
  double *X = f->system.X, h = 1e-5;
  X[0] = 1;
  fake_method m = fake_method_open("stoermer", f);
  for (size_t i = 0; i < 1000000; i++) assert_int_equal(fake_method_step(&m, h, NULL), HK_OK);
  if (!(fabs(X[0] - cos(f->system.t)) < 1e-9)) fail_msg("error %g", fabs(X[0] - cos(f->system.t)));
  fake_method_close(&m);
  fake_system_destroy(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(euler_leaves_the_circle_by_its_factor_each_step),
      cmocka_unit_test(reversible_methods_return_at_nine_tenths_of_their_limit),
      cmocka_unit_test(symplectic_methods_keep_keplers_energy_over_10000_orbits),
      cmocka_unit_test(stoermer_does_not_let_rounding_grow),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
