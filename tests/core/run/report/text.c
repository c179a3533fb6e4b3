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

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(names_make_no_lines)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
