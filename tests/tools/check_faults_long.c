/* hooke check: the faults of forces and explicit methods, and all of those of which check.c tries some, are named. */
#include "tests/tools/check_faults.h"

static void faults_of_forces_and_explicit_methods_are_named(void **state) {
  (void)state;
  right_and_wrong_of("force", 62, long_step());
  right_and_wrong_of("integrator", 42, long_step());
}

/* check.c tries some of these. */
static void other_faults_are_named(void **state) {
  (void)state;
  static const char *const tables[] = {"habits", "parts",    "contact",    "multistep", "adaptive",
                                       "tiles",  "implicit", "neighbours", "octree",    "bvh"};
  for (size_t k = 0; k < sizeof tables / sizeof *tables; k++) right_and_wrong_of(tables[k], 1, long_step());
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(faults_of_forces_and_explicit_methods_are_named),
                                     cmocka_unit_test(other_faults_are_named)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
