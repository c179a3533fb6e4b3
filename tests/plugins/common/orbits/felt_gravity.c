/* The constant of gravitation found in accelerations, and what goes round. */
#include "plugins/common/orbits/felt_gravity.h"
#include "tests/support/fake_system.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

enum { N = 5 };
static const double mass[N] = {1e-3, 2, 3e-4, 5e-5, 7}, G = 39.478;
static const double place[3 * N] = {1, 0, 0.1, 0, 0.01, 0, -5, 0.3, 0, 0.2, 2.6, 0, 4, -4, 4};

static void newton(const double *x, double *a) {
  memset(a, 0, 3 * N * sizeof *a);
  for (size_t i = 0; i < N; i++)
    for (size_t j = 0; j < N; j++) {
      double d[3], square = 0;
      for (size_t c = 0; c < 3; c++) d[c] = x[3 * j + c] - x[3 * i + c], square += d[c] * d[c];
      for (size_t c = 0; c < 3 && i != j; c++) a[3 * i + c] += G * mass[j] * d[c] / (square * sqrt(square));
    }
}

static fake_system *scene(void) {
  fake_system *f = fake_system_create(&(fake_problem){.n = N});
  memcpy(f->mass, mass, sizeof mass);
  memcpy(f->system.X, place, sizeof place);
  return f;
}

static void constant_of_newtons_law_comes_out_to_rounding(void **state) {
  (void)state;
  fake_system *f = scene();
  double a[3 * N];
  uint32_t order[N];
  hk_felt_gravity felt;
  newton(place, a);
  assert_true(hk_felt_gravity_find(&f->host, &f->model, place, a, order, &felt));
  assert_true(fabs(felt.G / G - 1) < 1e-14 && felt.off < 1e-7 && felt.bodies == N);
  assert_true(fabs(felt.others - 2.00135 / 7) < 1e-14);
  static const uint32_t inside_out[N] = {4, 0, 1, 3, 2}; /* by distances from the heaviest: 6.36, 6.93, 8.63, 10.7 */
  assert_memory_equal(order, inside_out, sizeof order);
  fake_system_destroy(f);
}

/* A uniform field is no part of orbits; a spring of 1/s^2 is 3e-3 to 5 % of the pulls. */
static void other_forces_are_left(void **state) {
  (void)state;
  fake_system *f = scene();
  double a[3 * N];
  uint32_t order[N];
  hk_felt_gravity felt;
  newton(place, a);
  for (size_t i = 0; i < N; i++) a[3 * i + 2] += 100;
  assert_true(hk_felt_gravity_find(&f->host, &f->model, place, a, order, &felt));
  assert_true(fabs(felt.G / G - 1) < 1e-12 && felt.off < 1e-6);
  newton(place, a);
  for (size_t e = 0; e < 3 * N; e++) a[e] -= 0.2 * place[e];
  assert_true(hk_felt_gravity_find(&f->host, &f->model, place, a, order, &felt));
  print_message("G is %.3g off, %.3g is left\n", felt.G / G - 1, felt.off);
  assert_true(fabs(felt.G / G - 1) < 0.5 && felt.off > 0.01 && felt.off < 0.9);
  for (size_t e = 0; e < 3 * N; e++) a[e] = -place[e]; /* springs */
  assert_true(hk_felt_gravity_find(&f->host, &f->model, place, a, order, &felt));
  assert_true(felt.off > 0.5);
  for (size_t e = 0; e < 3 * N; e++) a[e] = 0; /* nothing */
  assert_true(hk_felt_gravity_find(&f->host, &f->model, place, a, order, &felt));
  assert_true(felt.off == 1);
  fake_system_destroy(f);
}

static void pinned_and_single_and_coincident_bodies_are_no_orbits(void **state) {
  (void)state;
  fake_system *f = scene();
  double a[3 * N], x[3 * N];
  uint32_t order[N];
  hk_felt_gravity felt;
  newton(place, a);
  memcpy(x, place, sizeof x);
  memcpy(x, x + 3, 3 * sizeof *x);
  assert_true(hk_felt_gravity_find(&f->host, &f->model, x, a, order, &felt));
  assert_true(felt.bodies == N && felt.off == 1);
  for (size_t i = 0; i + 1 < N; i++) f->pin[i] = HK_PIN_FIXED;
  assert_true(hk_felt_gravity_find(&f->host, &f->model, place, a, order, &felt));
  assert_true(felt.bodies == 1 && order[0] == N - 1 && felt.off == 1);
  f->pin[N - 1] = HK_PIN_LINE;
  assert_true(hk_felt_gravity_find(&f->host, &f->model, place, a, order, &felt));
  assert_true(felt.bodies == 0 && felt.off == 1);
  fake_system_destroy(f);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(constant_of_newtons_law_comes_out_to_rounding),
      cmocka_unit_test(other_forces_are_left),
      cmocka_unit_test(pinned_and_single_and_coincident_bodies_are_no_orbits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
