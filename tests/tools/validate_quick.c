/* The kinds of problems of scripts/validation that take least, at their coarse levels: each answer is within its
 * tolerance for these. validate_quick_long.c has all kinds. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

static test_result r;

static void cheap_problems_have_their_known_answers(void **state) {
  (void)state;
  static const char *const topics[] = {"boxes",       "constraints", "fields",     "fit",      "friction",
                                       "gases",       "limits",      "mechanisms", "optimise", "orbits",
                                       "oscillators", "rigid",       "rolling",    "strings",  "waves"};
  for (size_t k = 0; k < sizeof topics / sizeof *topics; k++) {
    char words[128];
    snprintf(words, sizeof words, "validate %s --quick --no-page --quiet", topics[k]);
    test_hooke(&r, NULL, words);
    if (r.code != 0) fail_msg("%s: exit %d: %s%s", topics[k], r.code, r.out, r.err);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(cheap_problems_have_their_known_answers)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
