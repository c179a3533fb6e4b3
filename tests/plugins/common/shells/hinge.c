/* Derivatives of a hinge's angle. */
#include "plugins/common/shells/hinge.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

/* Central differences of the gradient over d = 1e-5. Where the second derivatives are M, lengths of about M^(-1/2) are
 * the hinge's, so that the fourth ones are some ten times M^2, by which the differences are off by d^2; by rounding of
 * the gradient 1e-16 M^(1/2)/d, and some. */
static void the_hessian_is_how_the_gradient_changes(void **state) {
  (void)state;
  static const uint32_t member[4] = {2, 0, 3, 1};
  for (int trial = 0; trial < 50; trial++) {
    double x[12], H[144], angle, more[4][3], less[4][3], most = 0;
    for (int e = 0; e < 12; e++) x[e] = sin(7.3 * e + trial) + (e / 3 == 3);
    hk_hinge_hessian(x, member, H);
    for (int e = 0; e < 144; e++) most = fmax(most, fabs(H[e]));
    assert_true(most > 0);
    for (uint32_t c = 0; c < 12 && most < 1e3; c++) { /* others are too thin for d */
      double *moved = &x[3 * member[c / 3] + c % 3], before = *moved;
      *moved = before + 1e-5;
      hk_hinge_angle(x, member, &angle, more);
      *moved = before - 1e-5;
      hk_hinge_angle(x, member, &angle, less);
      *moved = before;
      for (int r = 0; r < 12; r++) {
        double change = (more[r / 3][r % 3] - less[r / 3][r % 3]) / 2e-5;
        assert_true(fabs(change - H[12 * r + (int)c]) < 1e-7 * fmax(1, most * most));
      }
    }
  }
}

/* Without area there is no angle, and nothing changes. */
static void a_flat_triangle_has_none(void **state) {
  (void)state;
  const double x[12] = {0, 0, 0, 1, 0, 0, 2, 0, 0, 0, 1, 0};
  double H[144];
  hk_hinge_hessian(x, (const uint32_t[]){0, 1, 2, 3}, H);
  for (int r = 0; r < 144; r++) assert_true(H[r] == 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_hessian_is_how_the_gradient_changes),
      cmocka_unit_test(a_flat_triangle_has_none),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
