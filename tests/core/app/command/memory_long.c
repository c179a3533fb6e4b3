/* Memory that fails: tests/fixtures/failing_memory.c makes allocation k of a run fail, for k all over the run. The run
 * then ends with a message and the code 1, or 2 where the memory was that of the loader of plugins or within a library
 * which says no more than that it failed; or it does without. It never crashes, hangs or fails in silence. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const char scene[] = "local scene = hooke.scene { duration = 0.05, fps = 60, dt = 1/120 }\n"
                            "local rope = scene:strand { n = 4, from = {0, 0, 0}, to = {1, 0, 0}, mass = 0.1 }\n"
                            "scene:pin { 1 }\n"
                            "scene:force('gravity', {})\n"
                            "scene:force('springs', { edges = rope:edges(), k = 100, damping = 0.1 })\n"
                            "scene:measure('low', function(s) return s:position(4)[3] end)\n"
                            "scene:output('table', {})\n"
                            "return scene\n";

static void try_all(const char *options) {
  static test_result r;
  static const char before[] = "rm -rf log out; OPENBLAS_NUM_THREADS=1 FAILING_MEMORY=log FAILING_MEMORY_OUT=out "
                               "LD_PRELOAD=" HK_BUILD "/tests/fixtures/failing_memory.so";
  char arguments[256], path[4096], kind;
  long number, said, tried = 0, told = 0;
  int code;
  test_write("tiny.lua", scene);
  snprintf(arguments, sizeof arguments, "run tiny.lua --trust --quiet --threads 1 --out out %s", options);
  test_hooke(&r, before, arguments);
  if (r.code != 0 && r.code != 5) fail_msg("%s: code %d: %s", options, r.code, r.err);
  snprintf(path, sizeof path, "%s/log", test_folder());
  FILE *log = fopen(path, "r");
  assert_non_null(log);
  for (; fscanf(log, "%ld %c %d %ld", &number, &kind, &code, &said) == 4; tried++) {
    bool ran = code == 0 || code == 5; /* inaccurate: the method damps */
    if (kind != 'e' || (!ran && code != 1 && code != 2))
      fail_msg("%s: allocation %ld: %c %d", options, number, kind, code);
    if (!ran && said == 0) fail_msg("%s: allocation %ld: code %d without a word", options, number, code);
    told += !ran;
  }
  fclose(log);
  print_message("%s: %ld allocations failed, %ld of them ended the run\n", options, tried, told);
  assert_true(tried > 300 && told > 30);
}

static void no_allocation_that_fails_crashes_a_run(void **state) {
  (void)state;
  if (strstr(HK_BUILD, "sanitize")) skip(); /* it has an allocator of its own */
  try_all("--integrator leapfrog");
  try_all("--integrator backward_euler");
}

/* Of the process that tells others what to do: allocation k alone, and from k on all, for k in steps of a fifth. */
static void try_tool(const char *arguments) {
  static test_result r;
  char before[512];
  int failed = 0;
  for (int alone = 0; alone < 2; alone++)
    for (long k = 3; k < 400000; k += k / 5 + 1) {
      snprintf(before, sizeof before,
               "rm -rf out; %s FAILING_MEMORY_AT=%ld OPENBLAS_NUM_THREADS=1 "
               "LD_PRELOAD=" HK_BUILD "/tests/fixtures/failing_memory.so",
               alone ? "" : "FAILING_MEMORY_ON=1", k);
      test_hooke(&r, before, arguments);
      bool ended = r.code == 0 || r.code == 1;
      if (!ended || (r.code == 1 && !*r.err)) fail_msg("%s: allocation %ld: code %d: %s", arguments, k, r.code, r.err);
      if (r.code == 0 && !alone && k > 1000) break; /* there are no more */
      failed += r.code == 1;
    }
  print_message("%s: it failed %d times\n", arguments, failed);
  assert_true(failed > 20);
}

static void no_allocation_that_fails_crashes_a_tool(void **state) {
  (void)state;
  if (strstr(HK_BUILD, "sanitize")) skip(); /* it has an allocator of its own */
  test_write("tool.lua", "local k = param('k', 100, 'stiffness')\n"
                         "local scene = hooke.scene { duration = 0.05, fps = 60, dt = 1/240 }\n"
                         "local rope = scene:strand { n = 4, from = {0, 0, 0}, to = {1, 0, 0}, mass = 0.1 }\n"
                         "scene:pin { 1 }\n"
                         "scene:force('gravity', {})\n"
                         "scene:force('springs', { edges = rope:edges(), k = k })\n"
                         "return scene\n");
  try_tool("sweep tool.lua k=100,200 --quiet -j 1");
  try_tool("bench tool.lua --target 1e-2 --finest 1e-3 --integrators leapfrog,rk4 --quiet");
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(no_allocation_that_fails_crashes_a_run),
                                     cmocka_unit_test(no_allocation_that_fails_crashes_a_tool)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
