/* A plugin that changes what belongs to the process gets a sentence, and the run ends with code 2: by the plugin's name
 * where that is one of its first calls, by the frame later. So does one whose file is written over while it is loaded.
 * Without the first of these the crash, the dead Ctrl-C or the wrong numbers that follow are mute. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SANITIZED 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__)
#define SANITIZED 1
#endif

static test_result r;

/* `how`: of tests/fixtures/meddler.c, and what the sentence says. */
static const struct meddling {
  const char *how, *says;
} meddling[] = {{"default", "has left what happens at SIGSEGV changed"},
                {"ignored", "has left what happens at SIGINT changed"},
                {"rounding", "has left the rounding mode changed"},
                {"flushed", "has left numbers below 2e-308 flushed to zero"},
                {"traps", "has left floating-point traps switched on"}};

enum { MEDDLINGS = sizeof meddling / sizeof *meddling };

static const char *further = "";

static void try(const char *how, const char *when, const char *begins, const char *says) {
  char scene[1024];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 0.5, fps = 10, dt = 1e-3, integrator = 'leapfrog' }\n"
           "scene:particle { mass = 1 }\n"
           "scene:force('%s/tests/fixtures/meddler.so', { how = '%s', %s })\nreturn scene\n",
           HK_BUILD, how, when);
  test_write("bad.lua", scene);
  char words[128];
  snprintf(words, sizeof words, "run bad.lua --trust --quiet --no-output %s", further);
  test_hooke(&r, NULL, words);
  if (r.code != 2 || !strstr(r.err, begins) || !strstr(r.err, says))
    fail_msg("%s, %s: exit %d: %s", how, when, r.code, r.err);
}

static void what_a_plugin_changes_in_its_first_calls_names_it(void **state) {
  (void)state;
  static const char *const when[] = {"where = 'create'", "where = 'add'", "where = 'energy'"};
  for (size_t k = 0; k < MEDDLINGS; k++)
    for (size_t w = 0; w < sizeof when / sizeof *when; w++)
      try(meddling[k].how, when[w], "hooke: bad.lua:3: meddler: the plugin has left", meddling[k].says);
}

/* The frame after the change is at 0.3 s. Traps, the last of the list, may end hooke before it. */
static void what_a_plugin_changes_later_is_seen_at_the_frame(void **state) {
  (void)state;
  for (size_t k = 0; k < MEDDLINGS - 1; k++) {
    try(meddling[k].how, "at = 0.255", "hooke: a plugin of this run has left", meddling[k].says);
    if (!strstr(r.err, "by the frame at t = 0.3")) fail_msg("%s: %s", meddling[k].how, r.err);
  }
}

/* Modes belong to threads. The first two of the list are signals, which do not; a trap may end the thread before. */
static void what_a_plugin_changes_in_another_thread_is_seen(void **state) {
  (void)state;
  further = "--threads 2";
  for (size_t k = 2; k < MEDDLINGS; k++)
    try(meddling[k].how, "where = 'thread'", "hooke: bad.lua:3: meddler: the plugin has left", meddling[k].says);
  for (size_t k = 2; k < MEDDLINGS - 1; k++) {
    try(meddling[k].how, "where = 'thread', at = 0.255", "hooke: a plugin of this run has left", meddling[k].says);
    if (!strstr(r.err, "by the frame at t = 0.3")) fail_msg("%s: %s", meddling[k].how, r.err);
  }
  further = "";
}

/* A trap ends hooke or the plugin that is then at work, if the frame does not come first. A sanitizer reports it
 * itself. */
static void a_trap_in_a_plugin_is_called_one(void **state) {
  (void)state;
#ifdef SANITIZED
  skip();
#endif
  try("traps", "at = 0.255", "hooke: ", "floating-point trap");
  try("inexact", "at = 0.255", "hooke: ", "floating-point trap");
  try("division", "where = 'add'", "hooke: bad.lua:3: the force 'meddler' crashed (SIGFPE, a floating-point trap)", "");
}

/* ---- a file that is written over ---- */

static void replace_file(const char *by, const char *state) {
  char scene[2048], options[128];
  snprintf(scene, sizeof scene,
           "local own = '%s/tests/fixtures/weak_central.so'\n"
           "os.execute('rm -f weak_central.so last.csv && cp ' .. own .. ' .')\n"
           "local scene = hooke.scene { duration = 0.5, fps = 10, dt = 1e-3, integrator = 'leapfrog' }\n"
           "scene:particle { mass = 1, position = { 1, 0, 0 } }\n"
           "scene:force('./weak_central.so', { strength = 1 })\n"
           "local by = ('%s'):gsub('OWN', own)\n"
           "scene:on_frame(function(s) if s.t > 0.15 and s.t < 0.25 then os.execute(by) end end)\n"
           "return scene\n",
           HK_BUILD, by);
  test_write("over.lua", scene);
  snprintf(options, sizeof options, "run over.lua --trust --quiet --no-output%s", state);
  test_hooke(&r, NULL, options);
}

/* By nothing, by another plugin, and by the same one: even then the system drops what the loader has written to it. */
static void a_file_that_is_written_over_is_named(void **state) {
  (void)state;
#ifdef SANITIZED
  skip();
#endif
  static const char *const by[] = {"cp /dev/null weak_central.so",
                                   "cp " HK_BUILD "/tests/fixtures/kicker.so weak_central.so",
                                   "cp OWN weak_central.so"};
  for (size_t k = 0; k < sizeof by / sizeof *by; k++) {
    replace_file(by[k], " --state last.csv");
    if (r.code != 2 || !strstr(r.err, "weak_central.so was written over while it was loaded, and its code is gone") ||
        !strstr(r.err, "the last good state, at t = 0."))
      fail_msg("%s: exit %d: %s", by[k], r.code, r.err);
  }
}

static void a_file_that_is_replaced_by_renaming_is_as_good_as_before(void **state) {
  (void)state;
  replace_file("cp OWN new.so && mv new.so weak_central.so", "");
  if (r.code != 0 || *r.err) fail_msg("exit %d: %s", r.code, r.err);
}

/* METIS, which orders large matrices, takes signals for its own errors: all of them are hooke's again afterwards. */
static void what_a_library_took_is_given_back(void **state) {
  static const char *const solvers[] = {"cholmod:ordering=metis", "supernodal:ordering=metis"};
  (void)state;
  for (size_t k = 0; k < sizeof solvers / sizeof *solvers; k++) {
    char command[256];
    snprintf(command, sizeof command,
             "run " HK_ROOT "/scripts/scenes/stiff_cloth.lua N=8 --solver %s --until 0.05 "
             "--no-output --quiet --no-check",
             solvers[k]);
    test_hooke(&r, NULL, command);
    if (r.code != 0 || *r.err) fail_msg("%s: exit %d: %s", solvers[k], r.code, r.err);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(what_a_plugin_changes_in_its_first_calls_names_it),
      cmocka_unit_test(what_a_plugin_changes_later_is_seen_at_the_frame),
      cmocka_unit_test(what_a_plugin_changes_in_another_thread_is_seen),
      cmocka_unit_test(a_trap_in_a_plugin_is_called_one),
      cmocka_unit_test(a_file_that_is_written_over_is_named),
      cmocka_unit_test(a_file_that_is_replaced_by_renaming_is_as_good_as_before),
      cmocka_unit_test(what_a_library_took_is_given_back),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
