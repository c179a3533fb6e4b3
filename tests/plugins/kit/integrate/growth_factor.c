/* The growth factor of a real cubic in closed form is that of Laguerre's method, which is general, and takes the same
 * side of 1 + 2e-7, from where on a step counts as one that grows. */
#include "plugins/kit/integrate/leapfrog_growth.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

/* Rounding moves double roots by its square root, times |u|; at critical damping they occur. */
static const double tolerance = 3e-7;

/* c_k of the roots u = r and those of u^2 + p u + q. */
static bool compare(double r, double p, double q) {
  const double c[4] = {-r * q, q - r * p, p - r, 1};
  double complex copy[4] = {c[0], c[1], c[2], c[3]};
  double general = hk_complex_polynomial_growth(3, copy), closed = hk_cubic_growth(c);
  if (isnan(closed)) return false;
  if (!(fabs(closed - general) <= tolerance * general))
    fail_msg("u = %g and p, q = %g, %g: %.17g in closed form, %.17g by Laguerre", r, p, q, closed, general);
  assert_true((closed > 1 + 2e-7) == (general > 1 + 2e-7));
  return true;
}

static void cubics_in_closed_form_are_as_by_laguerre(void **unused) {
  size_t all = 0, closed = 0;
  (void)unused;
  for (double r = -6; r < 6; r += 0.7)
    for (double p = -5; p < 5; p += 0.23)
      for (double q = -4; q < 6; q += 0.19) compare(r, p, q);
  for (double hw = 1e-4; hw < 4; hw *= 1.07)
    for (double hg = 1e-5; hg < 4; hg *= 1.2, all++) {
      const double z = hw * hw, c[] = {z, 2 * z + hg, 1 + z + 1.5 * hg, 1};
      double complex copy[4] = {c[0], c[1], c[2], c[3]};
      double general = hk_complex_polynomial_growth(3, copy), got = hk_cubic_growth(c);
      closed += !isnan(got);
      assert_true(isnan(got) || fabs(got - general) <= tolerance * general);
      assert_true((hk_leapfrog_growth(hw, hg, 0) > 1 + 2e-7) == (general > 1 + 2e-7));
    }
  assert_true(closed > all * 3 / 4);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(cubics_in_closed_form_are_as_by_laguerre)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
