/* The tools as a user meets them: catalogue, explanation, and a plugin from the template that compiles and is right. */
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

static void says(const char *arguments, int code, const char *text) {
  test_hooke(&r, NULL, arguments);
  if (r.code != code) fail_msg("%s: exit %d instead of %d: %s", arguments, r.code, code, r.err);
  if (!strstr(code ? r.err : r.out, text)) fail_msg("%s: no '%s' in: %s%s", arguments, text, r.out, r.err);
}

static void plugins_lists_every_kind_and_describes_one(void **state) {
  (void)state;
  const char *const names[] = {"gravity", "drag",     "springs", "central", "leapfrog",
                               "dopri5",  "stoermer", "cholmod", "frames",  "table"};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) says("plugins", 0, names[k]);
  says("plugins springs", 0, "damping     N s/m");
  says("plugins springs", 0, "facets      implicit/1, bounds/1, elements/1, parts/1");
  says("plugins rk4", 0, "order       4, 4 evaluations");
  says("plugins sprngs", 1, "did you mean 'springs'?");
}

static void failed_loads_are_listed_with_the_reason(void **state) {
  (void)state;
  char before[512];
  snprintf(before, sizeof before,
           "mkdir -p p/forces && cp %s/tests/fixtures/wrong_abi.so p/forces/ && HOOKE_PLUGIN_PATH=$PWD/p ", HK_BUILD);
  test_hooke(&r, before, "plugins");
  assert_int_equal(r.code, 0);
  assert_non_null(strstr(r.out, "could not be loaded"));
  assert_non_null(strstr(r.out, "built for plugin interface 4.0 and this hooke has 3.5"));
}

static void explain_tells_the_stable_steps(void **state) {
  (void)state;
  char arguments[512];
  test_write("oscillator.lua", "local scene = hooke.scene {}\nscene:particle { position = {1, 0, 0}, mass = 2 }\n"
                               "scene:force('central', { strength = 100 })\nreturn scene\n");
  says("explain oscillator.lua", 0, "1 particles (0 pinned)");
  const char *leapfrog = strstr(r.out, "  leapfrog");
  double limit = leapfrog ? strtod(leapfrog + strlen("  leapfrog"), NULL) : NAN;
  assert_true(fabs(limit - 0.2) < 0.002); /* 2/w, w = 10; within 1 % */
  assert_non_null(strstr(r.out, "euler              none"));
  snprintf(arguments, sizeof arguments, "explain %s/scripts/scenes/cloth.lua N=8", HK_ROOT);
  says(arguments, 0, "64 particles (2 pinned)");
  says("explain", 1, "no scene given");
  says("explain oscillator.lua other.lua", 1, "neither the scene nor name=value");
  says("explain oscillator.lua --fast", 1, "unknown option '--fast'");
}

static void explain_leaves_an_integrator_that_is_to_be_chosen_open(void **state) {
  (void)state;
  test_write("open.lua", "local scene = hooke.scene { duration = 1, integrator = 'auto', accuracy = 1e-3 }\n"
                         "scene:particle { position = { 0, 0, 1 } }\n"
                         "scene:force('gravity')\nreturn scene\n");
  says("explain open.lua", 0, "with auto");
}

static void a_list_that_is_none_of_the_gallery_is_explained(void **state) {
  (void)state;
  static const char *const wrong[][2] = {
      {"return hooke.scene {}\n", "list.lua is no list of scenes: list.lua:1: hooke has no 'scene'"},
      {"return 3\n", "list.lua is no list of scenes: list.lua: it has to return a table"},
      {"return { width = 8, height = 8 }\n", "columns has to be a whole number above 0"},
      {"return { width = 8, height = 8, columns = 1 }\n", "it names no scene"},
      {"return { width = 8, height = 8, columns = 1, 'flag' }\n",
       "each of its scenes is a table that begins with a name"},
      {"return { width = 8, height = 8, columns = 1, { 'flag' } }\n", "'flag' has no moment: at = SECONDS"},
      {"return { width = 8, height = 8, columns = 1, { 'flag', at = 1 }, film = { 'flag', at = 1 } }\n",
       "film needs a width and fps"},
  };
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    test_write("list.lua", wrong[k][0]);
    test_hooke(&r, NULL, "gallery list.lua");
    if (r.code != 1 || !strstr(r.err, wrong[k][1])) fail_msg("exit %d, no '%s' in: %s", r.code, wrong[k][1], r.err);
  }
}

static void verify_prints_a_difference(void **state) {
  (void)state;
  char arguments[512];
  snprintf(arguments, sizeof arguments, "run %s/scripts/scenes/circle.lua --verify --json --quiet --no-output",
           HK_ROOT);
  test_hooke(&r, NULL, arguments);
  double error = test_json(r.out, "exact_error"), difference = test_json(r.out, "verify_difference");
  double n = round(1 / (60 * test_json(r.out, "dt_max"))), part = n / (2 * n + 1); /* steps of a frame become 2n + 1 */
  assert_true(fabs(difference / error - (1 - part * part)) < 0.02);                /* order 2 */
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(plugins_lists_every_kind_and_describes_one),
      cmocka_unit_test(failed_loads_are_listed_with_the_reason),
      cmocka_unit_test(explain_tells_the_stable_steps),
      cmocka_unit_test(explain_leaves_an_integrator_that_is_to_be_chosen_open),
      cmocka_unit_test(a_list_that_is_none_of_the_gallery_is_explained),
      cmocka_unit_test(verify_prints_a_difference),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
