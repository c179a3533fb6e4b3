/* Validation as a user meets it: the orders and the extrapolation of made-up series, whose limits are known; a wrong
 * reference is found; a file of one's own, and what is wrong in it, in one sentence with the line. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

static void validate(const char *arguments, int code) {
  char all[2048];
  snprintf(all, sizeof all, "validate %s", arguments);
  test_hooke(&r, NULL, all);
  if (r.code != code) fail_msg("%s: exit %d instead of %d: %s%s", arguments, r.code, code, r.out, r.err);
}

static void says(const char *where, const char *text) {
  if (!strstr(where, text)) fail_msg("no '%s' in: %s%s", text, r.out, r.err);
}

/* A problem without a scene: `solve` is an expression of at. */
static void write_series(const char *name, const char *levels, const char *reference, const char *solve) {
  char text[2048];
  snprintf(text, sizeof text,
           "local validation = require('validation')\n"
           "return validation.problem {\n"
           "  title = 'a series', tolerance = 1e-9, why = 'rounding',\n"
           "  quantities = { { name = 'limit', reference = %s, source = 'made up' } },\n"
           "  %s,\n"
           "  solve = function(at) return %s end,\n"
           "}\n",
           reference, levels, solve);
  test_write(name, text);
}

static void orders_and_limits_of_series_are_found(void **state) {
  (void)state;
  write_series("two.lua", "space = { 4, 8, 16 }, order = { space = 2 }", "3", "3 + 5 / at.n^2");
  validate("two.lua --no-page", 0);
  says(r.out, "order in space 2.00");
  /* Levels that are no geometric sequence, order 3. */
  write_series("three.lua", "time = { 0.5, 0.2, 0.15 }, order = { time = 3 }", "3", "3 - 0.1 * at.h^3");
  validate("three.lua --no-page", 0);
  says(r.out, "order in time 3.00");
  /* Both at once: the error in time is that at the coarsest n, and the product of both is not there. */
  write_series("both.lua", "space = { 4, 8, 16 }, time = { 0.4, 0.2, 0.1 }, order = { space = 2, time = 1 }", "3",
               "3 + 5 / at.n^2 + 0.1 * at.h");
  validate("both.lua --no-page", 0);
  says(r.out, "order in space 2.00, in time 1.00");
  /* All levels are the answer already. */
  write_series("exact.lua", "time = { 0.4, 0.2, 0.1 }, order = { time = 2 }", "3", "3");
  validate("exact.lua --no-page", 0);
  says(r.out, "16.0 digits, order in time exact");
}

static void what_is_wrong_is_said(void **state) {
  (void)state;
  write_series("planted.lua", "space = { 4, 8, 16 }", "3.000001", "3 + 5 / at.n^2");
  validate("planted.lua --no-page", 5);
  says(r.out, "off by 3.3e-07, more than the 1e-09 allowed");
  write_series("order.lua", "space = { 4, 8, 16 }, order = { space = 2 }", "3", "3 + 5 / at.n");
  validate("order.lua --no-page", 5);
  says(r.out, "order 1.00 in space, expected 2");
  write_series("forth.lua", "space = { 4, 8, 16 }", "3", "3 + (at.n == 8 and -1 or 1) / at.n");
  validate("forth.lua --no-page", 5);
  says(r.out, "no regular convergence in space: the values go back and forth");
  write_series("nan.lua", "space = { 4, 8, 16 }", "3", "0 / 0");
  validate("nan.lua --no-page", 5);
  says(r.out, "'limit' is no finite number");
}

static void errors_of_a_problem_are_one_sentence_with_the_line(void **state) {
  (void)state;
  write_series("twice.lua", "space = { 4, 8 }", "3", "3");
  validate("twice.lua --no-page", 1);
  says(r.err, "twice.lua:5: space: at least three levels show an order; here are 2");
  write_series("field.lua", "spaces = { 4, 8, 16 }", "3", "3");
  validate("field.lua --no-page", 1);
  says(r.err, "field.lua:5: a problem has no field 'spaces'");
  write_series("nil.lua", "space = { 4, 8, 16 }", "3", "at.m + 1");
  validate("nil.lua --no-page", 5);
  says(r.out, "nil.lua:6:");
}

/* A problem is a stranger's script: it reaches no files, no plugin but the installation's, and no other run's time. */
static void a_problem_runs_in_the_sandbox(void **state) {
  (void)state;
  write_series("file.lua", "space = { 4, 8, 16 }", "3", "io.open('/etc/passwd') and 3");
  validate("file.lua --no-page", 5);
  says(r.out, "file.lua:6: io.open is not available to scenes");
  write_series("native.lua", "space = { 4, 8, 16 }", "3",
               "hooke.scene {}:force('" HK_BUILD "/tests/fixtures/weak_central.so', { strength = 1 })");
  validate("native.lua --no-page", 5);
  says(r.out, "is native code outside the installation");
  write_series("late.lua", "space = { 4, 8, 16 }", "3", "(function() while true do end end)()");
  validate("late.lua --no-page --timeout 0.2", 5);
  says(r.out, "ended after 0.2 s");
}

/* The page: every digit in the table of numbers; without gnuplot no figures, and the exit code says so. */
static void the_page_has_tables_and_figures(void **state) {
  (void)state;
  bool gnuplot = system("command -v gnuplot >/dev/null") == 0;
  char path[1024], text[4096] = "";
  write_series("page.lua", "space = { 4, 8, 16 }, order = { space = 2 }", "1 / 3", "1 / 3 + 5 / at.n^2");
  validate("page.lua --out here", gnuplot ? 0 : 4);
  snprintf(path, sizeof path, "%s/here/validate.csv", test_folder());
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  text[fread(text, 1, sizeof text - 1, file)] = 0;
  fclose(file);
  assert_non_null(strstr(text, "\"yours\",\"page\",\"limit\",\"\",0.33333333333333331,0.333333333333333"));
  assert_true(test_exists("here/validate.md"));
  assert_true(test_exists("here/validate.pdf") == gnuplot && test_exists("here/yours.png") == gnuplot);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(orders_and_limits_of_series_are_found),
      cmocka_unit_test(what_is_wrong_is_said),
      cmocka_unit_test(errors_of_a_problem_are_one_sentence_with_the_line),
      cmocka_unit_test(the_page_has_tables_and_figures),
      cmocka_unit_test(a_problem_runs_in_the_sandbox),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
