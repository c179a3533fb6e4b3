/* A file of the output folder has one writer: two outputs that would write one are refused before the first step, as
 * are names that hooke itself writes. Unnoticed, the second would write over what the first has written. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static void write_scene(const char *outputs) {
  char text[1024];
  snprintf(text, sizeof text,
           "local scene = hooke.scene { duration = 0.1, fps = 20 }\n"
           "scene:grid { nx = 3, ny = 3, width = 1, height = 1, mass = 1 }\n"
           "scene:force('gravity')\n"
           "%s\nreturn scene\n",
           outputs);
  test_write("pair.lua", text);
}

static void two_outputs_of_one_file_are_refused_before_the_first_step(void **state) {
  (void)state;
  static const char *const outputs[] = {"table", "trajectory", "checkpoint"};
  static test_result r;
  for (size_t k = 0; k < sizeof outputs / sizeof *outputs; k++) {
    char text[128], expected[128];
    snprintf(text, sizeof text, "scene:output('%s') scene:output('%s')", outputs[k], outputs[k]);
    snprintf(expected, sizeof expected, "'%s#2': the output '%s' writes ", outputs[k], outputs[k]);
    write_scene(text);
    test_hooke(&r, NULL, "run pair.lua --quiet --out pair");
    if (r.code != 1 || !strstr(r.err, expected)) fail_msg("%s: code %d: %s", outputs[k], r.code, r.err);
    assert_false(test_exists("pair/summary.json"));
  }
}

static void an_output_of_another_kind_is_no_exception(void **state) {
  (void)state;
  static test_result r;
  write_scene("scene:output('table', { file = 'newest.checkpoint' }) scene:output('checkpoint')");
  test_hooke(&r, NULL, "run pair.lua --quiet --out pair");
  if (r.code != 1 || !strstr(r.err, "'checkpoint': the output 'table' writes newest.checkpoint"))
    fail_msg("code %d: %s", r.code, r.err);
}

static void what_hooke_itself_writes_is_taken(void **state) {
  (void)state;
  static const char *const names[] = {"summary.json", "measures.csv"};
  static test_result r;
  for (size_t k = 0; k < 2; k++) {
    char text[128], expected[128];
    snprintf(text, sizeof text, "scene:output('table', { file = '%s' })", names[k]);
    snprintf(expected, sizeof expected, "'table': hooke itself writes %s", names[k]);
    write_scene(text);
    test_hooke(&r, NULL, "run pair.lua --quiet --out pair");
    if (r.code != 1 || !strstr(r.err, expected)) fail_msg("code %d: %s", r.code, r.err);
  }
}

/* Twice: a new run may write the files of the one before. */
static void outputs_with_names_of_their_own_go_together(void **state) {
  (void)state;
  static test_result r;
  write_scene("scene:output('table') scene:output('table', { every = 2, file = 'two.csv' })");
  for (int k = 0; k < 2; k++) {
    test_hooke(&r, NULL, "run pair.lua --quiet --out pair");
    if (r.code != 0) fail_msg("code %d: %s", r.code, r.err);
    assert_true(test_exists("pair/table.csv") && test_exists("pair/two.csv") && test_exists("pair/summary.json"));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(two_outputs_of_one_file_are_refused_before_the_first_step),
      cmocka_unit_test(an_output_of_another_kind_is_no_exception),
      cmocka_unit_test(what_hooke_itself_writes_is_taken),
      cmocka_unit_test(outputs_with_names_of_their_own_go_together),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
