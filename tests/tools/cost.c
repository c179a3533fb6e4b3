/* hooke explain --cost: what a part of a scene is worth against closed forms, the steps that the rest takes, and that
 * it says so when a scene is chaotic, cannot do without a part or has other particles without it. */
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

static void explain(const char *before, const char *arguments) {
  char all[512];
  snprintf(all, sizeof all, "explain %s --cost --repeats 1", arguments);
  test_hooke(&r, before, all);
  if (r.code != 0) fail_msg("%s: exit %d: %s", all, r.code, r.err);
}

/* Copies the object that starts at `from` into `into`. No text in it has a brace. */
static size_t copy_object(const char *from, char *into) {
  size_t length = 0;
  int depth = 0;
  do depth += (from[length] == '{') - (from[length] == '}');
  while (from[length++] && depth > 0);
  memcpy(into, from, length);
  into[length] = 0;
  return length;
}

/* The entry of `label` in the list of parts, valid until the next call. */
static const char *part(const char *label) {
  static char one[sizeof r.out];
  char wanted[64];
  snprintf(wanted, sizeof wanted, "\"label\":\"%s\"", label);
  const char *at = strstr(r.out, "\"parts\":[");
  for (at = at ? strchr(at, '{') : NULL; at && *at == '{'; at += *at == ',') {
    at += copy_object(at, one);
    if (strstr(one, wanted)) return one;
  }
  fail_msg("no part '%s' in: %s", label, r.out);
  return NULL;
}

/* The number behind `key` in the part's object `inside`. */
static double figure(const char *label, const char *inside, const char *key) {
  static char object[sizeof r.out];
  char name[64];
  snprintf(name, sizeof name, "\"%s\":{", inside);
  const char *at = strstr(part(label), name);
  if (!at) fail_msg("'%s': no '%s' in: %s", label, inside, r.out);
  copy_object(strchr(at, '{'), object);
  return test_json(object, key);
}

static void says(const char *label, const char *text) {
  const char *one = part(label);
  if (!strstr(one, text)) fail_msg("'%s': no '%s' in: %s", label, text, one);
}

/* Thrown up against drag of rate r for a second: z = (v + g/r)(1 - e^-r)/r - g/r, and v - g/2 without drag. rk4 is
 * off by (h r)^4/120 of 20 m, 1e-10, and ten times that is allowed. */
static void a_part_is_worth_what_the_closed_forms_differ_by(void **state) {
  (void)state;
  test_write("throw.lua", "local scene = hooke.scene { duration = 1, fps = 100, integrator = 'rk4', accuracy = 1e-3 }\n"
                          "local p = scene:particle { position = {0, 0, 0}, velocity = {0, 0, 20}, mass = 2 }\n"
                          "scene:force('gravity', { g = {0, 0, -9.81} })\n"
                          "scene:force('drag', { rate = param('rate', 0.5, 'of the drag, 1/s') })\n"
                          "scene:force('central', { strength = 0, label = 'idle' })\n"
                          "scene:measure('height', function(s) return s:position(p)[3] end)\nreturn scene\n");
  explain(NULL, "throw.lua --json");
  double rate = 0.5, g = 9.81, with = (20 + g / rate) * (1 - exp(-rate)) / rate - g / rate, without = 20 - g / 2;
  assert_true(fabs(test_json(part("drag"), "x") - (without - with)) < 1e-9);
  assert_true(fabs(figure("drag", "height", "change") - (without - with)) < 1e-9);
  assert_true(fabs(figure("drag", "height", "relative") - (without - with) / with) < 1e-9);
  assert_true(fabs(test_json(part("gravity"), "x") - 20 * (1 - exp(-rate)) / rate + with) < 1e-9);
  assert_true(test_json(part("idle"), "x") == 0);
  says("drag", "above the accuracy asked (0.001 m)");
  says("idle", "ends where it did: within the accuracy asked");
  explain(NULL, "throw.lua rate=1e-5 --until 0.5 --json"); /* the drag's work: r v t^2/2 = 2e-5 m */
  says("drag", "within the accuracy asked (0.001 m)");
  assert_true(figure("drag", "same", "steps") == 50);
}

/* Two oscillators of the same mass, k 100 times stiffer in one: without it leapfrog's step grows tenfold (and is cut to
 * whole parts of a frame), and evaluations fall; at the same step they are those of the whole. */
static void the_rest_is_timed_at_the_same_step_and_at_its_own(void **state) {
  (void)state;
  test_write("two.lua", "local scene = hooke.scene { duration = 2, fps = 10 }\n"
                        "for k, at in ipairs { 0, 5 } do\n"
                        "  local a = scene:particle { position = {at, 0, 0}, mass = 1 }\n"
                        "  local b = scene:particle { position = {at + 1, 0, 0}, mass = 1 }\n"
                        "  scene:force('springs', { edges = {{a, b}}, k = 1e4 * 100 ^ (2 - k), rest = 0.9,\n"
                        "    label = k == 1 and 'stiff' or 'soft' })\nend\nreturn scene\n");
  explain(NULL, "two.lua --json");
  double whole = figure("soft", "same", "steps");
  assert_true(figure("stiff", "same", "steps") == whole);
  double ratio = whole / figure("stiff", "own", "steps");
  assert_true(ratio > 8.5 && ratio < 10.5); /* 10 up to the cut of steps to 1/7th of a frame */
  assert_true(figure("soft", "own", "steps") == whole);
  assert_true(figure("stiff", "own", "force_evaluations") < whole / 8);
  assert_true(isfinite(figure("stiff", "own", "saved")) && isfinite(figure("stiff", "same", "saved")));
  explain(NULL, "two.lua --integrator rk4 --json");
  assert_true(figure("stiff", "same", "force_evaluations") >= 4 * figure("stiff", "same", "steps"));
}

/* An elastic double pendulum that turns over: after 25 s a disturbance of 1e-10 has filled the reach of 2 m, and so has
 * that of a drag of 1e-9 1/s. After 1 s it has not, and the drag's own effect, r v t^2/2 of some 1e-9 m, is told. */
static void chaos_is_not_taken_for_worth(void **state) {
  (void)state;
  test_write("pendulum.lua", "local scene = hooke.scene { duration = 25, fps = 20, accuracy = 1e-3 }\n"
                             "local a = scene:particle { position = {0, 0, 0}, mass = 1 }\n"
                             "local b = scene:particle { position = {1, 0, 0.2}, mass = 1 }\n"
                             "local c = scene:particle { position = {2, 0, 0.5}, mass = 1 }\n"
                             "scene:pin { a }\nscene:force('gravity', { g = {0, 0, -9.81} })\n"
                             "scene:force('springs', { edges = {{a, b}, {b, c}}, k = 1000 })\n"
                             "scene:force('drag', { rate = 1e-9 })\nreturn scene\n");
  explain(NULL, "pendulum.lua --json");
  assert_non_null(strstr(r.out, "\"chaotic\":true"));
  assert_non_null(strstr(part("drag"), "\"by_chance\":true"));
  says("drag", "as a disturbance of 1e-10 may");
  assert_null(strstr(part("drag"), "accuracy asked"));
  assert_non_null(strstr(part("springs"), "\"by_chance\":false")); /* falls 3 km */
  explain(NULL, "pendulum.lua");
  assert_non_null(strstr(r.out, "chaotic, differences below the extent say nothing"));
  explain(NULL, "pendulum.lua --until 1 --json");
  assert_non_null(strstr(r.out, "\"chaotic\":false"));
  double x = test_json(part("drag"), "x");
  assert_true(x > 1e-10 && x < 1e-8);
}

static void what_a_scene_cannot_do_without_is_named(void **state) {
  (void)state;
  test_write("needs.lua", "local scene = hooke.scene { duration = 0.1 }\n"
                          "local a = scene:particle { position = {0, 0, 0}, mass = 1 }\n"
                          "local b = scene:particle { position = {1, 0, 0}, mass = 1 }\n"
                          "scene:force('springs', { edges = {{a, b}}, k = 10 })\n"
                          "scene:force('gravity', { g = {0, 0, -1} })\n"
                          "scene:measure('strain', function(s) return s:strain('springs') end)\nreturn scene\n");
  explain(NULL, "needs.lua --json");
  says("springs", "without 'springs' the scene does not run");
  says("springs", "needs.lua:6"); /* the measure that asks for it */
  says("gravity", "without 'gravity' the run");
}

static void every_kind_is_switched_off(void **state) {
  (void)state;
  char before[1024];
  test_write("kinds.lua", "local scene = hooke.scene { duration = 0.5 }\n"
                          "local a = scene:particle { position = {0, 0, 1}, mass = 1 }\n"
                          "local b = scene:particle { position = {0, 1, 1}, mass = 1 }\n"
                          "scene:force('gravity', { g = {0, 0, -9.81} })\n"
                          "scene:constraint('bar', { edges = {{a, b}} })\n"
                          "scene:corrector('floor', { height = 0.5 })\n"
                          "scene:source('spout', { every = 0.2, position = {3, 0, 2} })\n"
                          "scene:measure('low', function(s) return s:position(a)[3] end)\nreturn scene\n");
  snprintf(before, sizeof before,
           "for p in constraint:bar corrector:floor source:spout; do mkdir -p k/${p%%%%:*}s && "
           "cp %s/tests/fixtures/${p##*:}.so k/${p%%%%:*}s/; done; HOOKE_PLUGIN_PATH=$PWD/k ",
           HK_BUILD);
  explain(before, "kinds.lua --json");
  says("bar", "\"kind\":\"constraint\"");
  says("spout", "ends with other particles");
  /* on the floor at 0.5 m; without it 1 - g/8 m, which leapfrog has exactly */
  assert_true(fabs(figure("floor", "low", "change") - (0.5 - 9.81 / 8)) < 1e-12);
  explain(before, "kinds.lua --until 0.15 --json"); /* before the first birth and the floor */
  assert_true(test_json(part("floor"), "x") == 0);
  assert_true(test_json(part("gravity"), "x") > 0.1);
}

static void wrong_use_is_refused(void **state) {
  (void)state;
  test_write("one.lua",
             "local scene = hooke.scene {}\nscene:particle { position = {0, 0, 0}, mass = 1 }\nreturn scene\n");
  static const char *const bad[][2] = {
      {"explain one.lua --repeats 3", "--repeats goes with --cost"},
      {"explain one.lua --cost --repeats 0", "'0' is not a whole number above 0"},
      {"explain one.lua --cost --until", "requires an argument"},
      {"explain one.lua --cost --integrator leapfog", "did you mean 'leapfrog'?"},
      {"explain one.lua --cost x=3", "x"},
      {"explain none.lua --cost", "none.lua"},
  };
  for (size_t k = 0; k < sizeof bad / sizeof *bad; k++) {
    test_hooke(&r, NULL, bad[k][0]);
    if (r.code != 1 || !strstr(r.err, bad[k][1])) fail_msg("%s: exit %d: %s", bad[k][0], r.code, r.err);
  }
}

/* The scene is untrusted: the program that draws runs outside of what confines it. */
static void what_was_found_is_drawn(void **state) {
  (void)state;
  test_write("drawn.lua", "local scene = hooke.scene { duration = 0.2 }\n"
                          "scene:particle { position = {0, 0, 1}, velocity = {1, 0, 0}, mass = 1 }\n"
                          "scene:force('gravity')\nscene:force('drag', { rate = 1 })\nreturn scene\n");
  explain(NULL, "drawn.lua --out drawn");
  assert_non_null(strstr(r.out, "wrote drawn/cost.png and cost.svg"));
  assert_true(test_exists("drawn/cost.dat") && test_exists("drawn/cost.png") && test_exists("drawn/cost.svg"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_part_is_worth_what_the_closed_forms_differ_by),
      cmocka_unit_test(the_rest_is_timed_at_the_same_step_and_at_its_own),
      cmocka_unit_test(chaos_is_not_taken_for_worth),
      cmocka_unit_test(what_a_scene_cannot_do_without_is_named),
      cmocka_unit_test(every_kind_is_switched_off),
      cmocka_unit_test(what_was_found_is_drawn),
      cmocka_unit_test(wrong_use_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
