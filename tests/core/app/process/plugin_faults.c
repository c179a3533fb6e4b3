/* A plugin that takes the process along is named, with its place in the script, and the run ends with code 2; with
 * --state the last good state is kept. One that does not return is ended where the user asks to stop, and one that
 * fails without a word is named. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define SANITIZED 1
#endif
#endif
#if defined(__SANITIZE_ADDRESS__)
#define SANITIZED 1
#endif

#define HEAD "local scene = hooke.scene { duration = 0.5, fps = 10 }\nscene:particle { mass = 1 }\n"

static test_result r;

static void expect(const char *scene, const char *text) {
  test_write("bad.lua", scene);
  test_hooke(&r, NULL, "run bad.lua --trust --quiet --threads 4 2>&1");
  if (r.code != 2) fail_msg("exit %d instead of 2; it said: %s", r.code, r.out);
  if (!strstr(r.out, text)) fail_msg("expected '%s' in: %s", text, r.out);
}

static void expect_fault(const char *where, const char *how, const char *text) {
  char scene[1024];
  snprintf(scene, sizeof scene,
           HEAD "scene:force('%s/tests/fixtures/exiter.so', { how = '%s', where = '%s', at = 0.25 })\nreturn scene\n",
           HK_BUILD, how, where);
  expect(scene, text);
}

static void exit_in_a_plugin_is_an_error_wherever_it_is(void **state) {
  (void)state;
  static const char *const where[] = {"add", "create", "destroy", "energy", "thread"};
  for (size_t k = 0; k < sizeof where / sizeof *where; k++)
    expect_fault(where[k], "exit", "hooke: bad.lua:3: the force 'exiter' ended the process by exit()");
}

static void abort_in_a_plugin_names_it(void **state) {
  (void)state;
  expect_fault("add", "abort", "hooke: bad.lua:3: the force 'exiter' crashed (SIGABRT");
  expect(HEAD "scene:force('" HK_BUILD "/tests/fixtures/aborter.so', { label = 'mine' })\nreturn scene\n",
         "hooke: bad.lua:3: the force 'mine' of the plugin aborter crashed (SIGABRT");
}

/* A sanitizer reports these itself. */
static void a_crash_in_a_plugin_names_it(void **state) {
  (void)state;
#ifdef SANITIZED
  skip();
#endif
  static const char *const how[][2] = {
      {"segv", "SIGSEGV"}, {"fpe", "SIGFPE"}, {"bus", "SIGBUS"}, {"ill", "SIGILL"}, {"overflow", "SIGSEGV"}};
  char text[128];
  for (size_t k = 0; k < sizeof how / sizeof *how; k++) {
    snprintf(text, sizeof text, "hooke: bad.lua:3: the force 'exiter' crashed (%s", how[k][1]);
    expect_fault("add", how[k][0], text);
  }
  expect_fault("thread", "segv", "hooke: bad.lua:3: the force 'exiter' crashed (SIGSEGV");
}

/* ---- in a pass over the particles, beside other forces in other threads ---- */

/* 20 blocks in 10 domains; what is at fault is the second of three forces. */
static void write_pass(const char *how, int block) {
  char scene[1024];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 0.5, fps = 10, dt = 0.01, integrator = 'leapfrog' }\n"
           "for i = 1, 20000 do scene:particle { position = { i, 0, 0 }, mass = 1 } end\n"
           "scene:force('gravity')\n"
           "scene:force('%s/tests/fixtures/part_exiter.so', { label = 'mine', how = '%s', block = %d, at = 0.255 })\n"
           "scene:force('drag', { rate = 0.1 })\nreturn scene\n",
           HK_BUILD, how, block);
  test_write("bad.lua", scene);
}

static void a_fault_in_a_part_names_the_force(void **state) {
  (void)state;
  static const char *const say[][2] = {{"exit", "ended the process by exit()"}, {"segv", "crashed (SIGSEGV"}};
#ifdef SANITIZED
  enum { WAYS = 1 };
#else
  enum { WAYS = 2 };
#endif
  for (size_t k = 0; k < WAYS; k++)
    for (int block = 0; block < 20; block += 19) {
      write_pass(say[k][0], block);
      test_hooke(&r, NULL, "run bad.lua --trust --quiet --threads 4 --state last.csv");
      if (r.code != 2 || !strstr(r.err, "hooke: bad.lua:4: the force 'mine' of the plugin part_exiter ") ||
          !strstr(r.err, say[k][1]) || !strstr(r.err, "the last good state, at t = 0.2 s, is in last.csv"))
        fail_msg("%s in block %d: exit %d: %s", say[k][0], block, r.code, r.err);
    }
}

/* By then the other threads have long done their parts, of forces that are not at fault. */
static void a_part_that_does_not_return_is_named(void **state) {
  (void)state;
  write_pass("loop", 7);
  test_write("twice.sh", "\"$@\" & p=$!\nsleep 1.5; kill -TERM $p; sleep 0.7; kill -TERM $p; wait $p\n");
  test_hooke(&r, "timeout --preserve-status -s KILL 60 sh ./twice.sh", "run bad.lua --trust --quiet --threads 4");
  if (r.code != 130 || !strstr(r.err, "bad.lua:4: the force 'mine' of the plugin part_exiter has not returned"))
    fail_msg("exit %d: %s", r.code, r.err);
}

/* An integrator at fault is named after the forces that it called have come back. */
static void the_innermost_plugin_is_the_one_named(void **state) {
  (void)state;
  const char *format = "local scene = hooke.scene { duration = 0.5, fps = 10 }\nscene:particle { mass = 1 }\n"
                       "scene:force('gravity')\nscene:integrator('%s/tests/fixtures/liar.so', { how = '%s' })\n"
                       "return scene\n";
  char scene[1024];
  snprintf(scene, sizeof scene, format, HK_BUILD, "exit");
  expect(scene, "hooke: bad.lua:4: the integrator 'liar' ended the process by exit()");
#ifndef SANITIZED
  snprintf(scene, sizeof scene, format, HK_BUILD, "crash");
  expect(scene, "hooke: bad.lua:4: the integrator 'liar' crashed (SIGSEGV");
#endif
}

/* ---- the last good state ---- */

/* A particle at 3 m/s that no force acts on, in frames of 0.1 s: at the last one before the fault it is at 0.6 m, up to
 * the rounding of some tens of steps. The channel is 5 for ever. */
static void write_flight(const char *how) {
  char scene[1024];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 1, fps = 10, dt = 0.01, integrator = 'leapfrog' }\n"
           "scene:channel('heat', { size = 1, initial = 5 })\n"
           "scene:particle { mass = 2, velocity = { 3, 0, 0 } }\n"
           "scene:force('%s/tests/fixtures/exiter.so', { how = '%s', at = 0.255 })\nreturn scene\n",
           HK_BUILD, how);
  test_write("bad.lua", scene);
  char command[256];
  snprintf(command, sizeof command, "rm -f '%s'/last.csv", test_folder());
  assert_int_equal(system(command), 0);
}

static void assert_flight_kept(void) {
  char path[256], head[256];
  unsigned id;
  double x, y, z, vx, vy, vz, mass, heat;
  snprintf(path, sizeof path, "%s/last.csv", test_folder());
  FILE *file = fopen(path, "r");
  if (!file) fail_msg("no state was kept: %s", r.err);
  assert_non_null(fgets(head, sizeof head, file));
  assert_string_equal(head, "id,x,y,z,vx,vy,vz,mass,heat\n");
  assert_int_equal(fscanf(file, "%u,%lf,%lf,%lf,%lf,%lf,%lf,%lf,%lf\n", &id, &x, &y, &z, &vx, &vy, &vz, &mass, &heat),
                   9);
  fclose(file);
  assert_true(id == 1 && fabs(x - 0.6) < 1e-14 && vx == 3 && mass == 2 && heat == 5);
}

static void the_last_good_state_is_kept(void **state) {
  (void)state;
  static const char *const how[] = {"exit", "abort", "segv", "overflow"};
#ifdef SANITIZED
  enum { WAYS = 2 }; /* of the others a sanitizer takes care */
#else
  enum { WAYS = 4 };
#endif
  for (size_t k = 0; k < WAYS; k++) {
    write_flight(how[k]);
    test_hooke(&r, NULL, "run bad.lua --trust --quiet --state last.csv");
    assert_int_equal(r.code, 2);
    if (!strstr(r.err, "bad.lua:4: the force 'exiter'") ||
        !strstr(r.err, "hooke: the last good state, at t = 0.2 s, is in last.csv\n"))
      fail_msg("%s", r.err);
    assert_flight_kept();
  }
}

/* A state that is good beside a fault has no place in the file of a run that came to its end. */
static void a_fault_after_the_end_leaves_the_final_state(void **state) {
  (void)state;
  char scene[512], last[512];
  snprintf(scene, sizeof scene,
           HEAD "scene:force('%s/tests/fixtures/exiter.so', { where = 'destroy' })\nreturn scene\n", HK_BUILD);
  test_write("bad.lua", scene);
  test_hooke(&r, NULL, "run bad.lua --trust --quiet --state last.csv");
  assert_int_equal(r.code, 2);
  assert_null(strstr(r.err, "last good state"));
  snprintf(last, sizeof last, "%s/last.csv", test_folder());
  assert_int_equal(access(last, F_OK), 0);
}

/* ---- calls that do not return ---- */

static void an_endless_loop_obeys_an_interruption(void **state) {
  (void)state;
  write_flight("loop");
  test_hooke(&r, "timeout --preserve-status -k 60 -s INT 1", "run bad.lua --trust --quiet --state last.csv");
  if (r.code != 130 || !strstr(r.err, "bad.lua:4: the force 'exiter' has not returned 5 s after the interruption"))
    fail_msg("exit %d: %s", r.code, r.err);
  assert_flight_kept();
}

static void a_second_interruption_ends_a_loop_at_once(void **state) {
  (void)state;
  write_flight("loop");
  test_write("twice.sh", "\"$@\" & p=$!\nsleep 1; kill -TERM $p; sleep 0.7; kill -TERM $p; wait $p\n");
  test_hooke(&r, "timeout --preserve-status -s KILL 60 sh ./twice.sh", "run bad.lua --trust --quiet --state last.csv");
  if (r.code != 130 || !strstr(r.err, "bad.lua:4: the force 'exiter' has not returned at the second interruption"))
    fail_msg("exit %d: %s", r.code, r.err);
  assert_flight_kept();
}

/* A run whose plugins return ends in order, and the alarm is off. */
static void an_interruption_of_a_sound_run_waits_for_its_end(void **state) {
  (void)state;
  test_write("bad.lua", "local scene = hooke.scene { duration = 1e6, fps = 10, dt = 0.001, integrator = 'leapfrog' }\n"
                        "scene:particle { mass = 2 }\nscene:force('gravity')\nreturn scene\n");
  test_hooke(&r, "timeout --preserve-status -s INT 0.5", "run bad.lua --quiet --state last.csv");
  if (r.code != 130 || strstr(r.err, "has not returned")) fail_msg("exit %d: %s", r.code, r.err);
}

/* ---- failures without a message ---- */

static void a_failure_without_a_message_gets_one(void **state) {
  (void)state;
  expect_fault("add", "mute", "hooke: bad.lua:3: exiter: the plugin's add failed without saying why\n");
  expect_fault("add", "blank", "hooke: bad.lua:3: exiter: it failed without saying why\n");
  expect_fault("add", "stray", "hooke: bad.lua:3: exiter: the plugin's add returned a number that is no status\n");
  expect_fault("create", "mute", "hooke: bad.lua:3: exiter: the plugin's create failed without saying why\n");
}

static void tools_name_the_plugin_as_well(void **state) {
  (void)state;
  test_write("bad.lua",
             HEAD "scene:force('" HK_BUILD "/tests/fixtures/exiter.so', { where = 'create' })\nreturn scene\n");
  test_hooke(&r, NULL, "explain bad.lua --trust");
  if (r.code != 2 || !strstr(r.err, "bad.lua:3: the force 'exiter' ended the process by exit()"))
    fail_msg("exit %d: %s%s", r.code, r.out, r.err);
}

/* A trusted script may end the process itself: os.exit in a path that an integrator asks for is no plugin's doing. */
static void what_a_script_does_is_not_put_down_to_a_plugin(void **state) {
  (void)state;
  test_write("exit.lua", "local scene = hooke.scene { duration = 0.5, fps = 10 }\n"
                         "local p = scene:particle { mass = 1 }\nscene:force('gravity')\n"
                         "scene:pin({ p }, { path = function(t) if t > 0.2 then os.exit(7) end return t, 0, 0 end })\n"
                         "return scene\n");
  test_hooke(&r, NULL, "run exit.lua --trust --quiet");
  if (r.code != 7 || strstr(r.err, "plugin")) fail_msg("exit %d: %s", r.code, r.err);
}

/* A signal of its own, and Lua 5.4.4 itself, whose stack moves under a __concat. Later ones run to the end. */
static void a_crash_outside_of_plugins_has_a_sentence(void **state) {
  (void)state;
#ifdef SANITIZED
  skip();
#endif
  static const char says[] = "hooke: it crashed (SIGSEGV, memory that is not its own) outside of all plugins";
  test_write("bad.lua", "os.execute('kill -SEGV $PPID')\n" HEAD "return scene\n");
  test_hooke(&r, NULL, "run bad.lua --trust --quiet --no-output");
  if (r.code != 128 + 11 || !strstr(r.err, says)) fail_msg("exit %d: %s", r.code, r.err);
  test_write("bad.lua", "local function deep(n) if n == 0 then return 0 end return 1 + deep(n - 1) end\n"
                        "local t = setmetatable({}, { __concat = function(a) deep(15000) return a end })\n"
                        "local function join() local a = t .. t .. t .. t .. t .. t .. t .. t return a end\n"
                        "for _ = 1, 20 do coroutine.wrap(join)() end\n" HEAD "return scene\n");
  test_hooke(&r, NULL, "run bad.lua --trust --quiet --no-output");
  bool said = r.code == 128 + 11 && strstr(r.err, says) && strstr(r.err, "without --trust it cannot");
  if (r.code != 0 && !said) fail_msg("exit %d: %s", r.code, r.err);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(exit_in_a_plugin_is_an_error_wherever_it_is),
      cmocka_unit_test(abort_in_a_plugin_names_it),
      cmocka_unit_test(a_crash_in_a_plugin_names_it),
      cmocka_unit_test(a_crash_outside_of_plugins_has_a_sentence),
      cmocka_unit_test(a_fault_in_a_part_names_the_force),
      cmocka_unit_test(a_part_that_does_not_return_is_named),
      cmocka_unit_test(the_innermost_plugin_is_the_one_named),
      cmocka_unit_test(the_last_good_state_is_kept),
      cmocka_unit_test(a_fault_after_the_end_leaves_the_final_state),
      cmocka_unit_test(an_endless_loop_obeys_an_interruption),
      cmocka_unit_test(a_second_interruption_ends_a_loop_at_once),
      cmocka_unit_test(an_interruption_of_a_sound_run_waits_for_its_end),
      cmocka_unit_test(a_failure_without_a_message_gets_one),
      cmocka_unit_test(tools_name_the_plugin_as_well),
      cmocka_unit_test(what_a_script_does_is_not_put_down_to_a_plugin),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
