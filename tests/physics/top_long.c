/* What rounding does to the energy of Lagrange's top in 300 nutations, 480,000 steps of RATTLE (tests/bench/top.c). */
#include "tests/support/command.h"
#include "tests/support/lagrange_top.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Measured: 4.9e-13. Errors of 1.1e-16 of the energy a step that are independent add up to 8e-14, ten times which is
 * the bound; positions that are rounded in every step end at -1.8e-12. */
static void positions_keep_what_rounding_takes_of_them(void **state) {
  static test_result r;
  (void)state;
  test_write("top.lua", lagrange_top);
  test_hooke(&r, NULL, "run top.lua n=300 --threads 1 --no-output --no-check --quiet");
  assert_int_equal(r.code, 0);
  const char *at = strstr(r.err, "300 nutations"); /* its last frame */
  assert_non_null(at);
  double change = strtod(at + strlen("300 nutations"), NULL);
  print_message("change of the energy %.2e\n", change);
  assert_true(fabs(change) < 8e-13);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(positions_keep_what_rounding_takes_of_them)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
