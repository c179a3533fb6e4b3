/* The figures of a run stand in one table: what JSON, Lua and the text report say comes from it alone. */
#include "core/run/judge/judge.h"
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const char scene[] = "local function make()\n"
                            "  local scene = hooke.scene { duration = 0.1, integrator = 'leapfrog', dt = 1e-3 }\n"
                            "  scene:particle { position = {1, 0, 0}, velocity = {0, 1, 0}, mass = 1 }\n"
                            "  scene:force('central', { strength = 1, power = 1 })\n"
                            "  scene:measure('height', function(s) return s:position(1)[2] end)\n"
                            "  return scene\n"
                            "end\n";

/* A driving script that prints, on standard error as scripts do, what Lua has of every figure: key, or group.key, and
 * its value. */
static const char drives[] = "local function show(prefix, t)\n"
                             "  for k, v in pairs(t) do\n"
                             "    if type(v) == 'number' then print(('%s%s=%.17g'):format(prefix, k, v))\n"
                             "    elseif type(v) == 'string' then print(('%s%s=\"%s\"'):format(prefix, k, v))\n"
                             "    elseif #t == 0 then show(k .. '.', v) end\n"
                             "  end\n"
                             "end\n"
                             "show('', make():run{}:summary())\n";

/* The text after "key": in the JSON object, up to the comma or bracket; "" when it is not there. */
static void json_value(const char *json, const hk_figure *f, char *value, size_t size) {
  char key[80];
  const char *at = json;
  if (f->group) {
    snprintf(key, sizeof key, "\"%s\":{", f->group);
    at = strstr(json, key);
  }
  snprintf(key, sizeof key, "\"%s\":", f->key);
  at = at ? strstr(at, key) : NULL;
  *value = 0;
  if (!at) return;
  at += strlen(key);
  size_t length = *at == '"' ? strcspn(at + 1, "\"") + 2 : strcspn(at, ",}");
  snprintf(value, size, "%.*s", (int)length, at);
}

/* Wall times differ from run to run, and a script that drives its runs has them compared with no other. */
static bool differs(const hk_figure *f) {
  return strstr(f->key, "wall") || strstr(f->key, "per_s") || strcmp(f->key, "error_estimate") == 0 ||
         strcmp(f->key, "checked") == 0;
}

static void json_and_lua_have_every_figure_of_the_table_and_agree(void **state) {
  (void)state;
  static test_result json, lua;
  char text[4096], value[256], line[400];
  snprintf(text, sizeof text, "%sreturn make()\n", scene);
  test_write("figures.lua", text);
  snprintf(text, sizeof text, "%s%s", scene, drives);
  test_write("drives.lua", text);
  test_hooke(&json, NULL, "run figures.lua --json --no-output --quiet");
  test_hooke(&lua, NULL, "run drives.lua --no-output --quiet");
  assert_int_equal(json.code, 0);
  assert_int_equal(lua.code, 0);
  size_t found = 0;
  for (const hk_figure *f = hk_figure_table; f->key; f++) {
    json_value(json.out, f, value, sizeof value);
    if (!*value) fail_msg("JSON has no '%s'", f->key);
    if (strcmp(f->key, "scene") == 0 || differs(f)) continue; /* the script's own name; times */
    const char *dot = f->group ? "." : "", *group = f->group ? f->group : "";
    bool known = strcmp(value, "null") != 0 && strcmp(value, "\"\"") != 0;
    snprintf(line, sizeof line, "%s%s%s=%s\n", group, dot, f->key, value);
    if (known && !strstr(lua.err, line)) fail_msg("Lua differs from JSON: %sLua has:\n%s", line, lua.err);
    found += known;
  }
  assert_true(found > 20);
}

/* Every line of the text report is one of the table's, a measure's or a time of a plugin. */
static void the_text_has_a_line_for_every_label_that_is_known(void **state) {
  (void)state;
  static test_result json, text;
  char value[256], label[64];
  test_hooke(&json, NULL, "run figures.lua --json --no-output --quiet");
  test_hooke(&text, NULL, "run figures.lua --no-output");
  for (const hk_figure *f = hk_figure_table; f->key; f++) {
    if (!f->label || !*f->label) continue;
    json_value(json.out, f, value, sizeof value);
    bool known =
        strcmp(value, "null") != 0 && strcmp(value, "\"\"") != 0 && strcmp(f->key, "constraint_violation") != 0;
    snprintf(label, sizeof label, "\n  %-17s ", f->label);
    if (known && !strstr(text.out, label)) fail_msg("the report has no line '%s'", f->label);
    if (!known && strstr(text.out, label)) fail_msg("the report has a line '%s' with nothing in it", f->label);
  }
  assert_non_null(strstr(text.out, "\n  height            "));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(json_and_lua_have_every_figure_of_the_table_and_agree),
      cmocka_unit_test(the_text_has_a_line_for_every_label_that_is_known),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
