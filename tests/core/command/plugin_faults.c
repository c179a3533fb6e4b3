/* A plugin that takes the process along is named, with its place in the script, and the run ends with code 2. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
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

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(exit_in_a_plugin_is_an_error_wherever_it_is),
      cmocka_unit_test(abort_in_a_plugin_names_it),
      cmocka_unit_test(a_crash_in_a_plugin_names_it),
      cmocka_unit_test(the_innermost_plugin_is_the_one_named),
      cmocka_unit_test(tools_name_the_plugin_as_well),
      cmocka_unit_test(what_a_script_does_is_not_put_down_to_a_plugin),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
