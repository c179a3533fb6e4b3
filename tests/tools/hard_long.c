/* All runs of the corpus of hard cases (hard_corpus.h). Sanitizers look for other faults than wrong verdicts, which are
 * the same in their builds, so they see every eighth run: of
 * sixteen the ninth here, the first in hard.c. */
#include "tests/tools/hard_corpus.h"

static void no_run_says_ok_beyond_its_bound(void **state) {
  (void)state;
  hard_corpus_holds(strstr(HK_BUILD, "sanitize") ? "--part 9/16" : "");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(no_run_says_ok_beyond_its_bound)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
