/* One file, one writer: what options name is neither a file of the output folder nor the folder, by whatever path. And
 * a summary is written whole or not at all. */
#include "tests/support/failing_writes.h"

#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const char scene[] = "local s = hooke.scene { duration = 0.1, fps = 10, dt = 0.05, integrator = 'leapfrog' }\n"
                            "s:particle { position = {0, 0, 1} }\n"
                            "if param('t', 1) == 1 then s:output('table', {}) end\n"
                            "s:measure('z', function(q) return q.t end)\n"
                            "return s\n";

static test_result r;

static void expect(const char *before, const char *arguments, int code, const char *says) {
  char words[256];
  snprintf(words, sizeof words, "run s.lua --quiet %s", arguments);
  test_hooke(&r, before, words);
  if (r.code != code || !strstr(r.err, says)) fail_msg("%s: exit %d: %s", arguments, r.code, r.err);
}

/* In an empty folder, and in one where an earlier run has written them. */
static void what_the_run_writes_is_no_file_of_an_option(void **state) {
  (void)state;
  test_write("s.lua", scene);
  for (int again = 0; again < 2; again++) {
    expect("mkdir -p o deep; ln -sfn . here;", "--out o --state ./o/table.csv", 1,
           "output 'table': o/table.csv is the file of --state as well, and one would be lost; name another file");
    expect(NULL, "--out o --summary here/o/table.csv", 1, "o/table.csv is the file of --summary as well");
    expect(NULL, "--out o --state deep/../o/summary.json", 1, "the run: o/summary.json is the file of --state as well");
    expect(NULL, "--out o/ --summary o/measures.csv", 1, "measures.csv is the file of --summary as well");
    expect(NULL, "--out o --state o/.hooke-files", 1, "o/.hooke-files is the file of --state as well");
    expect(NULL, "--state other --summary s.json --out o", 0, "");
  }
  expect("mkdir -p free;", "--out free --state free/state.csv --summary free/s.json", 0, "");
  assert_true(test_exists("free/state.csv") && test_exists("free/s.json") && test_exists("free/table.csv"));
}

static void what_an_option_names_is_not_the_output_folder(void **state) {
  (void)state;
  test_write("s.lua", scene);
  expect(NULL, "--out fresh/ --state fresh", 1, "--state: fresh is the file of --out as well");
  expect(NULL, "--out fresh --summary ./fresh", 1, "--summary: ./fresh is the file of --out as well");
  expect(NULL, "--out fresh --state ./fresh --no-output", 0, "");
}

/* With the disk full at call k, for every k: the old summary or the new one, and no part of either. */
static void a_summary_is_whole_or_the_old_one(void **state) {
  (void)state;
  test_disk disk;
  char command[1024];
  const char *arguments = "run s.lua t=0 --quiet --no-output --summary s.json";
  if (!test_disk_can_fail()) skip();
  test_write("s.lua", scene);
  snprintf(command, sizeof command, "cd '%s' && mkdir -p disk && cp s.lua disk/", test_folder());
  assert_int_equal(system(command), 0);
  test_hooke_on_disk(&r, &disk, "disk", 0, 0, arguments);
  assert_int_equal(r.code, 0);
  long calls = disk.calls, failed = 0;
  snprintf(command, sizeof command,
           "cd '%s/disk' && { test \"$(cat s.json)\" = old || grep -q '^{.*\"warnings\":\\[.*\\]}$' s.json; } && "
           "! test -e s.json.part",
           test_folder());
  for (long k = 1; k <= calls; k++) {
    test_write("disk/s.json", "old");
    test_hooke_on_disk(&r, &disk, "disk", k, ENOSPC, arguments);
    if (r.code != 0 && (r.code != 4 || !strstr(r.err, "No space left on device")))
      fail_msg("call %ld (%s): exit %d: %s", k, disk.where, r.code, r.err);
    if (system(command) != 0) fail_msg("call %ld (%s): the summary is cut; exit %d", k, disk.where, r.code);
    failed += r.code == 4;
  }
  assert_true(failed >= 3); /* to open, to write and to rename it */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_the_run_writes_is_no_file_of_an_option),
      cmocka_unit_test(what_an_option_names_is_not_the_output_folder),
      cmocka_unit_test(a_summary_is_whole_or_the_old_one),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
