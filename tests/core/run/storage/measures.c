/* measures.csv and the table of the output `table` after RFC 4180: names with commas, quotes and line breaks are in
 * quotes, with quotes doubled, and every row has as many fields as the first. A name that spreadsheets would compute
 * begins with an apostrophe; numbers below 0 do not. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const char scene[] = "local scene = hooke.scene { duration = 0.2, fps = 10 }\n"
                            "local p = scene:particle { position = {0, 0, 1}, mass = 1 }\n"
                            "for _, name in ipairs { 'plain', 'a,b', 'say \"x\"', 'two\\nlines', 'back\\rto', '\"',"
                            " '=1+1', '-a,b', '@x', '+1' } do\n"
                            "  scene:measure(name, function(s) return -s:position(p)[3] end)\nend\n"
                            "scene:output('table')\nreturn scene\n";

static const char names[] = "plain,\"a,b\",\"say \"\"x\"\"\",\"two\nlines\",\"back\rto\",\"\"\"\","
                            "'=1+1,\"'-a,b\",'@x,'+1\n";
enum { NAMES = 10 };

/* The number of fields of the record at *text, which is moved behind it; 0: it is no record of RFC 4180. */
static int fields(const char **text) {
  int count = 1;
  bool quoted = false;
  for (const char *c = *text; *c; c++) {
    if (*c == '"') quoted = !quoted; /* a doubled one closes and opens */
    if (*c == ',' && !quoted) count++;
    if (*c == '\n' && !quoted) {
      *text = c + 1;
      return count;
    }
  }
  return 0;
}

static void check(const char *file, int before) {
  static char text[1 << 14];
  char path[4096];
  snprintf(path, sizeof path, "%s/%s", test_folder(), file);
  FILE *f = fopen(path, "rb");
  assert_non_null(f);
  text[fread(text, 1, sizeof text - 1, f)] = 0;
  fclose(f);
  if (!strstr(text, names)) fail_msg("%s: %s", file, text);
  assert_non_null(strstr(text, ",-1,-1,-1,-1\n"));
  int rows = 0;
  for (const char *at = text; *at; rows++) assert_int_equal(fields(&at), before + NAMES);
  assert_int_equal(rows, 4); /* the names, and three frames */
}

static void any_name_stays_one_field(void **state) {
  (void)state;
  static test_result r;
  test_write("names.lua", scene);
  test_hooke(&r, NULL, "run names.lua --quiet --out o");
  if (r.code != 0) fail_msg("%d: %s", r.code, r.err);
  check("o/measures.csv", 1);
  check("o/table.csv", 8);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(any_name_stays_one_field)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
