/* How exact the sweeps are: to the tolerance where impacts move, and where none does, to what the motion asks for. */
#include "plugins/common/contact/impulses/gauss_seidel.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

/* Two impacts that move by these speeds, m/s, in a step of 1 ms, with 1e-7 m of what moves and 1e-15 m of what rests.
 */
static hk_contact_solver calmed(double one, double other) {
  static hk_impact impact[2];
  hk_contact_solver s = {.count = 2, .impact = impact, .tolerance = 1e-7};
  impact[0].motion = one, impact[1].motion = other;
  hk_gauss_seidel_calm(&s, 1e-3, 1e-15);
  return s;
}

static void the_tolerance_follows_the_largest_motion(void **state) {
  (void)state;
  hk_contact_solver fast = calmed(0, 1), slow = calmed(1e-4, 1e-5), none = calmed(0, 0);
  assert_true(fast.tolerance == 1e-7 && fast.calm == 0);
  assert_true(fabs(slow.tolerance - 1e-9) < 1e-20 && fabs(slow.calm - 0.99) < 1e-12); /* 1e-2 of 1e-3 s by 1e-4 m/s */
  assert_true(none.tolerance == 1e-15 && fabs(none.calm - 1) < 1e-7);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(the_tolerance_follows_the_largest_motion)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
