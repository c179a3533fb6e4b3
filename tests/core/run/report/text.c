/* The summary as text: whatever a scene's names hold, a line is what hooke says, and the verdict its own. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

static const char scene[] =
    "local scene = hooke.scene { duration = 0.1, fps = 10, integrator = 'leapfrog', dt = 0.01, accuracy = 1e-12 }\n"
    "scene:particle { position = {1, 0, 0}, velocity = {0, 1, 0}, mass = 1 }\n"
    "scene:force('central', { strength = 1, label = 'a\\n  verdict           ok: b\\27[2J' })\n"
    "scene:measure('x\\n  verdict           ok: stable', function() return 1 end)\n"
    "return scene\n";

static size_t count(const char *text, const char *part) {
  size_t found = 0;
  for (; (text = strstr(text, part)); text += strlen(part)) found++;
  return found;
}

static void names_make_no_lines(void **state) {
  (void)state;
  static test_result r;
  test_write("forged.lua", scene);
  test_hooke(&r, NULL, "run forged.lua");
  assert_int_equal(r.code, 5);
  if (count(r.out, "\n  verdict ") != 1 || !strstr(r.out, "\n  verdict           inaccurate"))
    fail_msg("the verdict is forged: %s", r.out);
  assert_non_null(strstr(r.out, "\n  x\\x0a  verdict "));
  assert_null(strchr(r.out, '\033'));
}

/* Where the others go block by block: 5,000 particles are several blocks. */
static void a_force_without_parts_says_what_it_costs(void **state) {
  static const char text[] =
      "local scene = hooke.scene { duration = 0.1, fps = 10, integrator = 'leapfrog', dt = 0.05 }\n"
      "local chain = scene:strand { n = 5000, from = {0, 0, 0}, to = {1, 0, 0}, mass = 1 }\n"
      "scene:force('gravity')\n"
      "scene:force('pull', { k = 1e-6 })\n"
      "return scene\n";
  (void)state;
  static test_result r;
  test_write("apart.lua", text);
  test_hooke(&r, NULL, "run apart.lua --no-check");
  assert_int_equal(count(r.out, "without parts: a sweep over the particles of its own"), 1);
  test_hooke(&r, NULL, "explain apart.lua");
  assert_int_equal(count(r.out, "without parts (add_part)"), 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(names_make_no_lines),
                                     cmocka_unit_test(a_force_without_parts_says_what_it_costs)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
