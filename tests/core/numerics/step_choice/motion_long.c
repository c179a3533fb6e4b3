/* Limits of the step in violent motions (violent_motion.h), of three scenes of each kind. */
enum { SEEDS = 3 };
#include "tests/core/numerics/step_choice/violent_motion.h"

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(limits_are_lowered_before_they_are_passed)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
