/* A run and hooke explain say which libraries solve their linear systems, and warn when the BLAS among them is the
 * reference one. That one is put before the system's by tests/fixtures/reference_blas.c under its usual file name. */
#include "tests/support/command.h"

#include <limits.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

/* A matrix of two particles has a solver that needs no library, so CHOLMOD is named where it is to be seen; that of 40
 * particles with springs between all has not. */

static const char chain[] = "local scene = hooke.scene { duration = 0.02, fps = 100, integrator = 'backward_euler' }\n"
                            "local a = scene:particle { position = {0, 0, 0}, mass = 1 }\n"
                            "local b = scene:particle { position = {1, 0, 0}, mass = 1 }\n"
                            "scene:pin({a})\n"
                            "scene:force('springs', { edges = {{a, b}}, k = 10 })\nreturn scene\n";

static const char star[] = "local scene = hooke.scene { duration = 0.02, fps = 100, integrator = 'backward_euler' }\n"
                           "local edges = {}\n"
                           "for i = 1, 40 do\n"
                           "  scene:particle { position = {i, i * i, 0}, mass = 1 }\n"
                           "  for j = 1, i - 1 do edges[#edges + 1] = {j, i} end\n"
                           "end\n"
                           "scene:force('springs', { edges = edges, k = 10 })\nreturn scene\n";

static void run(const char *before, const char *arguments) {
  test_hooke(&r, before, arguments);
  if (r.code != 0) fail_msg("%s: exit %d: %s", arguments, r.code, r.err);
}

static size_t times(const char *text, const char *part) {
  size_t count = 0;
  for (; (text = strstr(text, part)); text += strlen(part)) count++;
  return count;
}

static void says(const char *text, const char *part) {
  if (!strstr(text, part)) fail_msg("no '%s' in: %s", part, text);
}

/* What goes before a command so that it finds the fixture's dgemm_ first. It may be a sanitized one, whose run-time
 * library then is not the first that is loaded. */
static const char *on_the_reference_blas(void) {
  static char before[2 * PATH_MAX];
  char copy[2 * PATH_MAX];
  snprintf(copy, sizeof copy, "cp '%s/tests/fixtures/reference_blas.so' '%s/libblas.so.3'", HK_BUILD, test_folder());
  assert_int_equal(system(copy), 0);
  snprintf(before, sizeof before,
           "ASAN_OPTIONS=verify_asan_link_order=0:intercept_tls_get_addr=0 LD_PRELOAD='%s/libblas.so.3'",
           test_folder());
  return before;
}

static void a_summary_names_the_libraries_of_the_solver(void **state) {
  (void)state;
  test_write("chain.lua", chain);
  run(NULL, "run chain.lua --solver cholmod --json");
  says(r.out, "\"solver_libraries\":\"CHOLMOD ");
  run(NULL, "run chain.lua --solver cholmod");
  says(r.out, "solver libraries  CHOLMOD ");
  run(NULL, "run chain.lua --solver umfpack --json");
  says(r.out, "\"solver_libraries\":\"UMFPACK ");
}

static void without_linear_systems_there_are_no_libraries_to_name(void **state) {
  (void)state;
  test_write("chain.lua", chain);
  run(NULL, "run chain.lua --integrator leapfrog --json");
  says(r.out, "\"solver_libraries\":\"\"");
  run(NULL, "run chain.lua --integrator leapfrog");
  assert_null(strstr(r.out, "solver libraries"));
  run(NULL, "run chain.lua --solver pcg --json"); /* needs none */
  says(r.out, "\"solver_libraries\":\"\"");
}

static void the_solver_of_constraints_is_named_as_well(void **state) {
  char scene[PATH_MAX + 512];
  (void)state;
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 0.02, fps = 100, integrator = 'leapfrog' }\n"
           "local a = scene:particle { position = {0, 0, 0}, mass = 1 }\n"
           "local b = scene:particle { position = {1, 0, 0}, mass = 1 }\n"
           "scene:pin({a})\n"
           "scene:constraint('%s/tests/fixtures/bar.so', { edges = {{a, b}}, label = 'bar' })\nreturn scene\n",
           HK_BUILD);
  test_write("bar.lua", scene);
  run(NULL, "run bar.lua --trust --solver cholmod --json");
  says(r.out, "\"solver_libraries\":\"CHOLMOD ");
  run(NULL, "run bar.lua --trust --json"); /* one bar has a solver that needs none */
  says(r.out, "\"solver\":\"banded\"");
  says(r.out, "\"solver_libraries\":\"\"");
}

static void the_reference_blas_is_warned_of_once_and_with_the_remedy(void **state) {
  (void)state;
  const char *before = on_the_reference_blas();
  test_write("chain.lua", chain);
  run(before, "run chain.lua --solver cholmod");
  says(r.out, ", reference BLAS (slow: install OpenBLAS)");
  assert_int_equal(times(r.err, "runs on the reference BLAS"), 1);
  says(r.err, "/libblas.so.3)");
  says(r.err, "tools/install-deps run");
  run(before, "run chain.lua --solver cholmod --json");
  says(r.out, ", reference BLAS (slow: install OpenBLAS)\"");
  assert_int_equal(times(r.out, "CHOLMOD runs on the reference BLAS"), 1);
  run(before, "run chain.lua --solver umfpack --json");
  assert_int_equal(times(r.out, "UMFPACK runs on the reference BLAS"), 1);
  run(before, "run chain.lua"); /* does not need it, */
  assert_int_equal(times(r.err, "reference BLAS"), 0);
  run(before, "run chain.lua --integrator leapfrog"); /* nor any solver */
  assert_int_equal(times(r.err, "reference BLAS"), 0);
}

static void explain_names_the_blas_of_an_implicit_method_and_warns(void **state) {
  (void)state;
  const char *before = on_the_reference_blas();
  char named[sizeof star + 64];
  test_write("chain.lua", chain);
  test_write("star.lua", star);
  snprintf(named, sizeof named, "%.*sscene:solver('cholmod')\nreturn scene\n", (int)(strstr(star, "return") - star),
           star);
  test_write("named.lua", named);
  run(NULL, "explain star.lua");
  says(r.out, "linear systems\n  CHOLMOD ");
  run(NULL, "explain star.lua --json");
  says(r.out, "\"solver_libraries\":\"CHOLMOD ");
  run(before, "explain star.lua"); /* needs it for the order of rows alone */
  assert_null(strstr(r.out, "reference BLAS"));
  run(before, "explain named.lua");
  says(r.out, ", reference BLAS (slow: install OpenBLAS)\n");
  says(r.out, "\nwarning: named.lua:8: cholmod: CHOLMOD runs on the reference BLAS");
  says(r.out, "tools/install-deps run");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_summary_names_the_libraries_of_the_solver),
      cmocka_unit_test(without_linear_systems_there_are_no_libraries_to_name),
      cmocka_unit_test(the_solver_of_constraints_is_named_as_well),
      cmocka_unit_test(the_reference_blas_is_warned_of_once_and_with_the_remedy),
      cmocka_unit_test(explain_names_the_blas_of_an_implicit_method_and_warns),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
