/* Runs and tools that are stopped by SIGINT, SIGTERM and SIGKILL at many moments, whose number is in *state: whatever
 * is left can be gone on from, into the same bits, and no process stays behind. */
#ifndef HK_TEST_STOPPED_H
#define HK_TEST_STOPPED_H

#include "tests/support/command.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>

static const char scene[] = "local scene = hooke.scene { duration = 4, fps = 60, dt = 1e-3 }\n"
                            "local cloth = scene:grid { nx = 12, ny = 12, width = 1, height = 1, mass = 0.1 }\n"
                            "scene:pin { 1 }\n"
                            "scene:pin({ 12 }, { path = function(t) return 0, 0.1 * math.sin(t), 0 end })\n"
                            "scene:force('gravity', {})\n"
                            "scene:force('springs', { edges = cloth:edges(), k = 100, damping = 0.01 })\n"
                            "scene:measure('low', function(s) return s:position(144)[3] end)\n"
                            "scene:output('table', {})\n"
                            "scene:output('checkpoint', { every = 5 })\n"
                            "return scene\n";

/* In the background; the process. */
static pid_t begin(const char *const arguments[]) {
  const char *folder = test_folder();
  pid_t pid = fork();
  if (pid == 0) {
    if (chdir(folder) != 0 || !freopen("said", "w", stderr) || !freopen("/dev/null", "w", stdout)) _exit(99);
    execv(HK_BUILD "/hooke", (char *const *)(uintptr_t)arguments);
    _exit(99);
  }
  assert_true(pid > 0);
  return pid;
}

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void wait_for(double seconds) {
  struct timespec t = {(time_t)seconds, (long)(1e9 * (seconds - (double)(time_t)seconds))};
  nanosleep(&t, NULL);
}

static int end_of(pid_t pid) {
  int status = 0;
  assert_int_equal(waitpid(pid, &status, 0), pid);
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

/* Goes on from the newest file that is there; false: none is. */
static bool goes_on(const char *folder, int moment) {
  static test_result r;
  char file[128], arguments[256];
  snprintf(file, sizeof file, "%s/newest.checkpoint", folder);
  if (!test_exists(file)) snprintf(file, sizeof file, "%s/before.checkpoint", folder);
  if (!test_exists(file)) return false;
  snprintf(arguments, sizeof arguments, "run cloth.lua --resume %s --out %s --quiet --state rest.csv", file, folder);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0 && r.code != 5) fail_msg("moment %d: gone on: code %d: %s", moment, r.code, r.err);
  test_hooke(&r, "cmp whole.csv rest.csv || exit 9;", "--version");
  if (r.code != 0) fail_msg("moment %d: gone on to another end", moment);
  return true;
}

static inline void runs_stopped_by_signals_can_be_gone_on_from(void **state) {
  int moments = *(const int *)*state;
  static const int signals[] = {SIGINT, SIGTERM, SIGKILL};
  static const char *const whole[] = {"hooke", "run",     "cloth.lua", "--quiet", "--out",
                                      "whole", "--state", "whole.csv", NULL};
  static const char *const part[] = {"hooke", "run", "cloth.lua", "--quiet", "--out", "part", NULL};
  int ended = 0, gone_on = 0;
  test_write("cloth.lua", scene);
  double start = now();
  int code = end_of(begin(whole));
  double took = now() - start;
  for (int k = 0; k < moments; k++) {
    static test_result r;
    test_hooke(&r, "rm -rf part;", "--version");
    pid_t pid = begin(part);
    wait_for(took * k / moments);
    kill(pid, signals[k % 3]);
    int got = end_of(pid);
    ended += got == code;
    /* before hooke listens a signal ends it as it ends any program */
    if (got != code && got != 130 && got != 128 + signals[k % 3]) fail_msg("moment %d: code %d", k, got);
    if (k % (moments / 7) == 0) gone_on += goes_on("part", k);
  }
  print_message("%d of %d had ended before; %d went on\n", ended, moments, gone_on);
  assert_true(gone_on >= 5);
}

/* The children of tools are copies of the process, with its words on their command lines. */
static inline void tools_that_are_stopped_leave_no_child(void **state) {
  int moments = *(const int *)*state;
  static const int signals[] = {SIGINT, SIGTERM, SIGKILL};
  static test_result r;
  char path[4096], search[8600];
  test_write("tool.lua", "local k = param('k', 100, 'stiffness')\n"
                         "local scene = hooke.scene { duration = 5, fps = 60 }\n"
                         "local rope = scene:strand { n = 9, from = {0, 0, 0}, to = {1, 0, 0}, mass = 0.1 }\n"
                         "scene:pin { 1 }\n"
                         "scene:force('gravity', {})\n"
                         "scene:force('springs', { edges = rope:edges(), k = k })\n"
                         "return scene\n");
  for (int k = 0; k < moments; k++) {
    snprintf(path, sizeof path, "%s/tool.lua", test_folder());
    const char *const arguments[] = {"hooke", k % 2 ? "bench" : "sweep", path, k % 2 ? NULL : "k=1..100:log:40", NULL};
    pid_t pid = begin(arguments);
    wait_for(0.01 * (k % 50));
    kill(pid, signals[k % 3]);
    end_of(pid);
    /* A child that was killed is gone once the machine has time for it. */
    snprintf(search, sizeof search,
             "for try in $(seq 100); do pgrep -f '^hooke [a-z]* %s' >/dev/null || break; sleep 0.02; done;"
             "pgrep -f '^hooke [a-z]* %s' && exit 9;",
             path, path);
    test_hooke(&r, search, "--version");
    if (r.code != 0) fail_msg("moment %d: a child of %s stays", k, arguments[1]);
  }
}

#endif
