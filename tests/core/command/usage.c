/* How hooke says what it can do: the list of commands, each with what it does, and --help of every one. A file name in
 * the place of a command is taken for what it is. */
#include "tests/support/command.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static test_result r, all;

static void expect(const char *arguments, int code, const char *text) {
  test_hooke(&r, NULL, arguments);
  if (r.code != code) fail_msg("%s: exit %d instead of %d; it said: %s", arguments, r.code, code, r.err);
  if (!strstr(code ? r.err : r.out, text)) fail_msg("%s: expected '%s' in: %s%s", arguments, text, r.out, r.err);
}

/* Calls `check` with the name of every command. */
static void each_command(void (*check)(const char *name)) {
  DIR *folder = opendir(HK_ROOT "/tools");
  int count = 0;
  check("run");
  for (struct dirent *entry; folder && (entry = readdir(folder));) {
    char name[256];
    size_t length = strlen(entry->d_name);
    if (length < 5 || strcmp(entry->d_name + length - 4, ".lua") != 0) continue;
    snprintf(name, sizeof name, "%.*s", (int)length - 4, entry->d_name);
    check(name);
    count++;
  }
  closedir(folder);
  assert_true(count >= 9);
}

/* Two lines: "  hooke NAME ARGUMENTS" and a summary, that fit in a terminal of 100 columns. */
static void is_listed(const char *name) {
  char start[300];
  snprintf(start, sizeof start, "\n  hooke %s", name);
  const char *line = strstr(all.out, start), *summary = line ? strchr(line + 1, '\n') : NULL;
  if (!summary || strncmp(summary, "\n      ", 7) != 0) fail_msg("%s: no summary in: %s", name, all.out);
  if (summary - line > 100 || strcspn(summary + 1, "\n") > 100) fail_msg("%s: longer than a line", name);
}

static void every_command_says_what_it_does(void **state) {
  (void)state;
  test_hooke(&all, NULL, "--help");
  assert_int_equal(all.code, 0);
  each_command(is_listed);
  test_hooke(&r, NULL, "");
  assert_true(r.code == 1 && strcmp(r.out, all.out) == 0);
}

static void has_help(const char *name) {
  char arguments[300], own[300];
  snprintf(arguments, sizeof arguments, "%s --help", name);
  snprintf(own, sizeof own, "hooke %s", name);
  expect(arguments, 0, own);
  if (*r.err) fail_msg("%s: it said: %s", arguments, r.err);
}

static void every_command_has_help(void **state) {
  (void)state;
  each_command(has_help);
}

static void a_file_in_the_place_of_a_command_is_known(void **state) {
  (void)state;
  expect("rope.lua", 1, "'rope.lua' is a scene and no command; did you mean: hooke run rope.lua");
  expect("./wind.so", 1, "'./wind.so' is a plugin and no command; did you mean: hooke check ./wind.so");
  expect("../tools/bench", 1, "unknown command '../tools/bench'");
  expect("banch", 1, "unknown command 'banch'; did you mean 'bench'?");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_command_says_what_it_does),
      cmocka_unit_test(every_command_has_help),
      cmocka_unit_test(a_file_in_the_place_of_a_command_is_known),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
