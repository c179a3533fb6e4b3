/* Lengths as equations: J is dg/dx and the curvature d^2 g/dt^2 along straight moves, by central differences; where
 * ends coincide both are 0. */
#include "plugins/common/lengths/lengths.h"

#include <setjmp.h>
#include <stdarg.h>

#include <cmocka.h>

enum { N = 4, EDGES = 3 };
static const uint32_t pair[EDGES][2] = {{0, 1}, {1, 2}, {3, 0}};
static double given[EDGES] = {1, 0.4, 2};
static hk_lengths lengths = {{EDGES, 2, &pair[0][0]}, {EDGES, given}};
static const double x0[3 * N] = {0, 0, 0, 0.3, 0.4, 1.2, -0.5, 0.1, 0.9, 2, -1, 0.2};
static const double v0[3 * N] = {1, 0, 2, -0.5, 0.7, 0.1, 0.2, 0.3, -1, 0, 0, 0.5};

static void value_at(const double *x, double g[EDGES]) {
  hk_view view = {.n = N, .x = x, .v = v0};
  assert_int_equal(hk_lengths_value(&lengths, &view, g), HK_OK);
}

static void the_value_is_the_given_length_without_the_present_one(void **state) {
  (void)state;
  double g[EDGES];
  value_at(x0, g);
  assert_int_equal(hk_lengths_count(&lengths), EDGES);
  assert_true(fabs(g[0] - (1 - 1.3)) < 1e-15); /* 0.3, 0.4, 1.2: 1.3 */
}

/* h = 1e-5: off by h^2 times third derivatives of order 1/L^2, 10, and by rounding, 1e-16/h. */
static void the_jacobian_is_the_derivative_of_the_value(void **state) {
  (void)state;
  const double h = 1e-5;
  double J[2 * EDGES][3], g[2][EDGES];
  hk_view view = {.n = N, .x = x0, .v = v0};
  assert_int_equal(hk_lengths_jacobian(&lengths, &view, J), HK_OK);
  for (size_t e = 0; e < EDGES; e++)
    for (size_t end = 0; end < 2; end++)
      for (size_t c = 0; c < 3; c++) {
        for (int side = 0; side < 2; side++) {
          double x[3 * N];
          for (size_t k = 0; k < sizeof x / sizeof *x; k++) x[k] = x0[k];
          x[3 * pair[e][end] + c] += side ? h : -h;
          value_at(x, g[side]);
        }
        assert_true(fabs((g[1][e] - g[0][e]) / (2 * h) - J[2 * e + end][c]) < 1e-8);
      }
}

/* Second differences with h = 1e-4: off by h^2 times fourth derivatives, some 1,000 here, and by 1e-16/h^2. */
static void the_curvature_is_the_second_derivative_of_a_straight_move(void **state) {
  (void)state;
  const double h = 1e-4;
  double c[EDGES], g[3][EDGES];
  hk_view view = {.n = N, .x = x0, .v = v0};
  assert_int_equal(hk_lengths_curvature(&lengths, &view, c), HK_OK);
  for (int side = 0; side < 3; side++) {
    double x[3 * N];
    for (size_t k = 0; k < sizeof x / sizeof *x; k++) x[k] = x0[k] + (side - 1) * h * v0[k];
    value_at(x, g[side]);
  }
  for (size_t e = 0; e < EDGES; e++) assert_true(fabs((g[2][e] - 2 * g[1][e] + g[0][e]) / (h * h) - c[e]) < 2e-5);
}

static void coinciding_ends_have_no_direction(void **state) {
  (void)state;
  double J[2 * EDGES][3], c[EDGES], x[3 * N];
  for (size_t k = 0; k < sizeof x / sizeof *x; k++) x[k] = x0[k % 3];
  hk_view view = {.n = N, .x = x, .v = v0};
  assert_int_equal(hk_lengths_jacobian(&lengths, &view, J), HK_OK);
  assert_int_equal(hk_lengths_curvature(&lengths, &view, c), HK_OK);
  for (size_t e = 0; e < 2 * EDGES; e++) assert_true(J[e][0] == 0 && J[e][1] == 0 && J[e][2] == 0);
  for (size_t e = 0; e < EDGES; e++) assert_true(c[e] == 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_value_is_the_given_length_without_the_present_one),
      cmocka_unit_test(the_jacobian_is_the_derivative_of_the_value),
      cmocka_unit_test(the_curvature_is_the_second_derivative_of_a_straight_move),
      cmocka_unit_test(coinciding_ends_have_no_direction),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
