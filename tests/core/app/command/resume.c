/* hooke run --resume: the command goes on with the scene, the parameters and the options of the run that was stopped,
 * into the same bits; what has changed meanwhile is named, and the files of the first part stay. */
#include "core/run/storage/walk.h"
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const char scene[] = "local rope = require 'lost_rope'\n"
                            "local N = param('N', 12, 'particles')\n"
                            "local scene = hooke.scene { duration = 0.9, fps = 20 }\n"
                            "rope(scene, N)\n"
                            "local stop = param('stop', 0, 'frame of an error')\n"
                            "local frame = 0\n"
                            "scene:measure('low', function(s) return s:position(N)[3] end)\n"
                            "scene:on_frame(function(s) frame = frame + 1\n"
                            "  if frame == stop then error('enough') end end)\n"
                            "scene:output('checkpoint', { every = 4 })\n"
                            "return scene\n";

static const char module[] = "return function(scene, N)\n"
                             "  local rope = scene:strand { n = N, from = {0, 0, 0}, to = {1, 0, 0}, mass = 0.1 }\n"
                             "  scene:pin { 1 }\n"
                             "  scene:force('gravity', {})\n"
                             "  scene:force('springs', { edges = rope:edges(), k = 100, damping = 0.01 })\n"
                             "end\n";

static void write_scene(void) {
  test_write("rope.lua", scene);
  test_write("lost_rope.lua", module);
}

/* Stops at frame 10 by an error of the script; the last point is that of frame 8. The script counts frames anew when it
 * goes on, so that the error does not come back. */
static void stop(const char *options) {
  static test_result r;
  char arguments[512];
  write_scene();
  snprintf(arguments, sizeof arguments, "run rope.lua N=9 --quiet --out part %s stop=11", options);
  test_hooke(&r, NULL, arguments);
  if (r.code != 1 || !strstr(r.err, "enough")) fail_msg("code %d: %s", r.code, r.err);
  assert_true(test_exists("part/newest.checkpoint") && test_exists("part/before.checkpoint"));
}

/* The first part ends at 0.55 s; its newest checkpoint is that of frame 8, at 0.4 s. */
static void it_goes_on_with_scene_parameters_and_options(void **state) {
  (void)state;
  static test_result r;
  for (int k = 0; k < 2; k++) {
    const char *options = k ? "--integrator bdf2 --seed 5" : "--integrator rk4 --dt 0.001";
    char arguments[512];
    write_scene();
    snprintf(arguments, sizeof arguments, "run rope.lua N=9 --quiet --out whole --state whole.csv stop=1000 %s",
             options);
    test_hooke(&r, NULL, arguments);
    assert_int_equal(r.code, 0);
    snprintf(arguments, sizeof arguments, "run rope.lua N=9 stop=1000 --until 0.55 --out part --quiet %s", options);
    test_hooke(&r, NULL, arguments);
    assert_int_equal(r.code, 0);
    test_hooke(
        &r, "cp part/newest.checkpoint at.checkpoint; mkdir -p elsewhere; cd elsewhere;",
        "run ../rope.lua --resume ../at.checkpoint --until 0.9 --out ../part --quiet --threads 1 --state ../rest.csv");
    if (r.code != 0) fail_msg("code %d: %s", r.code, r.err);
    test_hooke(&r, "cmp whole.csv rest.csv || exit 9;", "--version");
    assert_int_equal(r.code, 0);
  }
}

/* What --with adds to the motion is part of it; outputs are for each part to choose. */
static void plugins_of_the_command_line_go_on(void **state) {
  (void)state;
  static test_result r;
  const char *words = "--with force:drag:d=0.01 --with=force:central:strength=3 --with output:table";
  char arguments[512];
  write_scene();
  snprintf(arguments, sizeof arguments, "run rope.lua --quiet --out whole --state whole.csv %s", words);
  test_hooke(&r, NULL, arguments);
  assert_int_equal(r.code, 0);
  snprintf(arguments, sizeof arguments, "run rope.lua --until 0.55 --out part --quiet %s", words);
  test_hooke(&r, NULL, arguments);
  assert_int_equal(r.code, 0);
  test_hooke(&r, NULL, "run rope.lua --resume part/newest.checkpoint --until 0.9 --quiet --state rest.csv");
  if (r.code != 0) fail_msg("code %d: %s", r.code, r.err);
  test_hooke(&r, "cmp whole.csv rest.csv && test ! -e part/from-step-*/table.csv || exit 9;", "--version");
  assert_int_equal(r.code, 0);
}

/* The first part has chosen its step, of 1/140 s or so. */
static void a_step_that_is_given_now_is_kept(void **state) {
  (void)state;
  static test_result r;
  write_scene();
  test_hooke(&r, NULL, "run rope.lua --until 0.55 --out part --quiet --integrator leapfrog");
  assert_int_equal(r.code, 0);
  test_hooke(&r, NULL, "run rope.lua --resume part/newest.checkpoint --until 0.9 --dt 0.0005 --json --quiet");
  if (r.code != 0) fail_msg("code %d: %s", r.code, r.err);
  assert_non_null(strstr(r.out, "(given"));
  assert_true(test_json(r.out, "dt_min") <= 0.0005);
  assert_true(test_json(r.out, "steps") >= 1000); /* 0.5 s of them */
}

static void a_run_does_not_go_back(void **state) {
  (void)state;
  static test_result r;
  write_scene();
  test_hooke(&r, NULL, "run rope.lua --until 0.55 --out part --quiet");
  assert_int_equal(r.code, 0);
  test_hooke(&r, NULL, "run rope.lua --resume part/newest.checkpoint --until 0.1 --quiet");
  if (r.code != 1 || !strstr(r.err, "after the end that is asked for, 0.1 s")) fail_msg("%d: %s", r.code, r.err);
}

static void the_files_of_the_first_part_stay(void **state) {
  (void)state;
  static test_result r;
  stop("");
  test_hooke(&r, NULL, "run rope.lua --resume part/newest.checkpoint --out part --quiet");
  if (r.code != 0) fail_msg("code %d: %s", r.code, r.err);
  assert_true(test_exists("part/newest.checkpoint") && test_exists("part/measures.csv"));
  test_hooke(&r, "test -f part/from-step-*/measures.csv && test -f part/from-step-*/newest.checkpoint || exit 9;",
             "--version");
  assert_int_equal(r.code, 0);
  test_hooke(&r, NULL, "run rope.lua --out part --quiet --until 0.1"); /* a new run replaces all of it */
  assert_int_equal(r.code, 0);
  test_hooke(&r, "test ! -e part/from-step-* || exit 9;", "--version");
  assert_int_equal(r.code, 0);
}

/* Without --out a run goes on in the folder in which its checkpoint lies, if that is its own; from its last part, too.
 */
static void it_goes_on_in_its_own_folder(void **state) {
  (void)state;
  static test_result r;
  stop("");
  test_hooke(&r, "rm -rf out;", "run rope.lua --resume part/newest.checkpoint --quiet --until 0.8");
  if (r.code != 0) fail_msg("code %d: %s", r.code, r.err);
  test_hooke(&r, "test -f part/from-step-*/newest.checkpoint && ! test -e out || exit 9;", "--version");
  assert_int_equal(r.code, 0);
  test_hooke(&r, NULL, "run rope.lua --resume part/from-step-*/newest.checkpoint --quiet");
  if (r.code != 0) fail_msg("code %d: %s", r.code, r.err);
  test_hooke(&r, "! test -e out && ! test -e part/from-step-*/from-step-* || exit 9;", "--version");
  assert_int_equal(r.code, 0);
  test_hooke(&r, "mkdir other; cp part/newest.checkpoint other;",
             "run rope.lua --resume other/newest.checkpoint --quiet");
  assert_int_equal(r.code, 0);
  test_hooke(&r, "test -e out/rope && test \"$(ls other)\" = newest.checkpoint || exit 9;", "--version");
  assert_int_equal(r.code, 0);
}

static void a_damaged_point_names_the_one_before(void **state) {
  (void)state;
  static test_result r;
  stop("");
  test_hooke(&r, "printf x | dd of=part/newest.checkpoint bs=1 seek=900 conv=notrunc 2>/dev/null;",
             "run rope.lua --resume part/newest.checkpoint --quiet");
  if (r.code != 4 || !strstr(r.err, "part/newest.checkpoint is cut short or damaged") ||
      !strstr(r.err, "a point before it is whole: --resume part/before.checkpoint"))
    fail_msg("code %d: %s", r.code, r.err);
  test_hooke(&r, NULL, "run rope.lua --resume part/before.checkpoint --until 0.5 --quiet");
  assert_int_equal(r.code, 0);
  test_hooke(&r, "rm part/before.checkpoint;", "run rope.lua --resume part/newest.checkpoint --quiet");
  assert_true(r.code == 4 && !strstr(r.err, "before it"));
}

static void another_scene_is_named_as_such(void **state) {
  (void)state;
  static test_result r;
  stop("");
  test_write("other.lua", scene);
  test_hooke(&r, NULL, "run other.lua --resume part/newest.checkpoint --quiet");
  if (r.code != 1 || !strstr(r.err, "it is of the scene rope.lua, and other.lua is named"))
    fail_msg("code %d: %s", r.code, r.err);
  test_hooke(&r, "mkdir -p moved; cp rope.lua lost_rope.lua moved;",
             "run moved/rope.lua --resume part/newest.checkpoint --quiet"); /* from somewhere else it is the same */
  if (r.code != 0) fail_msg("code %d: %s", r.code, r.err);
}

static void expect_refused(const char *arguments, const char *what) {
  static test_result r;
  char all[512];
  snprintf(all, sizeof all, "run rope.lua --resume part/newest.checkpoint --out part --quiet %s", arguments);
  test_hooke(&r, NULL, all);
  if (r.code != 1 || !strstr(r.err, "cannot be gone on from") || !strstr(r.err, what))
    fail_msg("code %d: expected '%s' in '%s'", r.code, what, r.err);
}

static void what_has_changed_is_named(void **state) {
  (void)state;
  char text[2048];
  stop("");
  expect_refused("N=10", "the parameter N was 9 and is 10");
  expect_refused("--seed 7", "the seed was 0 and is 7");
  expect_refused("--integrator rk4", "the integrator 'leapfrog' of the plugin leapfrog is no longer part of it");
  snprintf(text, sizeof text, "%s-- a comment\n", scene);
  test_write("rope.lua", text);
  expect_refused("", "the script rope.lua has changed");
  write_scene();
  snprintf(text, sizeof text, "%s-- a comment\n", module);
  test_write("lost_rope.lua", text);
  expect_refused("", "the script lost_rope.lua has changed");
}

static void a_plugin_that_has_changed_is_named(void **state) {
  (void)state;
  static test_result r;
  char text[2048];
  snprintf(text, sizeof text, "cp %s/plugins/forces/drag.so drag.so;", HK_BUILD);
  write_scene();
  test_write("own.lua", "local scene = hooke.scene { duration = 0.2, fps = 20 }\n"
                        "scene:particle { position = {0, 0, 0}, velocity = {1, 0, 0}, mass = 1 }\n"
                        "scene:force('./drag.so', { rate = 1 })\n"
                        "scene:output('checkpoint', { every = 2 })\n"
                        "return scene\n");
  test_hooke(&r, text, "run own.lua --trust --quiet --out own");
  if (r.code != 0) fail_msg("code %d: %s", r.code, r.err);
  test_hooke(&r, NULL, "run own.lua --resume own/newest.checkpoint --trust --quiet --out own");
  if (r.code != 0) fail_msg("code %d: %s", r.code, r.err);
  test_hooke(&r, "printf x >> drag.so;", "run own.lua --resume own/before.checkpoint --trust --quiet --out own");
  if (r.code != 1 || !strstr(r.err, "the force 'drag' of the plugin drag has changed"))
    fail_msg("%d: %s", r.code, r.err);
  test_hooke(&r, NULL, "run own.lua --resume own/before.checkpoint --quiet --out own"); /* rights are not in a file */
  assert_true(r.code != 0 && strstr(r.err, "--trust"));
}

/* A checkpoint is data: without its scene, which is shown, nothing runs; the rest of the command is shown as well. */
static void the_scene_is_named_and_the_command_is_shown(void **state) {
  (void)state;
  static test_result r;
  stop("--dt 0.001");
  test_hooke(&r, NULL, "run --resume part/newest.checkpoint");
  if (r.code != 1 || !strstr(r.err, "does not choose what is run: name its scene, as in hooke run /") ||
      !strstr(r.err, "/rope.lua N=9 --dt 0.001 stop=11 --resume part/newest.checkpoint"))
    fail_msg("code %d: %s", r.code, r.err);
  test_hooke(&r, NULL, "run rope.lua --resume part/newest.checkpoint --until 0.5");
  if (r.code != 0 ||
      !strstr(r.err, "goes on as hooke run rope.lua N=9 --dt 0.001 stop=11 --resume part/newest.checkpoint "
                     "--until 0.5\n"))
    fail_msg("code %d: %s", r.code, r.err);
  test_hooke(&r, NULL, "run rope.lua --trust --resume part/newest.checkpoint --quiet");
  if (r.code != 1 || !strstr(r.err, "with --trust nothing is taken from a checkpoint") || !strstr(r.err, "N=9"))
    fail_msg("code %d: %s", r.code, r.err);
  test_hooke(&r, NULL, "run rope.lua --trust N=9 stop=11 --dt 0.001 --resume part/newest.checkpoint --quiet");
  if (r.code != 0) fail_msg("code %d: %s", r.code, r.err);
}

/* part/newest.checkpoint with other words, under a checksum that is right. */
static void forge(const char *scene_path, const char *const *word) {
  char path[512], text[1 << 12];
  hk_checkpoint from = {0}, to = {0};
  hk_walk w = hk_walk_write(&to);
  size_t head = strlen(hk_checkpoint_magic);
  snprintf(path, sizeof path, "%s/part/newest.checkpoint", test_folder());
  assert_true(hk_walk_read_file(&from, path) && from.count > head);
  uint64_t old, now = (uint64_t)sprintf(text, "%s", scene_path) + 1;
  memcpy(&old, from.byte + head, sizeof old);
  for (size_t k = 0; word[k]; k++) now += (uint64_t)sprintf(text + now, "%s", word[k]) + 1;
  text[now++] = 0;
  const unsigned char *rest = from.byte + head + sizeof old + old;
  size_t left = (size_t)(from.byte + from.count - rest) - sizeof(uint64_t);
  assert_true(hk_walk_put(&w, from.byte, head) && hk_walk_put(&w, &now, sizeof now) && hk_walk_put(&w, text, now) &&
              hk_walk_put(&w, rest, left) && hk_walk_seal(&to, head));
  snprintf(path, sizeof path, "%s/forged.checkpoint", test_folder());
  assert_int_equal(hk_checkpoint_write(&to, path, NULL), HK_OK);
  hk_checkpoint_free(&from);
  hk_checkpoint_free(&to);
}

static void a_forged_checkpoint_commands_nothing(void **state) {
  (void)state;
  static test_result r;
  static const char *const forged[][3] = {
      {"--trust"},
      {"--state", "taken.csv"},
      {"--state=taken.csv"},
      {"--summary", "taken.json"},
      {"--out", "taken"},
      {"--with", "output:table"},
      {"--with=output:table"},
      {"--resume=part/before.checkpoint"},
      {"--watch"},
      {"--no-output"},
      {"-h"},
      {"taken.lua"},
      {"--threads", "1024"},
      {"--integrator", "rk4"} /* harmless: the last, which shows that the others could act */};
  enum { COUNT = sizeof forged / sizeof *forged };
  stop("");
  test_write("taken.lua", "if os then os.execute('touch TAKEN') end\nreturn dofile('rope.lua')\n");
  char own[512], other[512];
  snprintf(own, sizeof own, "%s/rope.lua", test_folder());
  snprintf(other, sizeof other, "%s/taken.lua", test_folder());
  for (size_t k = 0; k < COUNT; k++) {
    const char *word[] = {"N=9", "stop=11", forged[k][0], forged[k][1], NULL};
    forge(own, word);
    test_hooke(&r, NULL, "run rope.lua --resume forged.checkpoint --out again");
    if (k + 1 < COUNT && (r.code != 1 || !strstr(r.err, "cannot be gone on from: it asks for") || test_exists("again")))
      fail_msg("%s: code %d: %s", forged[k][0], r.code, r.err);
    if (k + 1 == COUNT && !strstr(r.err, "--integrator rk4")) fail_msg("code %d: %s", r.code, r.err);
  }
  static const char *const words[] = {"--trust", NULL};
  forge(other, words);
  test_hooke(&r, NULL, "run --resume forged.checkpoint");
  assert_true(r.code == 1 && strstr(r.err, "name its scene"));
  test_hooke(&r, NULL, "run rope.lua --resume forged.checkpoint");
  assert_true(r.code == 1 && strstr(r.err, "it is of the scene taken.lua, and rope.lua is named"));
  test_hooke(&r, NULL, "run taken.lua --resume forged.checkpoint");
  assert_true(r.code == 1 && strstr(r.err, "it asks for --trust"));
  test_hooke(&r, NULL, "run --trust --resume forged.checkpoint");
  assert_int_equal(r.code, 1);
  assert_true(!test_exists("TAKEN") && !test_exists("taken") && !test_exists("taken.csv") &&
              !test_exists("taken.json"));
}

static void what_is_no_checkpoint_is_refused(void **state) {
  (void)state;
  static test_result r;
  write_scene();
  test_hooke(&r, NULL, "run --resume rope.lua");
  assert_true(r.code == 4 && strstr(r.err, "rope.lua is no checkpoint"));
  test_hooke(&r, NULL, "run --resume nowhere.checkpoint");
  assert_true(r.code == 4 && strstr(r.err, "cannot read nowhere.checkpoint"));
  test_hooke(&r, NULL, "run --resume");
  assert_true(r.code == 1 && strstr(r.err, "--resume needs a value"));
}

/* Two runs at once: the second is told, and takes nothing from the first. */
static void a_folder_takes_one_run_at_a_time(void **state) {
  (void)state;
  static test_result r;
  test_write("long.lua", "local scene = hooke.scene { duration = 1e4, fps = 60, dt = 1e-4 }\n"
                         "scene:particle { position = {0, 0, 0}, velocity = {1, 0, 0}, mass = 1 }\n"
                         "scene:measure('x', function(s) return s:position(1)[1] end)\n"
                         "return scene\n");
  test_hooke(&r,
             "\"" HK_BUILD "/hooke\" run long.lua --quiet --out both 2>/dev/null & first=$!; "
             "trap 'kill -INT $first; wait $first' EXIT; "
             "while ! test -s both/measures.csv; do sleep 0.05; done;",
             "run long.lua --quiet --out both");
  if (r.code != 4 || !strstr(r.err, "another run is writing to both")) fail_msg("code %d: %s", r.code, r.err);
  assert_true(test_exists("both/measures.csv"));
  test_hooke(&r, NULL, "run long.lua --quiet --out both --until 0.1");
  assert_int_equal(r.code, 0);
}

/* No right is needed for a file that the user names. */
static void a_checkpoint_may_lie_anywhere(void **state) {
  (void)state;
  static test_result r;
  write_scene();
  test_hooke(&r, "rm -rf deep; mkdir deep; cp *.lua deep;", "run deep/rope.lua --quiet --out away");
  if (r.code != 0 && r.code != 5) fail_msg("code %d: %s", r.code, r.err);
  int code = r.code;
  test_hooke(&r, NULL, "run deep/rope.lua --resume away/before.checkpoint --quiet --out further");
  if (r.code != code) fail_msg("code %d: %s", r.code, r.err);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(it_goes_on_with_scene_parameters_and_options),
      cmocka_unit_test(plugins_of_the_command_line_go_on),
      cmocka_unit_test(a_step_that_is_given_now_is_kept),
      cmocka_unit_test(a_run_does_not_go_back),
      cmocka_unit_test(the_files_of_the_first_part_stay),
      cmocka_unit_test(it_goes_on_in_its_own_folder),
      cmocka_unit_test(a_damaged_point_names_the_one_before),
      cmocka_unit_test(another_scene_is_named_as_such),
      cmocka_unit_test(what_has_changed_is_named),
      cmocka_unit_test(a_plugin_that_has_changed_is_named),
      cmocka_unit_test(a_checkpoint_may_lie_anywhere),
      cmocka_unit_test(the_scene_is_named_and_the_command_is_shown),
      cmocka_unit_test(a_forged_checkpoint_commands_nothing),
      cmocka_unit_test(what_is_no_checkpoint_is_refused),
      cmocka_unit_test(a_folder_takes_one_run_at_a_time),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
