/* The corpus of hard cases, tests/hard: every integrator reaches a case's bound or says that it did not, and those that
 * have to reach it do. Runs of at most 15,000 steps; `make study` holds the long ones. */
#ifndef HK_TEST_HARD_CORPUS_H
#define HK_TEST_HARD_CORPUS_H

#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* Run by run, no "ok" beyond its bound. `part`: "--part 1/16", or "" for all. */
static inline void hard_corpus_holds(const char *part) {
  static test_result r;
  char arguments[512];
  snprintf(arguments, sizeof arguments, "stability --hard %s/tests/hard --trust --quiet --timeout 300 %s", HK_ROOT,
           part);
  test_hooke(&r, NULL, arguments);
  const char *counts = strstr(r.out, "\nslowest");
  print_message("%s", counts ? counts : r.out);
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  assert_non_null(strstr(r.out, " 0 failed"));
  assert_null(strstr(r.err, "left out"));
}

#endif
