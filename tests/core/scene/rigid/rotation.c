/* Quaternions and matrices are each other's, in all quadrants; what is no rotation is seen. */
#include "core/scene/rigid/rigid.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void quaternions_and_matrices_go_over_into_each_other(void **state) {
  (void)state;
  const double list[6][4] = {{1, 0, 0, 0},      {0, 1, 0, 0},         {0.5, 0.5, -0.5, 0.5},
                             {0, 0.6, 0, -0.8}, {0.1, 0.7, 0.1, 0.7}, {0.001, 0, -1, 0}};
  for (int k = 0; k < 6; k++) {
    double q[4], R[9], back[4], length = 0, product = 0;
    for (int c = 0; c < 4; c++) length += list[k][c] * list[k][c];
    for (int c = 0; c < 4; c++) q[c] = list[k][c] / sqrt(length);
    hk_rotation_of_quaternion(q, R);
    assert_true(hk_rotation_error(R) < 1e-15);
    hk_quaternion_of(R, back);
    for (int c = 0; c < 4; c++) product += q[c] * back[c];
    assert_true(fabs(fabs(product) - 1) < 1e-15 && back[0] >= 0);
  }
}

static void reflections_and_shears_are_seen(void **state) {
  (void)state;
  assert_true(hk_rotation_error((const double[9]){1, 0, 0, 0, 1, 0, 0, 0, -1}) == 2);
  assert_true(hk_rotation_error((const double[9]){1, 0.1, 0, 0, 1, 0, 0, 0, 1}) > 0.09);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(quaternions_and_matrices_go_over_into_each_other),
      cmocka_unit_test(reflections_and_shears_are_seen),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
