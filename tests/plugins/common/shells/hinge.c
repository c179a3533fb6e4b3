/* Derivatives of a hinge's angle. */
#include "plugins/common/shells/hinge.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/* The product is the Hessian's, which is symmetric, up to rounding in sums of twelve numbers. */
static void the_product_with_the_hessian_is_that_of_its_rows(void **state) {
  (void)state;
  static const uint32_t member[4] = {2, 0, 3, 1};
  for (int trial = 0; trial < 50; trial++) {
    double x[12], u[12], H[144], Hu[12], most = 0;
    for (int e = 0; e < 12; e++) {
      x[e] = sin(7.3 * e + trial) + (e / 3 == 3);
      u[e] = cos(2.9 * e - 3 * trial);
    }
    hk_hinge_hessian(x, member, H);
    hk_hinge_hessian_product(x, member, u, Hu);
    for (int e = 0; e < 144; e++) most = fmax(most, fabs(H[e]));
    assert_true(most > 0);
    for (int r = 0; r < 12; r++) {
      double sum = 0;
      for (int c = 0; c < 12; c++) sum += H[12 * r + c] * u[c];
      assert_true(fabs(sum - Hu[r]) < 1e-13 * 12 * most);
    }
  }
}

/* Without area there is no angle, and nothing changes. */
static void a_flat_triangle_has_none(void **state) {
  (void)state;
  const double x[12] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 1, 0}, u[12] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 2, 3};
  double Hu[12];
  hk_hinge_hessian_product(x, (const uint32_t[]){0, 1, 2, 3}, u, Hu);
  for (int r = 0; r < 12; r++) assert_true(Hu[r] == 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_product_with_the_hessian_is_that_of_its_rows),
      cmocka_unit_test(a_flat_triangle_has_none),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
