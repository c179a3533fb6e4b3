/* hooke stability: measured limits are those of closed forms, a method that states too much is found out, and the
 * corpus of hard cases is judged by what its files say. The corpus itself is held by hard.c. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static test_result r;
static char text[1 << 16];

static void read_file(const char *name) {
  char path[512];
  snprintf(path, sizeof path, "%s/%s", test_folder(), name);
  FILE *file = fopen(path, "r");
  if (!file) fail_msg("%s was not written: %s", name, r.err);
  text[fread(text, 1, sizeof text - 1, file)] = 0;
  fclose(file);
}

/* The number in that column (from 0) of the line of the CSV read that begins with `line`; NAN: empty. */
static double column(const char *line, int number) {
  const char *at = strstr(text, line);
  if (!at) fail_msg("no line '%s' in: %s", line, text);
  for (; number > 0 && *at && *at != '\n'; at++) number -= *at == ',';
  char *end;
  double value = strtod(at, &end);
  return end == at ? NAN : value;
}

static void near(double value, double expected, double tolerance) {
  print_message("%.9g, expected %.9g\n", value, expected);
  assert_true(fabs(value - expected) <= tolerance * fabs(expected));
}

static char boasting[512];

static const char *with_boaster(void) {
  snprintf(boasting, sizeof boasting,
           "mkdir -p p/integrators && cp %s/tests/fixtures/boaster.so p/integrators/ && HOOKE_PLUGIN_PATH=$PWD/p ",
           HK_BUILD);
  return boasting;
}

/* Seventeen stages grow so fast beyond the limit that a run of several oscillators ends before its last step. */
static void a_run_that_diverges_is_measured_in_parts(void **state) {
  (void)state;
  test_hooke(&r, NULL, "stability --quiet --out many_stages --integrators kahan_li8");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  if (strstr(r.out, ".lua:")) fail_msg("a line of the tool: %s", r.out);
  read_file("many_stages/linear.csv");
  near(column("kahan_li8,0,", 2), column("kahan_li8,0,", 3), 1e-4);
  near(column("kahan_li8,10,", 2), column("kahan_li8,10,", 3), 1e-4);
}

static void a_method_that_states_too_much_is_named(void **state) {
  (void)state;
  test_hooke(&r, with_boaster(), "stability --quiet --out boast --integrators boaster");
  assert_int_equal(r.code, 1);
  assert_non_null(strstr(r.err, "boaster states h w = 3 at xi = 0, and 2 is measured"));
}

static const char oscillator[] = "local k = param('k', 100, 'N/m')\nlocal scene = hooke.scene {}\n"
                                 "scene:particle { position = {1, 0, 0}, mass = 1 }\n"
                                 "scene:force('central', { strength = k })\nreturn scene\n";

/* The measured limit is bracketed to 2 %. */
static void the_limit_on_a_scene_is_that_of_its_frequency(void **state) {
  (void)state;
  test_write("oscillator.lua", oscillator);
  test_hooke(&r, NULL, "stability oscillator.lua --quiet --out scene --integrators leapfrog,rk4 --over k=100,400");
  if (r.code != 0) fail_msg("exit %d: %s", r.code, r.err);
  read_file("scene/limits.csv");
  near(column("leapfrog,,", 6), 0.2, 0.02);
  near(column("rk4,,", 6), 0.2 * sqrt(2), 0.02);
  near(column("leapfrog,k,400,", 6), 0.1, 0.02);
  test_hooke(&r, NULL, "stability oscillator.lua --over m=2,3 --quiet");
  assert_int_equal(r.code, 1);
  assert_non_null(strstr(r.err, "m"));
}

static void an_estimate_above_the_limit_is_named(void **state) {
  (void)state;
  test_write("oscillator.lua", oscillator);
  test_hooke(&r, with_boaster(), "stability oscillator.lua --quiet --out boast --integrators boaster --over k=100");
  assert_int_equal(r.code, 1);
  assert_non_null(strstr(r.err, "boaster, as given: the estimate 0.3 s is above the limit"));
}

static void write_case(const char *name, const char *comment, const char *answer) {
  char script[1024], path[64];
  snprintf(script, sizeof script,
           "--[[\n%s]]\nlocal scene = hooke.scene { duration = 0.5, fps = 200, accuracy = 1e-3 }\n"
           "scene:particle { position = {1, 0, 0}, mass = 1 }\nscene:force('central', { strength = 9 })\n"
           "scene:exact(function(t) return %s, 0, 0 end)\nreturn scene\n",
           comment, answer);
  snprintf(path, sizeof path, "cases/%s", name);
  test_write(path, script);
}

static void cases(void) {
  test_hooke(&r, "rm -rf cases && mkdir -p cases &&", "--version");
  assert_int_equal(r.code, 0);
}

static void hard(const char *more, int code, const char *said) {
  char arguments[512];
  snprintf(arguments, sizeof arguments, "stability --hard cases --quiet --integrators leapfrog,euler,local_global %s",
           more);
  test_hooke(&r, NULL, arguments);
  if (r.code != code) fail_msg("%s: exit %d instead of %d: %s%s", arguments, r.code, code, r.out, r.err);
  if (!strstr(code && *r.err ? r.err : r.out, said)) fail_msg("no '%s' in: %s%s", said, r.out, r.err);
}

static void the_matrix_holds_what_cases_demand(void **state) {
  (void)state;
  cases();
  write_case("right.lua", "what: a swing\nright: cos 3 t\nmust: leapfrog\nalso: leapfrog dt=1/500; euler dt=1e-4\n",
             "math.cos(3 * t)");
  hard("", 0, "1 cases, 5 runs: 3 ok, 2 said they are not, 0 above the limit of steps, 0 do not fit; 0 failed");
  hard("--part 1/2", 0, "1 cases, 3 runs:");
  hard("--part 3/2", 1, "1 <= K <= N");
  hard("--csv matrix.csv", 0, "right ok x  x");
  read_file("matrix.csv");
  assert_non_null(strstr(text, "right,euler,euler dt=1e-4,false,ok"));
}

static void ok_beyond_the_bound_fails(void **state) {
  (void)state;
  cases();
  write_case("wrong.lua", "what: a swing\nright: nothing\nmust: none\n", "math.cos(3.1 * t)");
  hard("", 1, "said ok beyond the bound");
  hard("--json", 1, "\"ended\":\"wrong\"");
}

static void a_bound_that_must_be_reached_fails_when_it_is_not(void **state) {
  (void)state;
  cases();
  write_case("must.lua", "what: a swing\nright: cos 3 t\nmust: leapfrog, local_global\n", "math.cos(3 * t)");
  hard("", 1, "it has to reach the bound: the error is about");
}

static void a_case_that_is_not_described_is_refused(void **state) {
  (void)state;
  cases();
  write_case("slip.lua", "what: a swing\nright: cos 3 t\nmust: leapfrg\n", "1");
  hard("", 1, "did you mean 'leapfrog'?");
  write_case("slip.lua", "what: a swing\nright: cos 3 t\n", "1");
  hard("", 1, "its comment says nothing for 'must'");
  write_case("slip.lua", "what: a swing\nright: cos 3 t\nmust: none\nalso: leapfrog h=1\n", "1");
  hard("", 1, "'h=1' is neither dt=SECONDS nor tol=NUMBER");
  hard("--case slop", 1, "slip.lua: also");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_run_that_diverges_is_measured_in_parts),
      cmocka_unit_test(a_method_that_states_too_much_is_named),
      cmocka_unit_test(the_limit_on_a_scene_is_that_of_its_frequency),
      cmocka_unit_test(an_estimate_above_the_limit_is_named),
      cmocka_unit_test(the_matrix_holds_what_cases_demand),
      cmocka_unit_test(ok_beyond_the_bound_fails),
      cmocka_unit_test(a_bound_that_must_be_reached_fails_when_it_is_not),
      cmocka_unit_test(a_case_that_is_not_described_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
