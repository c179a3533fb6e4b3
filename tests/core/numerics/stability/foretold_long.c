/* The foretold largest stable step against the truth (foretold.h), for charges on springs. */
#include "tests/core/numerics/stability/foretold.h"

/* Where a method loses its stability by turning, the fastest mode is taken to be turned as fast as any, which it mostly
 * is not. */
static void of_charges_on_springs(void **state) {
  (void)state;
  survey(SPRINGS | MAGNETIC, "rk4");
}

static void of_charges_on_damped_springs(void **state) {
  (void)state;
  survey(SPRINGS | DAMPING | MAGNETIC, "rk4");
}

static void of_charges_on_springs_in_a_drag(void **state) {
  (void)state;
  survey(SPRINGS | DAMPING | MAGNETIC | DRAG, NULL);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(of_charges_on_springs),
                                     cmocka_unit_test(of_charges_on_damped_springs),
                                     cmocka_unit_test(of_charges_on_springs_in_a_drag)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
