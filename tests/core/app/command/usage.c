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

static void help_is_found_as_people_ask_for_it(void **state) {
  (void)state;
  expect("-h", 0, "hooke COMMAND --help says more of each");
  expect("run -h", 0, "usage: hooke run SCENE.lua");
  expect("help run", 0, "usage: hooke run SCENE.lua");
  expect("help bench", 0, "Usage: hooke bench");
  expect("help bnch", 1, "unknown command 'bnch'; did you mean 'bench'?");
  expect("version", 1, "did you mean '--version'?");
}

static void words_of_run_are_explained(void **state) {
  (void)state;
  test_write("rope.lua", "return hooke.scene {}\n");
  expect("run rope.lua N", 1, "a parameter of the scene is written N=VALUE");
  expect("run rope.lua ./b.lua", 1, "'./b.lua' is neither an option nor name=value; the scene of this run is rope.lua");
  expect("run .", 4, "cannot read the scene .: it is a folder, and a scene is a file NAME.lua");
  expect("run rope.lua --dt=1ms", 1, "--dt: '1ms' is not a positive number: --dt SECONDS");
}

static void tools_take_what_people_mean(void **state) {
  (void)state;
  test_write("rope.lua", "return hooke.scene {}\n");
  expect("plugins forces", 0, "  springs ");
  if (strstr(r.out, "leapfrog")) fail_msg("of another kind: %s", r.out);
  expect("plugins integrator", 0, "  leapfrog ");
  expect("auto rope.lua --accuracy -1", 1, "'-1' is taken for an option; the value of one is written --NAME=-1");
  expect("bench rope.lua --targt 3", 1, "unknown option '--targt'; did you mean '--target'?");
  expect("check rope.lua", 1, "./rope.lua is no shared object: build the plugin with cc -shared -fPIC");
  expect("check nowhere.so", 1, "there is no file ./nowhere.so");
  expect("check spring", 1, "there is no file ./spring; did you mean the plugin 'springs'?");
}

/* A file of another kind where a scene, a name or a list is expected. */
static void what_is_no_scene_is_said_to_be_none(void **state) {
  (void)state;
  test_write("code.c", "/* C */\nint x;\n");
  test_write("object.so", "\x7f"
                          "ELF\x02\x01");
  test_write("scene.lua", "local k = param('k', 1)\nreturn hooke.scene {}\n");
  expect("run code.c", 1, "code.c:1: unexpected symbol near '/'; a scene is a Lua script, NAME.lua");
  expect("run object.so", 1, "object.so is a shared object and no script: hooke check ./object.so tries a plugin");
  expect("plugins object.so", 1, "'object.so' is a file: hooke check ./object.so tries the plugin in it");
  expect("gallery scene.lua", 1, "scene.lua is no list of scenes");
  expect("run scene.lua =3", 1, "'=3': a parameter has a name, NAME=VALUE, without blanks");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(every_command_says_what_it_does),
      cmocka_unit_test(every_command_has_help),
      cmocka_unit_test(help_is_found_as_people_ask_for_it),
      cmocka_unit_test(words_of_run_are_explained),
      cmocka_unit_test(tools_take_what_people_mean),
      cmocka_unit_test(a_file_in_the_place_of_a_command_is_known),
      cmocka_unit_test(what_is_no_scene_is_said_to_be_none),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
