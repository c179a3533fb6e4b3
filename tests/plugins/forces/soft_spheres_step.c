/* The largest stable step of grains: what their contacts can be at most, against those that they have. */
#include "core/numerics/stability/stability.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>

static const double R = 0.1, K = 1000, MASS = 0.01; /* m, N/m, kg */

/* w_max^2 over k/m of grains in a row that touch, smooth ones. */
static double largest(size_t n) {
  test_engine e;
  hk_spectrum spectrum;
  test_engine_open(&e);
  for (size_t i = 0; i < n; i++) test_particle(&e, 1.999 * R * (double)i, 0, 0, MASS);
  hk_plugin_spec *s = test_plugin(&e, HK_FORCE, "soft_spheres");
  test_number(&e, s, "radius", R);
  test_number(&e, s, "stiffness", K);
  test_number(&e, s, "restitution", 1);
  test_number(&e, s, "friction", 0);
  test_plugin(&e, HK_INTEGRATOR, "leapfrog");
  test_run(&e);
  assert_int_equal(hk_spectrum_estimate(&e.run->dynamics.system, &spectrum, &e.error), HK_OK);
  test_engine_close(&e);
  return spectrum.w_max * spectrum.w_max * MASS / K;
}

/* Two have one contact, w^2 = 2 k/m, three two, whose bound is 4 k/m where 3 k/m is true. Many may have a dozen each,
 * which add up to 5.2 along an axis by caps (crowd.c), and to 10.4 k/m. */
static void no_more_touch_than_there_are(void **state) {
  (void)state;
  assert_true(fabs(largest(2) - 2) < 1e-6);
  assert_true(fabs(largest(3) - 4) < 1e-6);
  double many = largest(9);
  print_message("9 grains: %.4g k/m\n", many);
  assert_true(many > 8 && many < 10.5);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(no_more_touch_than_there_are)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
