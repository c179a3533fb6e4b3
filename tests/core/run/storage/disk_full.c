/* The disk is full at call k of a run that changes a file, for every k: the code is 4 with a sentence that has the
 * cause, or nothing is missing; what an earlier run left is whole, and so is what belongs to others. */
#include "tests/support/failing_writes.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static const char scene[] = "local v = param('v', 1)\n"
                            "local s = hooke.scene { duration = 0.2, fps = 10, dt = 0.05, integrator = 'leapfrog' }\n"
                            "s:particle { position = {0, 0, 1}, velocity = {v, 0, 0} }\n"
                            "s:measure('z', function(q) return q:position(1)[1] end)\n"
                            "s:output('table', {})\n"
                            "if param('recorded', 0) == 1 then s:output('trajectory', {}) end\n"
                            "if param('pictures', 0) == 1 then\n"
                            "  s:output('frames', { width = 16, height = 16, video = false })\n"
                            "end\n"
                            "return s\n";

static test_result r;
static test_disk disk;
static bool all; /* an argument is given: every call is tried, which takes some minutes */

static void shell(const char *format, ...) {
  char command[4096], inside[2048];
  va_list arguments;
  va_start(arguments, format);
  vsnprintf(inside, sizeof inside, format, arguments);
  va_end(arguments);
  snprintf(command, sizeof command, "cd '%s' && { %s; }", test_folder(), inside);
  if (system(command) != 0) fail_msg("%s", command);
}

static bool holds(const char *condition) {
  char command[1024];
  snprintf(command, sizeof command, "cd '%s' && { %s; } >/dev/null 2>&1", test_folder(), condition);
  return system(command) == 0;
}

/* Runs it on a copy of the folder "before", with call k failing. */
static void run_on_copy(const char *into, long k, const char *arguments) {
  shell("rm -rf '%s' && cp -r before '%s'", into, into);
  test_hooke_on_disk(&r, &disk, into, k, ENOSPC, arguments);
}

/* A table of one particle, to its end: of the time when the run ended. */
static bool is_whole_table(const char *name) {
  char path[1024], text[1024];
  snprintf(path, sizeof path, "%s/%s", test_folder(), name);
  FILE *file = fopen(path, "r");
  size_t got = file ? fread(text, 1, sizeof text - 1, file) : 0;
  if (file) fclose(file);
  text[got] = 0;
  const char *row = strchr(text, '\n');
  int commas = 0;
  for (const char *c = row ? row : text; *c; c++) commas += *c == ',';
  return row && commas == 7 && text[got - 1] == '\n';
}

static void complain(long k, const char *arguments, const char *what) {
  fail_msg("%s: call %ld (%s): %s; exit %d: %s", arguments, k, disk.where, what, r.code, r.err);
}

static void check(long k, const char *arguments) {
  if (!holds("cmp part/notes.txt before/notes.txt && cmp part/out/mine.txt before/out/mine.txt"))
    complain(k, arguments, "files of others were changed");
  if (holds("test -e part/state.csv.part") || !is_whole_table("part/state.csv"))
    complain(k, arguments, "the state is cut");
  /* Nothing depended on it: the closing of a file that was read. */
  if (r.code == 0 && holds("cmp part/state.csv whole/state.csv && diff -r -x summary.json part/out whole/out && "
                           "grep -q '^{.*\"warnings\":\\[.*\\]}$' part/out/summary.json")) /* its times differ */
    return;
  if (r.code != 4) complain(k, arguments, "the code is not 4");
  if (!strstr(r.err, "hooke: ") || !strstr(r.err, "No space left on device")) complain(k, arguments, "no cause");
}

/* At every so many calls. */
static void fails_at_calls(const char *options, long every) {
  char arguments[256];
  if (!test_disk_can_fail()) skip();
  test_write("scene.lua", scene);
  shell("rm -rf before && mkdir -p before/out && cp scene.lua before/");
  snprintf(arguments, sizeof arguments, "run scene.lua v=2 --out out --state state.csv %s", options);
  test_hooke_on_disk(&r, &disk, "before", 0, 0, arguments); /* of other values */
  if (r.code != 0) fail_msg("%s: %s", arguments, r.err);
  shell("echo mine >before/notes.txt && echo mine >before/out/mine.txt");
  snprintf(arguments, sizeof arguments, "run scene.lua --quiet --out out --state state.csv %s", options);
  run_on_copy("whole", 0, arguments);
  assert_int_equal(r.code, 0);
  long calls = disk.calls;
  assert_true(calls > 20);
  for (long k = 1; k <= calls; k += all ? 1 : every) {
    run_on_copy("part", k, arguments);
    check(k, arguments);
  }
  print_message("%ld calls\n", calls);
}

static void a_run_with_tables_and_a_state(void **state) {
  (void)state;
  fails_at_calls("", 13);
}

static void a_run_with_pictures(void **state) {
  (void)state;
  fails_at_calls("pictures=1", 37);
}

/* A recording is written in many small parts; tests/plugins/common/recording/crash.c has each of them. */
static void a_run_with_a_recording(void **state) {
  (void)state;
  if (access(HK_BUILD "/plugins/outputs/trajectory.so", F_OK) != 0) skip();
  fails_at_calls("recorded=1", 121);
}

/* A database that has results of an earlier sweep: they are there afterwards, and the sweep can go on. */
static void a_sweep(void **state) {
  (void)state;
  const char *arguments = "sweep scene.lua v=1,2 --quiet --resume -j 1 --csv v.csv";
  const char *written = "test $(cut -d, -f3 part/v.csv | tr -d '\\n') = v12";
  if (!test_disk_can_fail()) skip();
  test_write("scene.lua", scene);
  shell("rm -rf before && mkdir before && cp scene.lua before/");
  test_hooke_on_disk(&r, &disk, "before", 0, 0, "sweep scene.lua v=3 --quiet");
  if (r.code != 0) fail_msg("%s", r.err);
  run_on_copy("whole", 0, arguments);
  if (r.code != 0) fail_msg("%s", r.err);
  long calls = disk.calls;
  for (long k = 1; k <= calls; k += all ? 1 : 59) {
    test_result failed;
    run_on_copy("part", k, arguments);
    char where[sizeof disk.where];
    failed = r;
    strcpy(where, disk.where);
    bool complete = holds(written);
    test_hooke_on_disk(&r, &disk, "part", 0, 0, arguments);
    if (r.code != 0 || !holds(written)) fail_msg("call %ld (%s): it cannot go on: %s", k, where, r.err);
    test_hooke_on_disk(&r, &disk, "part", 0, 0, "sweep scene.lua v=3 --report --csv w.csv");
    if (!strstr(r.out, "1 ok;")) fail_msg("call %ld (%s): the older result is lost: %s%s", k, where, r.out, r.err);
    bool said =
        failed.code == 4 && strstr(failed.err, "hooke: ") &&
        (strstr(failed.err, "No space left") || strstr(failed.err, "database") || strstr(failed.err, "disk I/O"));
    if (!(failed.code == 0 && complete) && !said)
      fail_msg("call %ld (%s): exit %d: %s", k, where, failed.code, failed.err);
  }
  print_message("%ld calls\n", calls);
}

/* What an earlier bench has written is whole, old or new. */
static void a_bench(void **state) {
  (void)state;
  const char *arguments = "bench scene.lua --budget 0.5 --integrators leapfrog --quiet";
  const char *results = "for f in bench.csv bench.json; do test \"$(tail -c 1 part/out/bench/scene/$f | od -An -c)\" = "
                        "'  \\n' || exit 1; done";
  if (!test_disk_can_fail()) skip();
  test_write("scene.lua", "local s = hooke.scene { duration = 0.1, fps = 20 }\n"
                          "s:particle { position = {1, 0, 0}, velocity = {0, 1, 0} }\n"
                          "s:force('central', { strength = 1 })\nreturn s\n");
  shell("rm -rf before && mkdir before && cp scene.lua before/");
  test_hooke_on_disk(&r, &disk, "before", 0, 0, arguments);
  if (r.code != 0) fail_msg("%s", r.err);
  long calls = disk.calls;
  for (long k = 1; k <= calls; k += all ? 1 : 177) {
    run_on_copy("part", k, arguments);
    if (!holds(results)) complain(k, arguments, "the results are cut");
    if (r.code == 4 && !strstr(r.err, "No space left on device")) complain(k, arguments, "no cause");
    if (r.code != 4 && r.code != 0) complain(k, arguments, "the code is not 4");
  }
  print_message("%ld calls\n", calls);
}

int main(int argc, char **argv) {
  (void)argv;
  all = argc > 1;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_run_with_tables_and_a_state),
      cmocka_unit_test(a_run_with_pictures),
      cmocka_unit_test(a_run_with_a_recording),
      cmocka_unit_test(a_sweep),
      cmocka_unit_test(a_bench),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
