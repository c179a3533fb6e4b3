/* A million random fields of 3 x 3 x 3 values, half of them integers that often equal the level, by both methods.
 * Sanitizers, under which a field takes five times as long and which see the same lines in any of them, get every
 * ninth. */
#include "tests/plugins/common/isosurface/random_fields.h"

static void a_million_random_fields_have_manifold_surfaces(void **state) {
  (void)state;
  const uint64_t step = strstr(HK_BUILD, "sanitize") ? 9 : 1; /* odd: of integers and of others in turn */
  for (uint64_t number = 0; number < 48; number += step)      /* of 28^3 fields */
    for (int method = 0; method < 2; method++)
      check_random_fields((hk_isosurface_method)method, number % 2, 28, 100 + number);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_million_random_fields_have_manifold_surfaces)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
