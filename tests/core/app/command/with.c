/* hooke run --with: plugins beside those of the scene; --summary: the summary in a file. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

/* A ball that falls from rest for one second. */
static const char scene[] = "local scene = hooke.scene { duration = 1 }\n"
                            "scene:particle { mass = 1, position = { 0, 0, 9 } }\n"
                            "scene:force('gravity', {})\n"
                            "scene:measure('z', function(s) return s:position(1)[3] end)\n"
                            "return scene\n";

static void run(const char *arguments) {
  test_write("ball.lua", scene);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0) fail_msg("%s: exit %d: %s", arguments, r.code, r.err);
}

/* g/2 = 4.905 m, exact for leapfrog but for rounding; upwards with another force of twice the size. */
static void an_added_force_acts(void **state) {
  (void)state;
  run("run ball.lua --json");
  assert_true(fabs(test_json(r.out, "z") - (9 - 4.905)) < 1e-9);
  run("run ball.lua --json --with force:central:strength=0");
  assert_true(fabs(test_json(r.out, "z") - (9 - 4.905)) < 1e-9);
  run("run ball.lua --json --with force:central:strength=1 --dt 1e-4 --integrator rk4");
  /* z'' = -z - g from rest: (9 + g) cos 1 - g */
  assert_true(fabs(test_json(r.out, "z") - ((9 + 9.81) * cos(1) - 9.81)) < 1e-9);
}

static void an_added_output_writes_even_without_the_scenes_own(void **state) {
  (void)state;
  run("run ball.lua --with output:table --with output:table:file=second.csv,every=10");
  assert_true(test_exists("out/ball/table.csv") && test_exists("out/ball/second.csv"));
  run("run ball.lua --no-output --with output:table --out other");
  assert_true(test_exists("other/table.csv"));
  assert_false(test_exists("other/measures.csv"));
}

static void what_cannot_be_added_is_said(void **state) {
  (void)state;
  test_refused(scene, "--with table", 1, "--with: 'table' is not KIND:NAME");
  test_refused(scene, "--with integrator:rk4", 1, "where KIND is force, constraint, corrector, source or output");
  test_refused(scene, "--with output:tabel", 1, "there is no output 'tabel'; did you mean 'table'?");
  test_refused(scene, "--with output:table:evry=2", 1, "'evry'");
  test_refused(scene, "--with force:springs", 1, "the parameter 'edges'");
  test_refused(scene, "--with", 1, "--with needs a value");
}

static void the_summary_is_in_a_file_as_well(void **state) {
  (void)state;
  run("run ball.lua --summary s.json && cat s.json");
  assert_true(fabs(test_json(r.out, "z") - (9 - 4.905)) < 1e-9);
  assert_non_null(strstr(r.out, "verdict"));
  test_refused(scene, "--summary none/s.json", 4, "--summary: cannot write none/s.json: No such file");
  test_refused(scene, "--summary /dev/full", 4, "--summary: cannot write /dev/full: No space left");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_added_force_acts),
      cmocka_unit_test(an_added_output_writes_even_without_the_scenes_own),
      cmocka_unit_test(what_cannot_be_added_is_said),
      cmocka_unit_test(the_summary_is_in_a_file_as_well),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
