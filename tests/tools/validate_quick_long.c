/* Every problem of scripts/validation at its coarse levels: each answer is within its tolerance for these. (`make
 * study` has the fine levels and judges orders, too.) */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static test_result r;

static void problems_have_their_known_answers(void **state) {
  (void)state;
  test_hooke(&r, NULL, "validate --quick --no-page --quiet");
  if (r.code != 0) fail_msg("exit %d: %s%s", r.code, r.out, r.err);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(problems_have_their_known_answers)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
