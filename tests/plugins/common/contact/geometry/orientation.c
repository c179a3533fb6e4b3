/* Signs of determinants against exact rationals: random, within some units in the last place of a plane or a line, of
 * points that lie in one, and of numbers as different as doubles can be. */
#include "plugins/common/contact/geometry/orientation.h"
#include "tests/plugins/common/contact/geometry/rational.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

static uint64_t seed = 1;

static uint64_t bits(void) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return seed >> 11;
}
static double noise(void) { return (double)bits() * 0x1.0p-52 - 1; } /* in [-1, 1) */
static int below(int n) { return (int)(bits() % (uint64_t)n); }

static int exact2d(const double x[3][2]) {
  q_reset(0);
  num u[2], v[2];
  for (int c = 0; c < 2; c++) u[c] = q_sub(q(x[1][c]), q(x[0][c])), v[c] = q_sub(q(x[2][c]), q(x[0][c]));
  return mpq_sgn(q_sub(q_mul(u[0], v[1]), q_mul(u[1], v[0])));
}

static int exact3d(const double x[4][3]) {
  q_reset(0);
  vec a = v_of(x[0]);
  return mpq_sgn(v_dot(v_cross(v_sub(v_of(x[1]), a), v_sub(v_of(x[2]), a)), v_sub(v_of(x[3]), a)));
}

/* Also that exchanging two points changes the sign. */
static int check3d(const double x[4][3]) {
  int s = exact3d(x);
  assert_int_equal(hk_orient3d(x[0], x[1], x[2], x[3]), s);
  assert_int_equal(hk_orient3d(x[1], x[0], x[2], x[3]), -s);
  assert_int_equal(hk_orient3d(x[0], x[1], x[3], x[2]), -s);
  assert_int_equal(hk_orient3d(x[3], x[2], x[1], x[0]), s);
  return s;
}

static int check2d(const double x[3][2]) {
  int s = exact2d(x);
  assert_int_equal(hk_orient2d(x[0], x[1], x[2]), s);
  assert_int_equal(hk_orient2d(x[1], x[0], x[2]), -s);
  assert_int_equal(hk_orient2d(x[2], x[0], x[1]), s);
  return s;
}

/* Some units in the last place up or down. */
static double nudge(double x) {
  for (int k = below(4); k > 0; k--) x = nextafter(x, below(2) ? INFINITY : -INFINITY);
  return x;
}

/* The last point in the plane, or on the line, of the others, but for rounding. */
static void combine(double *last, const double *first, int n, int dimensions, const double *weight) {
  for (int c = 0; c < dimensions; c++) {
    last[c] = 0;
    for (int k = 0; k < n; k++) last[c] += weight[k] * first[dimensions * k + c];
    last[c] = nudge(last[c]);
  }
}

static void signs_are_exact_near_planes_and_lines(void **state) {
  (void)state;
  int zeros = 0, ones = 0;
  for (int k = 0; k < 30000; k++) {
    double x[4][3], y[3][2], s = noise(), t = 2 * noise(), size = k % 3 ? 1 : ldexp(1, below(400) - 200);
    for (int i = 0; i < 9; i++) x[i / 3][i % 3] = (k % 2 ? noise() : (below(33) - 16) / 16.0) * size;
    for (int i = 0; i < 4; i++) y[i / 2][i % 2] = x[i / 2][i % 2];
    combine(x[3], x[0], 3, 3, (double[]){1 - s - t, s, t});
    combine(y[2], y[0], 2, 2, (double[]){1 - t, t});
    int sign = check3d((const double(*)[3])x);
    check2d((const double(*)[2])y);
    zeros += sign == 0, ones += sign == 1;
  }
  assert_true(zeros > 20 && ones > 5000);
}

static void points_of_a_grid_lie_in_planes(void **state) {
  (void)state;
  int zeros = 0;
  for (int k = 0; k < 20000; k++) {
    double x[4][3], y[3][2], step = k % 2 ? 0.1 : 0.25; /* 0.1 i is rounded: nearly in a plane */
    for (int i = 0; i < 12; i++) x[i / 3][i % 3] = below(6) * step;
    for (int i = 0; i < 6; i++) y[i / 2][i % 2] = below(6) * step;
    zeros += check3d((const double(*)[3])x) == 0;
    check2d((const double(*)[2])y);
  }
  assert_true(zeros > 1000);
}

/* Any finite numbers: with all exponents, subnormal ones, zeros of both signs, the largest. */
static double anything(void) {
  switch (below(8)) {
  case 0:
    return 0;
  case 1:
    return -0.0;
  case 2:
    return DBL_MAX * (below(2) ? 1 : -1);
  case 3:
    return ldexp(noise(), -1070);
  case 4:
    return noise();
  case 5:
    return ldexp(noise(), 1023);
  default:
    return ldexp(noise(), below(2090) - 1070);
  }
}

static void no_number_is_too_large_or_too_small(void **state) {
  (void)state;
  for (int k = 0; k < 20000; k++) {
    double x[4][3], y[3][2], few[4];
    for (int i = 0; i < 4; i++) few[i] = anything();
    for (int i = 0; i < 12; i++) x[i / 3][i % 3] = k % 2 ? anything() : few[below(4)];
    for (int i = 0; i < 6; i++) y[i / 2][i % 2] = k % 2 ? anything() : few[below(4)];
    check3d((const double(*)[3])x);
    check2d((const double(*)[2])y);
  }
  const double flat[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.2, 0.3, DBL_TRUE_MIN}};
  assert_int_equal(hk_orient3d(flat[0], flat[1], flat[2], flat[3]), 1);
}

static void what_is_not_finite_has_no_sign(void **state) {
  (void)state;
  const double a[3] = {0, 0, 0}, b[3] = {1, 0, 0}, c[3] = {0, 1, 0};
  for (int k = 0; k < 3; k++) {
    double d[3] = {0.2, 0.3, 1};
    d[k] = k % 2 ? NAN : INFINITY;
    assert_int_equal(hk_orient3d(a, b, c, d), 0);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(signs_are_exact_near_planes_and_lines),
      cmocka_unit_test(points_of_a_grid_lie_in_planes),
      cmocka_unit_test(no_number_is_too_large_or_too_small),
      cmocka_unit_test(what_is_not_finite_has_no_sign),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
