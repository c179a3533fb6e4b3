/* Limits of the step in violent motions (violent_motion.h), of three scenes of each kind. */
enum { SEEDS = 3 };
#include "tests/core/numerics/step_choice/violent_motion.h"

/* The limits are the same under sanitizers, and motion.c runs the same code. */
static void of_three_scenes_of_each_kind(void **state) {
  if (strstr(HK_BUILD, "sanitize")) skip();
  limits_are_lowered_before_they_are_passed(state);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(of_three_scenes_of_each_kind)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
