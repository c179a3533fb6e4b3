/* core/app/lua/members.c and core/app/script/members.c: what a script asks of an object that it does not have is an
 * error that says where it is, or in which form. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

#define SCENE                                                                                                          \
  "local scene = hooke.scene { duration = 0.1, fps = 10 }\n"                                                           \
  "local cloth = scene:grid { nx = 3, ny = 3, width = 1, height = 1, mass = 1 }\n"
#define END "\nreturn scene\n"
#define MEASURE(what) "scene:measure('a', function(s) return " what " end)"

static void say(const char *const (*list)[2], size_t count) {
  for (size_t k = 0; k < count; k++) {
    char script[512];
    snprintf(script, sizeof script, SCENE "%s" END, list[k][0]);
    test_refused(script, "", 1, list[k][1]);
  }
}

static void a_name_that_is_elsewhere_is_said_to_be_there(void **state) {
  static const char *const list[][2] = {
      {"hooke.run(scene)", "hooke has no 'run'; a script returns its scene, and `hooke run FILE` runs it"},
      {"hooke.grid { nx = 2 }", "hooke has no 'grid'; a scene has: local scene = hooke.scene { ... }; scene:grid(...)"},
      {"hooke.force('gravity')", "scene:force(...)"},
      {"hooke.sweep {}", "hooke has no 'sweep'; it has "},
      {"scene:run {}:position(1)", "a run has no 'position'; its state has: run:state()"},
      {"print(scene:run {}.t)", "a run has no 't'; its state has: run:state()"},
      {"scene:bars { edges = {} }", "a scene has no 'bars'; 'bars' is a plugin: scene:constraint(\"bars\", { ... })"},
      {"scene:gravity()", "a scene has no 'gravity'; 'gravity' is a plugin: scene:force(\"gravity\", { ... })"},
      {"print(scene.duration)", "a scene has no 'duration'; hooke.scene { ... } sets values, none is read"},
  };
  (void)state;
  say(list, sizeof list / sizeof *list);
}

static void a_name_that_there_is_not_is_answered_with_the_nearest(void **state) {
  static const char *const list[][2] = {
      {"hooke.scnee {}", "hooke has no 'scnee'; did you mean 'scene'?"},
      {"scene:froce('gravity')", "a scene has no 'froce'; did you mean 'force'?"},
      {"scene:pin { cloth:att(1, 1) }", "a handle has no 'att'; did you mean 'at'?"},
      {"print(scene:run {}.sumary)", "a run has no 'sumary'; did you mean 'summary'?"},
      {MEASURE("s:pos(1)[1]"), "a state has no 'pos'; did you mean 'position'?"},
      {MEASURE("s.time"), "a state has no 'time'; did you mean 't'?"},
      {"print(cloth[1])", "a handle has no members by number; its particles are :at(i, j) and :ids()"},
      {"scene:particle { pinned = true }", "particle: unknown key 'pinned'; its keys are "},
      {"print(cloth.EI)", "a handle has no 'EI'; its particles are"},
  };
  (void)state;
  say(list, sizeof list / sizeof *list);
}

static void a_wrong_form_is_answered_with_the_right_one(void **state) {
  static const char *const list[][2] = {
      {"hooke:scene {}", "a scene is made with a dot: hooke.scene { ... }"},
      {"hooke.scene('a')", "scene: expected a table, hooke.scene { ... }, got a string"},
      {"scene.pin { 1 }", "a scene's functions are called with a colon"},
      {"scene:pin { cloth.at(1, 1) }", "functions of a handle are called with a colon: handle:at(1)"},
      {MEASURE("s.position(1)[1]"), "functions of a state are called with a colon: state:position(id)"},
      {MEASURE("s:position(cloth)[1]"), "expected the id of one particle"},
      {"scene:run {}.summary()", "functions of a run are called with a colon"},
      {"scene:force { 'gravity' }", "force: expected a name and then parameters, scene:force(\"name\", { ... })"},
      {"scene:grid(3)", "grid: expected a table, scene:grid { ... }, got a number"},
      {"scene:channel('heat', 3)", "channel: expected a table, scene:channel(name, { initial = 0 }), got a number"},
      {"scene:force('springs', { edges = cloth.edges, k = 1 })", "a handle's functions are called: cloth:edges()"},
      {"scene:force('springs', { edges = cloth, k = 1 })", "got a handle; its functions give lists"},
  };
  (void)state;
  say(list, sizeof list / sizeof *list);
}

static void the_length_of_a_handle_is_its_number_of_particles(void **state) {
  static test_result r;
  (void)state;
  test_write("length.lua", SCENE "assert(#cloth == 9)" END);
  test_hooke(&r, NULL, "run length.lua --quiet");
  assert_int_equal(r.code, 0);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_name_that_is_elsewhere_is_said_to_be_there),
      cmocka_unit_test(a_name_that_there_is_not_is_answered_with_the_nearest),
      cmocka_unit_test(a_wrong_form_is_answered_with_the_right_one),
      cmocka_unit_test(the_length_of_a_handle_is_its_number_of_particles),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
