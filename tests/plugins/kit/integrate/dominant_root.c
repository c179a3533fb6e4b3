/* The growth factor from the roots that mostly set it is that of all roots, or NAN; and it is seldom NAN where it is
 * asked for most, next to an explicit method's range of stable steps. */
#include "plugins/kit/integrate/growth_factor.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

enum { MOST = 10 };

static double noise(uint64_t *seed) {
  *seed = *seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(*seed >> 11) * 0x1.0p-53;
}

static void times_linear(int *degree, double *c, double root) {
  c[*degree + 1] = 0;
  for (int k = ++*degree; k > 0; k--) c[k] = c[k - 1] - root * c[k];
  c[0] *= -root;
}

/* Times u^2 - 2 a u + a^2 + b^2, of the roots a +- i b. */
static void times_pair(int *degree, double *c, double a, double b) {
  c[*degree + 1] = c[*degree + 2] = 0;
  *degree += 2;
  for (int k = *degree; k >= 0; k--)
    c[k] = (k > 1 ? c[k - 2] : 0) - 2 * a * (k > 0 ? c[k - 1] : 0) + (a * a + b * b) * c[k];
}

/* Roots lambda = 1 + u, in a ball of the given radius; the largest |lambda|. */
static double add_roots(uint64_t *seed, int *degree, double *c, int count, double radius) {
  double most = 0;
  while (count > 0) {
    double size = radius * noise(seed), angle = 3.141592653589793 * noise(seed);
    most = fmax(most, size);
    if (count > 1 && noise(seed) < 0.5) {
      times_pair(degree, c, size * cos(angle) - 1, size * sin(angle));
      count -= 2;
    } else {
      times_linear(degree, c, (angle < 1.5 ? size : -size) - 1);
      count--;
    }
  }
  return most;
}

/* Roots of no multiplicity are known to rounding times the size of a polynomial's coefficients over its slope there,
 * far below 1e-9; random ones come close to each other now and then. */
static void growth_is_that_of_the_largest_root(void **state) {
  (void)state;
  uint64_t seed = 3;
  size_t found = 0, all = 0;
  for (int run = 0; run < 20000; run++) {
    double c[MOST + 3] = {1}, hw = pow(10, -3 * noise(&seed)), fall = hw * hw * noise(&seed);
    int degree = 0, others = 1 + (int)(noise(&seed) * (MOST - 3));
    times_pair(&degree, c, -fall, hw);
    double exact =
        fmax(sqrt((1 - fall) * (1 - fall) + hw * hw), add_roots(&seed, &degree, c, others, run % 2 ? 0.8 : 2));
    double got = hk_dominant_growth(degree, c);
    found += !isnan(got), all++;
    if (!isnan(got) && !(fabs(got - exact) <= 1e-7 * exact))
      fail_msg("degree %d, run %d: %.17g instead of %.17g", degree, run, got, exact);
  }
  assert_true(found > all / 2);
}

/* A root within the circle by less than the margin is not passed over. */
static void roots_next_to_the_circle_are_told_from_those_within(void **state) {
  (void)state;
  uint64_t seed = 5;
  for (int run = 0; run < 1000; run++) {
    double c[MOST + 3] = {1}, angle = 0.1 + 2.9 * noise(&seed);
    int degree = 0;
    add_roots(&seed, &degree, c, 1 + run % 6, 0.9);
    times_pair(&degree, c, cos(angle) - 1, sin(angle));
    assert_false(hk_roots_within(degree, c, 1 - 1e-7));
    assert_true(hk_roots_within(degree, c, 1 + 1e-7));
  }
}

/* The polynomial of `stoermer`, of order 4: common/multistep/stoermer.c with four terms. */
static void explicit_methods_are_seldom_left_to_all_roots(void **state) {
  (void)state;
  size_t found = 0, all = 0;
  for (double hw = 0.01; hw < 1.6; hw += 0.01)
    for (double part = 0; part < 0.3; part += 0.05, all++) {
      const double z = hw * hw, g = part * hw;
      const double c[] = {
          z, 4 * z + g, 1 + 73 * z / 12 + 3.5 * g, 3 + 4.25 * z + 53 * g / 12, 3 + 7 * z / 6 + 55 * g / 24, 1};
      double complex copy[6];
      for (int k = 0; k < 6; k++) copy[k] = c[k];
      double got = hk_dominant_growth(5, c), exact = hk_complex_polynomial_growth(5, copy);
      found += !isnan(got);
      assert_true(isnan(got) || fabs(got - exact) <= 1e-12 * exact);
    }
  assert_true(found > all * 3 / 4);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(growth_is_that_of_the_largest_root),
      cmocka_unit_test(roots_next_to_the_circle_are_told_from_those_within),
      cmocka_unit_test(explicit_methods_are_seldom_left_to_all_roots),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
