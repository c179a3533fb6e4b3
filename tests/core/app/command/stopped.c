/* Runs that are stopped from outside: by SIGINT, SIGTERM and SIGKILL at some moments (stopped.h; stopped_long.c takes a
 * hundred), by a disk that is full, by a reader that has gone. */
#include "tests/core/app/command/stopped.h"

/* ulimit -f is in blocks of 512 or 1024 bytes: whatever the first file is that becomes too large, the code is 4, and
 * the other files are closed. */
static void a_full_disk_is_an_error_of_files(void **state) {
  (void)state;
  static test_result r;
  char limit[64];
  test_write("cloth.lua", scene);
  for (int blocks = 0; blocks < 24; blocks += 3) {
    snprintf(limit, sizeof limit, "trap '' XFSZ; ulimit -f %d;", blocks);
    test_hooke(&r, limit, "run cloth.lua --quiet --until 2 --out full --state full.csv");
    if (r.code != 4) fail_msg("%d blocks: code %d: %s", blocks, r.code, r.err);
  }
  test_hooke(&r, NULL, "run cloth.lua --quiet --until 0.2 --out full");
  assert_true(r.code == 0 || r.code == 5);
}

/* Files that are opened then must not take its number. */
static void a_closed_standard_output_is_an_error_of_files(void **state) {
  (void)state;
  static test_result r;
  test_write("cloth.lua", scene);
  test_hooke(&r, NULL, "run cloth.lua --until 0.1 --json --out closed >&-");
  assert_true(r.code == 4 && strstr(r.err, "standard output"));
  test_hooke(&r, "grep -q scene closed/measures.csv closed/table.csv && exit 9;",
             "--version"); /* it went nowhere else */
  assert_int_equal(r.code, 0);
  test_hooke(&r, NULL, "run cloth.lua --until 0.1 --json --out closed >/dev/full");
  assert_true(r.code == 4 && strstr(r.err, "standard output"));
}

/* A video program that never ends: the first signal asks the program to end, which has nothing else to do by then. */
static void a_hanging_ffmpeg_is_ended_with_the_run(void **state) {
  (void)state;
  static test_result r;
  static const int signals[] = {SIGINT, SIGKILL};
  static const char *const arguments[] = {"hooke", "run", "film.lua", "--trust", "--quiet", "--out", "film", NULL};
  if (access(HK_BUILD "/plugins/outputs/frames.so", R_OK) != 0) skip();
  test_write("film.lua", "local scene = hooke.scene { duration = 0.05, fps = 60 }\n"
                         "scene:particle { position = {0, 0, 0}, velocity = {1, 0, 0}, mass = 1 }\n"
                         "scene:output('frames', { width = 64, height = 64 })\n"
                         "return scene\n");
  test_write("ffmpeg", "#!/bin/sh\necho $$ > ffmpeg.pid\nexec sleep 1000\n");
  test_hooke(&r, "chmod +x ffmpeg;", "--version");
  char path[4096];
  snprintf(path, sizeof path, "%s:%s", test_folder(), getenv("PATH"));
  setenv("PATH", path, 1);
  for (int k = 0; k < 2; k++) {
    test_hooke(&r, "rm -f ffmpeg.pid;", "--version");
    pid_t pid = begin(arguments);
    for (int tries = 0; !test_exists("ffmpeg.pid") && tries < 200; tries++) wait_for(0.05);
    assert_true(test_exists("ffmpeg.pid"));
    wait_for(0.2);
    kill(pid, signals[k]);
    int code = end_of(pid);
    if (code != (k ? 128 + SIGKILL : 130)) fail_msg("code %d", code);
    wait_for(0.1);
    test_hooke(&r, "grep -qs 'State:.[RSD]' /proc/$(cat ffmpeg.pid)/status && exit 9;", "--version");
    assert_int_equal(r.code, 0);
    assert_true(test_exists("film/frames/000000.png"));
  }
}

int main(void) {
  static int moments = 15;
  const struct CMUnitTest tests[] = {
      cmocka_unit_test_prestate(runs_stopped_by_signals_can_be_gone_on_from, &moments),
      cmocka_unit_test(a_full_disk_is_an_error_of_files),
      cmocka_unit_test(a_closed_standard_output_is_an_error_of_files),
      cmocka_unit_test(a_hanging_ffmpeg_is_ended_with_the_run),
      cmocka_unit_test_prestate(tools_that_are_stopped_leave_no_child, &moments),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
