/* The last file of a run: summary.json holds what --json prints, for any verdict, and only beside other files. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const char ball[] = "local g = param('g', 9.81, 'N/kg')\n"
                           "local scene = hooke.scene { duration = 0.5, integrator = 'leapfrog', dt = 1e-2 }\n"
                           "scene:particle { position = {0, 0, 1}, mass = 1 }\n"
                           "scene:force('gravity', { g = { 0, 0, -g } })\n"
                           "%s\n"
                           "return scene\n";
static const char measured[] = "scene:measure('z', function(s) return s:position(1)[3] end)";

static test_result r;

static void write_ball(const char *more) {
  char text[1024];
  snprintf(text, sizeof text, ball, more);
  test_write("ball.lua", text);
}

static const char *file_of(const char *name) {
  static char text[1 << 14], path[512];
  snprintf(path, sizeof path, "%s/%s", test_folder(), name);
  FILE *file = fopen(path, "r");
  if (!file) fail_msg("there is no %s", name);
  size_t got = fread(text, 1, sizeof text - 1, file);
  fclose(file);
  text[got] = 0;
  return text;
}

static void summary_json_is_what_json_prints(void **state) {
  (void)state;
  write_ball(measured);
  test_hooke(&r, NULL, "run ball.lua g=2.5 --json --accuracy 1e-3 --out checked");
  assert_int_equal(r.code, 0);
  const char *text = file_of("checked/summary.json");
  assert_string_equal(text, r.out); /* the verdict after the comparison with other runs, too */
  assert_non_null(strstr(text, "\"the parameter g\":\"2.5\""));
  assert_non_null(strstr(text, "\"the seed\":\"0\""));
}

static void a_run_without_files_leaves_none(void **state) {
  (void)state;
  write_ball("");
  test_hooke(&r, NULL, "run ball.lua --out empty");
  assert_int_equal(r.code, 0);
  assert_false(test_exists("empty"));
  write_ball(measured);
  test_hooke(&r, NULL, "run ball.lua --no-output --out empty");
  assert_false(test_exists("empty"));
}

static void a_run_that_diverges_says_so_in_it(void **state) {
  (void)state;
  test_write("wild.lua", "local scene = hooke.scene { duration = 1, integrator = 'leapfrog', dt = 1 / 60 }\n"
                         "scene:particle { position = {1, 0, 0}, mass = 1 }\n"
                         "scene:force('central', { strength = 1e9 })\n"
                         "scene:measure('x', function(s) return s:position(1)[1] end)\n"
                         "return scene\n");
  test_hooke(&r, NULL, "run wild.lua --out wild");
  assert_int_equal(r.code, 3);
  assert_non_null(strstr(file_of("wild/summary.json"), "\"verdict\":\"diverged\""));
}

static void runs_that_a_script_drives_leave_one_each(void **state) {
  (void)state;
  test_write("drives.lua", "for k = 1, 2 do\n"
                           "  local scene = hooke.scene { duration = 0.1 * k, integrator = 'leapfrog', dt = 1e-2 }\n"
                           "  scene:particle { position = {0, 0, 1}, mass = 1 }\n"
                           "  scene:force('gravity', { g = { 0, 0, -1 } })\n"
                           "  scene:measure('z', function(s) return s:position(1)[3] end)\n"
                           "  scene:run {}\n"
                           "end\n");
  test_hooke(&r, NULL, "run drives.lua --out drives");
  assert_int_equal(r.code, 0);
  assert_true(test_json(file_of("drives/summary.json"), "end") == 0.2); /* the second run took the place of the first */
}

static void a_new_run_of_the_scene_replaces_it_and_a_file_of_the_user_stays(void **state) {
  (void)state;
  write_ball(measured);
  test_hooke(&r, NULL, "run ball.lua g=1 --out again");
  test_hooke(&r, NULL, "run ball.lua g=2 --out again");
  assert_int_equal(r.code, 0);
  assert_non_null(strstr(file_of("again/summary.json"), "\"the parameter g\":\"2\""));
  test_hooke(&r, "mkdir -p own && echo mine >own/summary.json;", "run ball.lua --out own");
  assert_int_equal(r.code, 4);
  assert_non_null(strstr(r.err, "summary.json is not from a run of this scene"));
  assert_string_equal(file_of("own/summary.json"), "mine\n");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(summary_json_is_what_json_prints),
      cmocka_unit_test(a_run_without_files_leaves_none),
      cmocka_unit_test(a_run_that_diverges_says_so_in_it),
      cmocka_unit_test(runs_that_a_script_drives_leave_one_each),
      cmocka_unit_test(a_new_run_of_the_scene_replaces_it_and_a_file_of_the_user_stays),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
