/* hooke view as a user meets it: pages of a scene, of a run's folder and of two; what is refused, and with which words.
 * What a page shows in a browser is tried by view.lua. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static const char rope[] =
    "local k = param('k', 100)\n"
    "local scene = hooke.scene { duration = 0.5, fps = 20, integrator = 'leapfrog', dt = 1e-3 }\n"
    "local a = scene:particle { position = {0, 0, 0}, mass = 1 }\n"
    "local b = scene:particle { position = {1, 0, 0}, mass = 1 }\n"
    "scene:pin { a }\n"
    "scene:force('gravity')\n"
    "scene:force('springs', { edges = { { a, b } }, k = k })\n"
    "return scene\n";

static test_result r;

static void view(const char *before, const char *arguments, int code, const char *text) {
  char all[512];
  snprintf(all, sizeof all, "view %s", arguments);
  test_hooke(&r, before, all);
  if (r.code != code) fail_msg("%s: exit %d instead of %d: %s", all, r.code, code, r.err);
  if (!strstr(code ? r.err : r.out, text)) fail_msg("%s: no '%s' in: %s%s", all, text, r.out, r.err);
}

static bool holds(const char *condition) {
  char command[1024];
  snprintf(command, sizeof command, "cd '%s' && { %s; } >/dev/null 2>&1", test_folder(), condition);
  return system(command) == 0;
}

/* Trajectories are written with HDF5, and pages with zlib; hooke can be built without. */
static void skip_without_pages(void) {
  char module[512];
  snprintf(module, sizeof module, "%s/tools/page.so", HK_BUILD);
  test_hooke(&r, NULL, "plugins trajectory");
  if (r.code != 0 || access(module, R_OK) != 0) skip();
}

static void a_scene_is_run_and_shown(void **state) {
  (void)state;
  skip_without_pages();
  test_write("rope.lua", rope);
  view(NULL, "rope.lua k=200 --quiet", 0, "wrote out/rope/page.html (");
  assert_non_null(strstr(r.out, "of the extent"));
  assert_true(holds("grep -q '<title>rope</title>' out/rope/page.html"));
  assert_true(holds("grep -q '\"the parameter k\":\"200\"' out/rope/page.html")); /* the summary is in it */
  assert_true(holds("grep -q '\"Energy\"' out/rope/page.html"));
  assert_false(holds("grep -q 'force springs' out/rope/page.html"));
}

static void outputs_of_the_scene_are_left_out(void **state) {
  char chatty[1024];
  (void)state;
  skip_without_pages();
  snprintf(chatty, sizeof chatty, "%.*sscene:output('table')\nscene:output('sequence')\nreturn scene\n",
           (int)(strstr(rope, "return scene") - rope), rope);
  test_write("chatty.lua", chatty);
  view(NULL, "chatty.lua --quiet", 0, "wrote out/chatty/page.html");
  assert_true(
      holds("[ \"$(ls out/chatty | tr '\\n' ' ')\" = 'page.html summary.json trajectory.h5 trajectory.xdmf ' ]"));
}

static void options_of_run_follow_two_dashes(void **state) {
  (void)state;
  skip_without_pages();
  view(NULL, "rope.lua --quiet --forces --out bdf -- --integrator bdf2 --until 0.2", 0, "wrote bdf/page.html");
  assert_true(holds("grep -q '\"integrator\":\"bdf2\"' bdf/page.html"));
  assert_true(holds("grep -q '<title>rope</title>' bdf/page.html")); /* of the scene, wherever the page lies */
  assert_true(holds("grep -q '\"force springs\"' bdf/page.html"));
}

static void a_run_that_is_over_and_two_of_them(void **state) {
  (void)state;
  skip_without_pages();
  view(NULL, "out/rope --page one.html --quiet", 0, "wrote one.html");
  view(NULL, "out/rope bdf --quiet --page two.html", 0, "wrote two.html");
  assert_true(holds("grep -q '\"difference\":{' two.html && grep -q '<title>rope and bdf</title>' two.html"));
  assert_true(holds("cp -r out/rope killed && rm killed/summary.json")); /* as a run that was killed leaves it */
  view(NULL, "killed --quiet", 0, "wrote killed/page.html");
  view(NULL, "killed --quiet --page ./killed/trajectory.h5", 1, "is what is to be shown");
  view(NULL, "out/rope --quiet --page out/rope/summary.json", 1, "is what is to be shown");
}

static void a_run_that_diverges_is_shown_with_its_code(void **state) {
  (void)state;
  skip_without_pages();
  view(NULL, "rope.lua k=1e9 --quiet --out wild", 3, "");
  assert_true(holds("grep -q '\"verdict\":\"diverged\"' wild/page.html"));
}

static void names_become_text(void **state) {
  (void)state;
  skip_without_pages();
  assert_true(holds("cp rope.lua \"it's <b>.lua\""));
  view(NULL, "\"it's <b>.lua\" --quiet", 0, "wrote");
  assert_true(holds("grep -q '<title>it&#39;s &lt;b&gt;</title>' \"out/it's <b>/page.html\""));
  assert_false(holds("grep -q \"it's <b>\" \"out/it's <b>/page.html\""));
}

static void what_cannot_be_shown_is_refused_with_a_remedy(void **state) {
  (void)state;
  skip_without_pages();
  assert_true(holds("mkdir -p bare broken && head -c 5000 out/rope/trajectory.h5 >broken/trajectory.h5"));
  view(NULL, "bare", 4, "bare has no trajectory.h5: add scene:output('trajectory')");
  view(NULL, "nowhere", 4, "there is no folder or script nowhere");
  view(NULL, "broken", 4, "broken/trajectory.h5");
  view(NULL, "bare bare bare", 1, "one or two folders");
  view(NULL, "rope.lua K=1", 1, "did you mean 'k'");
  view(NULL, "rope.lua --fast", 1, "--fast");
  view(NULL, "", 1, "what");
}

/* The scene would take its time. */
static void a_page_that_cannot_be_written_is_said_before_the_run(void **state) {
  (void)state;
  skip_without_pages();
  assert_true(holds("rm -rf out/rope && mkdir -p pages && echo old >pages/old.html"));
  view(NULL, "rope.lua --page nowhere/page.html", 4, "--page: there is no folder nowhere for nowhere/page.html");
  view(NULL, "rope.lua --page pages", 4, "--page: pages is a folder: name a file in it, such as pages/page.html");
  view(NULL, "rope.lua --page /proc/page.html", 4, "--page: cannot write /proc/page.html: No such file or directory");
  assert_true(holds("test ! -e out/rope"));
  view(NULL, "rope.lua --page pages/new.html k=none", 1, "k: 'none' is not a number");
  assert_true(holds("test ! -e pages/new.html && test \"$(cat pages/old.html)\" = old"));
}

static void a_full_disk_is_said_and_leaves_the_page_that_was_there(void **state) {
  (void)state;
  skip_without_pages();
  view(NULL, "out/rope --quiet --page /dev/full", 4, "cannot write /dev/full: No space left on device");
  assert_true(holds("cp one.html before.html && mkdir one.html.part"));
  view(NULL, "out/rope --quiet --page one.html", 4, "cannot write one.html");
  assert_true(holds("cmp one.html before.html && rmdir one.html.part"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_scene_is_run_and_shown),
      cmocka_unit_test(outputs_of_the_scene_are_left_out),
      cmocka_unit_test(options_of_run_follow_two_dashes),
      cmocka_unit_test(a_run_that_is_over_and_two_of_them),
      cmocka_unit_test(a_run_that_diverges_is_shown_with_its_code),
      cmocka_unit_test(names_become_text),
      cmocka_unit_test(what_cannot_be_shown_is_refused_with_a_remedy),
      cmocka_unit_test(a_full_disk_is_said_and_leaves_the_page_that_was_there),
      cmocka_unit_test(a_page_that_cannot_be_written_is_said_before_the_run),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
