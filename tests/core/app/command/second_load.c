/* A run is compared with others of its scene, for which the script runs again: a script that then describes another
 * scene is named, and nothing of the one is read as if it was of the other. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* A file of its own for each scene has as many letters as the script has run times. */
static const char start[] = "local name = 'count%d'\n"
                            "local file = io.open(name, 'a') file:write('x') file:close()\n"
                            "local again = #io.open(name):read('a') > 1\n"
                            "local s = hooke.scene { duration = 0.2, fps = 50, integrator = 'rk4', dt = 1e-3 }\n"
                            "s:strand { n = 3, from = { 0, 0, 0 }, to = { 2, 0, 1 } }\n"
                            "s:force('gravity', {})\n";

static void try(const char *difference, const char *said) {
  static test_result r;
  static int tried;
  char first[1024], scene[2048];
  snprintf(first, sizeof first, start, ++tried);
  snprintf(scene, sizeof scene, "%s%s\nreturn s\n", first, difference);
  test_write("scene.lua", scene);
  test_hooke(&r, NULL, "run scene.lua --trust --quiet --no-output --accuracy 1e-3");
  if (r.code > 5 || !strstr(r.err, "describes another scene when it is run again") || !strstr(r.err, said))
    fail_msg("%s: code %d: %s", difference, r.code, r.err);
}

static void a_scene_that_differs_is_named(void **state) {
  (void)state;
  try("if again then s:channel('wide', { initial = { 1, 2, 3 } }) end", "it has other channels");
  try("if not again then s:channel('wide', { initial = { 1, 2, 3 } }) end", "it has other channels");
  try("s:channel('y', { initial = again and { 1, 2 } or 1 })", "it has other channels");
  try("if again then s:strand { n = 2, from = { 0, 0, 0 }, to = { 2, 0, 1 } } end", "it has other particles");
  try("if not again then s:force('drag', { rate = 1 }) end", "it has other forces");
}

/* `print` says nothing the second time, and calls what makes texts as the first time. */
static void printing_leaves_scenes_alike(void **state) {
  static test_result r;
  (void)state;
  for (int trusted = 0; trusted < 2; trusted++) {
    test_write("scene.lua", "local s = hooke.scene { duration = 0.2, fps = 50, integrator = 'rk4', dt = 1e-3 }\n"
                            "s:strand { n = 3, from = { 0, 0, 0 }, to = { 2, 0, 1 } }\n"
                            "s:force('gravity', {})\n"
                            "print(setmetatable({}, { __tostring = function()\n"
                            "  s:channel('wide', { initial = { 1, 2, 3 } }) return 'told once' end }))\n"
                            "return s\n");
    test_hooke(&r, NULL,
               trusted ? "run scene.lua --trust --quiet --no-output --accuracy 1e-3"
                       : "run scene.lua --quiet --no-output --accuracy 1e-3");
    const char *told = strstr(r.out, "told once") ? r.out : r.err, *first = strstr(told, "told once");
    if (r.code != 0 || !first || strstr(first + 1, "told once") || strstr(r.err, "another scene"))
      fail_msg("code %d: %s%s", r.code, r.out, r.err);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_scene_that_differs_is_named),
                                     cmocka_unit_test(printing_leaves_scenes_alike)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
