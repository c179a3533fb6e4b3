/* What a scene says and a run does not use is a warning with the line of the script; what is used is none. */
#include "tests/support/command.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define SCENE "local scene = hooke.scene { duration = 0.1, fps = 10 }\n"
#define BALL SCENE "local p = scene:particle { position = {0, 0, 1}, mass = 1 }\n"
#define GRID SCENE "local g = scene:grid { nx = 3, ny = 3 }\n"
#define CHAIN SCENE "local s = scene:strand { n = 4, length = 3, mass = 1 }\n"
#define LOOSE "nothing holds together "

static test_result r;

static void run(const char *lines) {
  char scene[1024];
  snprintf(scene, sizeof scene, "%sreturn scene\n", lines);
  test_write("scene.lua", scene);
  test_hooke(&r, NULL, "run scene.lua --quiet --no-output");
  if (r.code != 0) fail_msg("exit %d: %s\n%s", r.code, r.err, scene);
}

typedef struct warned {
  const char *scene, *text;
} warned;

static void expect_warnings(const warned *list, size_t count) {
  for (size_t k = 0; k < count; k++) {
    run(list[k].scene);
    if (!strstr(r.err, "warning: ") || !strstr(r.err, list[k].text))
      fail_msg("expected '%s' in: %s\n%s", list[k].text, r.err, list[k].scene);
  }
}

static void parts_without_effect_are_named(void **state) {
  (void)state;
  static const warned list[] = {
      {BALL "scene:force('springs', { edges = {}, k = 1 })\n",
       "scene.lua:3: springs has no effect: its list 'edges' is empty; name some, or leave it out"},
      {BALL "scene:constraint('bars', { edges = {} })\n", "scene.lua:3: bars has no effect: its list 'edges' is empty"},
      {BALL "scene:force('ropes', { edges = {}, k = 1 })\n",
       "scene.lua:3: ropes has no effect: its list 'edges' is empty"},
      {BALL "scene:force('drag', { d = 1, only = {} })\n",
       "scene.lua:3: drag has no effect: no particle is among those of its `only` and `group`"},
      {BALL "scene:force('gravity', { from = 1 })\n",
       "scene.lua:3: gravity has no effect: it acts from 1 s on, and the scene ends at 0.1 s; let it begin before"},
      {BALL "scene:force('gravity', { to = 0 })\n", "scene.lua:3: gravity has no effect: it acts up to 0 s"},
      {BALL "scene:pin {}\n", "scene.lua:3: pin has no effect: its list of particles is empty"},
      {BALL "scene:service('neighbours')\n", "scene.lua:3: neighbours: no plugin of the scene asks for this service"},
  };
  expect_warnings(list, sizeof list / sizeof *list);
}

static void a_pair_that_is_joined_twice_is_named(void **state) {
  (void)state;
  static const warned list[] = {
      {CHAIN "scene:constraint('bars', { edges = { {1, 2}, {2, 3}, {3, 4}, {2, 1} } })\n",
       "scene.lua:3: bars: edges[4] joins particles 1 and 2, as edges[1] of bars does, and has no effect of its own"},
      {CHAIN "scene:constraint('bars', { edges = s:edges() })\nscene:constraint('bars', { edges = { {3, 2} } })\n",
       "scene.lua:4: bars#2: edges[1] joins particles 2 and 3, as edges[2] of bars does"},
  };
  expect_warnings(list, sizeof list / sizeof *list);
}

/* In one list, in any direction; two forces on one pair are meant. */
static void a_pair_that_a_force_has_twice_is_named(void **state) {
  (void)state;
  static const warned list[] = {
      {CHAIN "scene:force('springs', { edges = { {1, 2}, {2, 3}, {3, 4}, {3, 2} }, k = 1 })\n",
       "scene.lua:3: springs: edges[4] joins particles 3 and 2, as edges[2] does, and both act: leave one of them out"},
      {CHAIN "scene:force('cubic_springs', { edges = { {1, 2}, {3, 4}, {1, 2} }, k = 1 })\n",
       "scene.lua:3: cubic_springs: edges[3] joins particles 1 and 2, as edges[1] does"},
  };
  expect_warnings(list, sizeof list / sizeof *list);
  run(CHAIN "scene:force('springs', { edges = s:edges(), k = 1 })\n"
            "scene:force('springs', { edges = s:edges(), k = 2 })\n");
  if (strstr(r.err, "both act")) fail_msg("two forces: %s", r.err);
}

static void particles_that_nothing_holds_together_are_named(void **state) {
  (void)state;
  static const warned list[] = {
      {GRID "scene:force('gravity')\n",
       "scene.lua:2: " LOOSE "9 particles of a mesh, grid or strand, such as particle 1, so"},
      {SCENE "scene:block { nx = 3, ny = 3, nz = 3, density = 1 }\nscene:force('gravity')\n",
       "scene.lua:2: " LOOSE "26 "},
      {CHAIN "local g = scene:grid { nx = 2, ny = 2, origin = { 9, 0, 0 } }\nscene:force('gravity')\n"
             "scene:force('springs', { edges = s:edges(), k = 1 })\n",
       "scene.lua:3: " LOOSE "4 particles of a mesh, grid or strand, such as particle 5, so"},
      {GRID "scene:force('gravity')\nscene:corrector('contact', { thickness = 1e-3 })\n", "scene.lua:2: " LOOSE "9 "},
      {GRID "scene:force('gravity')\nscene:force('barrier', { d_hat = 1e-3 })\n", "scene.lua:2: " LOOSE "9 "},
  };
  expect_warnings(list, sizeof list / sizeof *list);
}

static void what_something_else_replaces_is_named(void **state) {
  (void)state;
  static const warned list[] = {
      {GRID "scene:pin(g)\nscene:force('hinges', { material = 'cotton', rigidity = 1 })\n",
       "scene.lua:4: hinges: material 'cotton' has no effect, since all of its numbers are given beside it: leave one"},
      {SCENE "scene:pin(scene:grid { nx = 3, ny = 3, material = 'cotton', density = 1 })\n",
       "scene.lua:2: grid: material 'cotton' has no effect"},
      {SCENE "scene:source('emitter', { rate = 7, rate_of_time = function(t) return 1 end })\n",
       "scene.lua:2: emitter: rate, 7/s, has no effect: the function rate_of_time takes its place; leave one of them"},
  };
  expect_warnings(list, sizeof list / sizeof *list);
}

static void what_is_guessed_is_said(void **state) {
  (void)state;
  static const warned list[] = {
      {SCENE "scene:hair { on = {}, strands = 3, n = 4 }\n", "scene.lua:2: hair: on: {} names no surface, so"},
      {SCENE "scene:source('emitter', {})\n",
       "scene.lua:2: emitter: no rate is given, so that 100 particles a second are born: give rate"},
      {SCENE "local s = scene:strand { n = 3, radius = 1e-3, E = 1e3 }\n"
             "scene:force('springs', { edges = s:edges(), k = 1 })\n",
       "scene.lua:2: strand: the section has a radius and no density, so that the mass is 1 kg"},
      {SCENE "scene:channel('vx')\nscene:particle {}\n", "scene.lua:2: channel 'vx': tables of states have a column"},
      {SCENE "scene:rigid { shape = 'sphere', radius = 1, mass = 1 }\nscene:corrector('strain_limit', { edges = {{1, "
             "2}}, limit = 9 })\n",
       "scene.lua:3: strain_limit does not know rigid bodies: it moves their particles one by one"},
      {SCENE "scene:rigid { shape = 'box', size = 1, mass = 1 }\nscene:corrector('contact', {})\n",
       "scene.lua:3: contact meets 1 rigid bodies nowhere, such as that of particle 1: they have no surface"},
      {SCENE "scene:rigid { shape = 'box', size = 1, mass = 1 }:surface()\nscene:force('barrier', {})\n",
       "scene.lua:3: barrier does not know rigid bodies: where their surfaces meet something, the run ends"},
      {GRID "scene:pin(g)\nscene:force('rods', { edges = g:edges(), EI = 1 })\n",
       "scene.lua:4: rods: edges: 6 of them have no effect, such as number 7, from particle 1 to 4: nothing"},
  };
  expect_warnings(list, sizeof list / sizeof *list);
}

static void what_acts_is_no_warning(void **state) {
  (void)state;
  static const char *const scenes[] = {
      BALL "scene:force('gravity', { from = 0.05, to = 0.07 })\n",
      GRID "scene:pin(g)\nscene:force('gravity')\n",
      GRID "scene:force('gravity')\nscene:force('membrane', { stiffness = 1 })\n",
      GRID "scene:force('gravity')\nscene:force('ropes', { edges = g:edges(), k = 1 })\n",
      GRID "scene:force('lennard_jones', { epsilon = 1e-9, sigma = 0.1 })\n",
      GRID "",
      CHAIN "scene:force('gravity')\nscene:constraint('bars', { edges = s:edges() })\n",
      CHAIN "scene:constraint('bars', { edges = s:edges() })\nscene:constraint('cables', { edges = s:edges() })\n",
      SCENE "scene:source('emitter', { rate = 0, burst = 3, burst_at = { 0.05 } })\n"
            "scene:force('drag', { d = 1, only = {} })\n",
      SCENE "local s = scene:strand { n = 3, radius = 1e-3, mass = 1 }\n"
            "scene:force('springs', { edges = s:edges(), k = 1 })\n",
      GRID "scene:pin(g)\nscene:force('hinges', { material = 'cotton', damping = 1e-9 })\n",
      SCENE "scene:source('emitter', { rate_of_time = function(t) return 1 end })\n",
      CHAIN "scene:force('rods', { edges = s:edges(), EI = 1e-3 })\n",
      SCENE "local b = scene:rigid { shape = 'sphere', radius = 1, mass = 1 }\nlocal p = b:point { 0, 0, 1 }\n"
            "scene:joint { kind = 'ball', a = b, at = { 0, 0, -1 } }\nscene:force('gravity')\n",
  };
  for (size_t k = 0; k < sizeof scenes / sizeof *scenes; k++) {
    run(scenes[k]);
    if (strstr(r.err, "warning")) fail_msg("%s\n%s", r.err, scenes[k]);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(parts_without_effect_are_named),
      cmocka_unit_test(a_pair_that_is_joined_twice_is_named),
      cmocka_unit_test(a_pair_that_a_force_has_twice_is_named),
      cmocka_unit_test(particles_that_nothing_holds_together_are_named),
      cmocka_unit_test(what_something_else_replaces_is_named),
      cmocka_unit_test(what_is_guessed_is_said),
      cmocka_unit_test(what_acts_is_no_warning),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
