/* State tables: channels are columns and come back; what a table does not hold is said; one with rows missing is
 * refused where nobody can have died. */
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define FIXTURE(name) "'" HK_BUILD "/tests/fixtures/" name ".so'"
#define HEAD "id,x,y,z,vx,vy,vz,mass"

static test_result r;

/* A scene of two particles with a channel of one number and one of two, which starts from `file` unless that is "". */
static void write_scene(const char *name, const char *file, const char *more) {
  char scene[2048], start[256] = "";
  if (*file) snprintf(start, sizeof start, "scene:start { file = '%s' }\n", file);
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 0.4, fps = 10, dt = 0.01 }\n"
           "local a = scene:particle { mass = 1 }\nlocal b = scene:particle { position = {1, 0, 0}, mass = 2 }\n"
           "scene:channel('heat', { size = 1, initial = 3, rate = -1 })\n"
           "scene:channel('dye', { size = 2, initial = {1, 2}, rate = 0.5 })\n"
           "scene:measure('heat', function(s) return s:channel('heat', b) end)\n"
           "scene:measure('dye', function(s) return s:channel('dye', a)[2] end)\n%s%sreturn scene\n",
           start, more);
  test_write(name, scene);
}

static void run(const char *arguments, int code) {
  test_hooke(&r, NULL, arguments);
  if (r.code != code) fail_msg("%s: exit %d instead of %d: %s", arguments, r.code, code, r.err);
}

/* Written with 17 digits, so that the numbers come back bit by bit. */
static void channels_are_written_and_read_back(void **state) {
  (void)state;
  double heat, dye;
  write_scene("first.lua", "", "");
  run("run first.lua --json --quiet --out a --state state.csv", 0);
  heat = test_json(r.out, "heat");
  dye = test_json(r.out, "dye");
  assert_true(heat < 2.5 && dye > 2.2); /* 3 exp(-0.4), 2 exp(0.2) */
  char path[512], line[256];
  snprintf(path, sizeof path, "%s/state.csv", test_folder());
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  assert_non_null(fgets(line, sizeof line, file));
  fclose(file);
  assert_string_equal(line, HEAD ",heat,dye[1],dye[2]\n");
  write_scene("second.lua", "state.csv", "");
  run("run second.lua --json --quiet --out b --until 0", 0);
  assert_true(test_json(r.out, "heat") == heat);
  assert_true(test_json(r.out, "dye") == dye);
}

static void a_table_without_channels_is_said_to_have_none(void **state) {
  (void)state;
  test_write("old.csv", HEAD "\n1,0,0,0,0,0,0,1\n2,1,0,0,0,0,0,2\n");
  write_scene("old.lua", "old.csv", "");
  run("run old.lua --json --quiet --out c --until 0", 0);
  assert_true(test_json(r.out, "heat") == 3);
  assert_non_null(strstr(r.err, "old.csv has no channels: they begin with the values that the scene gives them"));
}

static void a_table_with_other_channels_is_refused(void **state) {
  (void)state;
  test_write("other.csv", HEAD ",heat\n1,0,0,0,0,0,0,1,5\n2,1,0,0,0,0,0,2,5\n");
  write_scene("other.lua", "other.csv", "");
  run("run other.lua --quiet --out d", 1);
  assert_non_null(strstr(r.err, "other.csv: its columns are not " HEAD ",heat,dye[1],dye[2]"));
  test_write("named.csv", HEAD ",warmth,dye[1],dye[2]\n1,0,0,0,0,0,0,1,5,1,2\n2,1,0,0,0,0,0,2,5,1,2\n");
  write_scene("named.lua", "named.csv", "");
  run("run named.lua --quiet --out d", 1);
  assert_non_null(strstr(r.err, "named.csv: its columns are not " HEAD ",heat,dye[1],dye[2]"));
}

/* A table has no time: a scene that depends on it begins at 0, and that is said, whatever it is that depends. */
static void a_scene_of_time_is_said_to_begin_at_zero(void **state) {
  (void)state;
  static const char *const more[] = {
      "scene:force('gravity', { g = function(t) return 0, 0, -t end })\n",
      "scene:force('gravity', { from = 0.1 })\n",
      "scene:pin({ a }, { path = function(t) return t, 0, 0 end })\n",
      "scene:pin({ a }, { release = 0.1 })\n",
      "scene:corrector(" FIXTURE("floor") ", { height = function(t) return t - 10 end })\n",
      "scene:exact(function(t) return 0, 0, 0 end)\n",
      "scene:channel('age', { rate = function(t, id, y) return t end })\n",
  };
  test_write("moment.csv", HEAD "\n1,0,0,0,0,0,0,1\n2,1,0,0,0,0,0,2\n");
  for (size_t k = 0; k < sizeof more / sizeof *more; k++) {
    write_scene("moment.lua", "moment.csv", more[k]);
    run("run moment.lua --quiet --trust --out e --until 0", 0);
    if (!strstr(r.err, "moment.csv has no time: the scene, which depends on it, begins at t = 0 s"))
      fail_msg("%s: %s", more[k], r.err);
  }
  write_scene("moment.lua", "moment.csv", "");
  run("run moment.lua --quiet --out e --until 0", 0);
  assert_null(strstr(r.err, "has no time"));
}

static void missing_rows_are_refused_unless_particles_may_die(void **state) {
  (void)state;
  test_write("short.csv", HEAD "\n2,1,0,0,0,0,0,2\n");
  write_scene("short.lua", "short.csv", "");
  run("run short.lua --quiet --out f", 1);
  assert_non_null(strstr(r.err, "short.csv: particle 1 of the scene is not in it; a state names every particle"));
  test_write("none.csv", HEAD "\n");
  write_scene("none.lua", "none.csv", "");
  run("run none.lua --quiet --out f", 1);
  test_write("sourced.lua", "local scene = hooke.scene { duration = 0.1, fps = 10, dt = 0.001 }\n"
                            "scene:particle { mass = 1 }\nscene:particle { position = {1, 0, 0}, mass = 2 }\n"
                            "scene:source(" FIXTURE("sower") ", { every = 5 })\n"
                                                             "scene:measure('n', function(s) return s.n end)\n"
                                                             "scene:start { file = 'short.csv' }\nreturn scene\n");
  run("run sourced.lua --trust --quiet --json --out g", 0);
  assert_true(test_json(r.out, "n") == 1);
}

/* 16 channels of 16 numbers, with names that make a head of more than 4096 characters. */
static void wide_tables_come_back(void **state) {
  (void)state;
  static const char wide[] = "local scene = hooke.scene { duration = 0.1, fps = 10, dt = 0.001 }\n"
                             "scene:particle { mass = 1 }\n"
                             "local list = {} for c = 1, 16 do list[c] = c / 3 end\n"
                             "for k = 1, 16 do scene:channel('a_quantity_with_a_long_name_' .. k, { size = 16, initial "
                             "= list, rate = -k }) end\n"
                             "local file = param('file', '') if file ~= '' then scene:start { file = file } end\n"
                             "return scene\n";
  test_write("wide.lua", wide);
  run("run wide.lua --quiet --state wide.csv", 0);
  test_hooke(&r, NULL, "run wide.lua file=wide.csv --until 0 --quiet --state again.csv");
  if (r.code != 0) fail_msg("%s", r.err);
  test_hooke(&r, "cmp wide.csv again.csv &&", "--version");
  if (r.code != 0) fail_msg("the table changed: %s", r.out);
}

/* Spreadsheets would compute them. */
static void names_of_formulas_begin_with_an_apostrophe_and_come_back(void **state) {
  (void)state;
  char path[512], line[256];
  static const char channel[] = "scene:channel('=1+1', { initial = 1, rate = -1 })\n"
                                "scene:measure('sum', function(s) return s:channel('=1+1', 1) end)\n";
  write_scene("formula.lua", "", channel);
  run("run formula.lua --json --quiet --out f --state formula.csv", 0);
  double sum = test_json(r.out, "sum");
  snprintf(path, sizeof path, "%s/formula.csv", test_folder());
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  assert_non_null(fgets(line, sizeof line, file));
  fclose(file);
  assert_string_equal(line, HEAD ",heat,dye[1],dye[2],'=1+1\n");
  write_scene("formula.lua", "formula.csv", channel);
  run("run formula.lua --json --quiet --out f --until 0", 0);
  assert_true(test_json(r.out, "sum") == sum && sum < 1);
}

static void names_that_would_break_a_head_are_refused(void **state) {
  (void)state;
  static const char *const names[] = {"a,b", "a\\nb", "a\\\"b", ""};
  for (size_t k = 0; k < sizeof names / sizeof *names; k++) {
    char line[128];
    snprintf(line, sizeof line, "scene:channel(\"%s\", { initial = 1 })\n", names[k]);
    write_scene("broken.lua", "", line);
    run("run broken.lua --quiet --no-output", 1);
    assert_non_null(strstr(r.err, "the heads of tables"));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(channels_are_written_and_read_back),
      cmocka_unit_test(wide_tables_come_back),
      cmocka_unit_test(names_that_would_break_a_head_are_refused),
      cmocka_unit_test(names_of_formulas_begin_with_an_apostrophe_and_come_back),
      cmocka_unit_test(a_table_without_channels_is_said_to_have_none),
      cmocka_unit_test(a_table_with_other_channels_is_refused),
      cmocka_unit_test(a_scene_of_time_is_said_to_begin_at_zero),
      cmocka_unit_test(missing_rows_are_refused_unless_particles_may_die),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
