/* Every 64th run of the corpus of hard cases (hard_corpus.h); hard_long.c takes all. And a hooke that cannot run
 * all. */
#include "tests/tools/hard_corpus.h"

static test_result r;

static void no_run_says_ok_beyond_its_bound(void **state) {
  (void)state;
  hard_corpus_holds("--part 1/64");
}

/* A hooke that was built without the plugins for tests, here a copy: cases that need them are left out, with a word. */
static void cases_without_their_plugins_are_left_out(void **state) {
  (void)state;
  test_hooke(&r,
             "mkdir -p copy/build copy/core && cp -r " HK_ROOT "/tools " HK_ROOT "/scripts copy/ && cp " HK_ROOT
             "/core/plugin.h copy/core/ && cp -r " HK_BUILD "/hooke " HK_BUILD "/plugins " HK_BUILD
             "/tools copy/build/ && copy/build/hooke stability --hard " HK_ROOT "/tests/hard --integrators leapfrog "
             "--quiet --case free_fall --case births --case floor_catches && ",
             "--version");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  assert_non_null(strstr(r.err, "2 of 3 cases are left out (births, floor_catches): their plugins for tests, such as "
                                "sower.so, are not built; make test-programs builds them"));
  assert_non_null(strstr(r.out, "1 cases"));
  test_hooke(&r, NULL, "stability --hard nowhere");
  assert_true(r.code == 1 &&
              strstr(r.err, "nowhere is not a folder of cases; hooke's sources have some in tests/hard"));
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(cases_without_their_plugins_are_left_out),
                                     cmocka_unit_test(no_run_says_ok_beyond_its_bound)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
