/* A function of t that stands for a parameter acts at the right time in every kind of plugin; where the parameter
 * cannot be one, it is refused. (Forces: tests/core/run/run/run.c.) */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#define FIXTURE(name) "'" HK_BUILD "/tests/fixtures/" name ".so'"
#define SCENE "local scene = hooke.scene { duration = 0.5, fps = 10, dt = 0.01 }\n"
#define END "return scene\n"

static test_result r;

/* The last value of the measure `m`. */
static double measured(const char *scene) {
  test_write("timed.lua", scene);
  test_hooke(&r, NULL, "run timed.lua --trust --json --quiet --no-output");
  if (r.code != 0 && r.code != 5) fail_msg("exit %d: %s", r.code, r.err);
  return test_json(r.out, "m");
}

/* Resting on a floor that rises to t/10: exactly its height, which is set and not summed. */
static void a_corrector_sees_the_time_of_the_new_state(void **state) {
  (void)state;
  double z = measured(SCENE "local p = scene:particle { mass = 1 }\nscene:force('gravity')\nscene:corrector(" FIXTURE(
      "floor") ", { height = function(t) return t / 10 end })\n"
               "scene:measure('m', function(s) return s:position(p)[3] end)\n" END);
  assert_true(z == 0.5 / 10);
}

/* The length that the bar has at the end, 1.25 m, up to what projections leave (1e-12 of the extent). */
static void a_constraint_follows_its_function_of_time(void **state) {
  (void)state;
  double length = measured(
      SCENE
      "local a = scene:particle { mass = 1 }\nlocal b = scene:particle { position = {1, 0, 0}, mass = 2 }\n"
      "scene:constraint(" FIXTURE(
          "stretching_bar") ", { edges = {{a, b}}, length = function(t) return 1 + t / 2 end, rate = 0.5 })\n"
                            "scene:measure('m', function(s) return s:position(b)[1] - s:position(a)[1] end)\n" END);
  assert_true(fabs(length - 1.25) < 1e-11);
}

/* Born at 0.1 s, 0.2 s, ... with 1 + t kg: 1 + 1.1 + 1.2 + 1.3 + 1.4, and 1.5 only with the step after the end. 1e-12:
 * roundings of the multiples of 0.1. */
static void a_source_sees_the_time_of_the_birth(void **state) {
  (void)state;
  double mass = measured(SCENE "scene:particle { mass = 1 }\nscene:source(" FIXTURE(
      "sower") ", { every = 0.1, mass = function(t) return 1 + t end })\n"
               "scene:measure('m', function(s) local sum = 0\n"
               "for _, id in ipairs(s:ids()) do sum = sum + s:mass(id) end\nreturn sum end)\n" END);
  assert_true(fabs(mass - 6) < 1e-12);
}

/* Fifty steps of 0.01 s that begin at 0, 0.01, ...: the sum of t h is 0.01^2 * 49 * 50 / 2. 1e-14: its roundings. */
static void an_integrator_sees_the_time_of_its_step(void **state) {
  (void)state;
  double x = measured(SCENE "local p = scene:particle { mass = 1 }\nscene:integrator(" FIXTURE(
      "liar") ", { drift = function(t) return t end })\n"
              "scene:measure('m', function(s) return s:position(p)[1] end)\n" END);
  assert_true(fabs(x - 0.1225) < 1e-14);
}

/* Height of the lower end of a hanging spring at `until` when solutions are multiplied by that factor. */
static double hanging(const char *factor, const char *until) {
  char scene[2048], arguments[128];
  snprintf(scene, sizeof scene,
           "local scene = hooke.scene { duration = 0.5, fps = 10, dt = 0.05, integrator = 'backward_euler' }\n"
           "local a = scene:particle { mass = 1 }\nlocal b = scene:particle { position = {1, 0, 0}, mass = 2 }\n"
           "scene:force('gravity')\nscene:force('springs', { edges = {{a, b}}, k = 10, rest = 0.5 })\n"
           "scene:pin { a }\nscene:solver(" FIXTURE(
               "tamperer") ", { factor = %s })\n"
                           "scene:measure('m', function(s) return s:position(b)[3] end)\n" END,
           factor);
  test_write("solver.lua", scene);
  snprintf(arguments, sizeof arguments, "run solver.lua --trust --json --quiet --no-output --until %s", until);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0 && r.code != 5) fail_msg("exit %d: %s", r.code, r.err);
  return test_json(r.out, "m");
}

/* Solutions are taken for 0 in the steps that begin at 0.2 s or later: until then nothing differs, from then on it
 * does: gravity and spring, which nearly balance here, leave 6 cm by 0.5 s. */
static void a_solver_sees_the_time_of_the_step(void **state) {
  (void)state;
  const char *switched = "function(t) return t < 0.2 and 1 or 0 end";
  assert_true(hanging("1", "0.2") == hanging(switched, "0.2"));
  assert_true(fabs(hanging("1", "0.5") - hanging(switched, "0.5")) > 0.01);
}

static void an_output_sees_the_time_of_the_frame(void **state) {
  (void)state;
  char path[4096], line[256];
  double t = NAN, mark = NAN;
  int frames = 0;
  test_write("timed.lua", SCENE "scene:particle { mass = 1 }\nscene:output(" FIXTURE(
                              "witness") ", { mark = function(t) return 2 * t end })\n" END);
  test_hooke(&r, NULL, "run timed.lua --trust --quiet --out marks");
  assert_int_equal(r.code, 0);
  snprintf(path, sizeof path, "%s/marks/witness/calls.txt", test_folder());
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  while (fgets(line, sizeof line, file)) {
    const char *at = strstr(line, " t=");
    if (strncmp(line, "frame", 5) != 0) continue;
    assert_int_equal(sscanf(at, " t=%lg first=%*u mark=%lg", &t, &mark), 2);
    assert_true(mark == 2 * t);
    frames++;
  }
  fclose(file);
  assert_int_equal(frames, 6);
}

static void a_parameter_that_is_none_of_time_refuses_a_function(void **state) {
  (void)state;
  test_refused(SCENE "scene:particle { mass = 1 }\nscene:source(" FIXTURE(
                   "sower") ", { every = function(t) return 1 end })\n" END,
               "--trust", 1, "bad.lua:3: sower: every: expected a constant, got a function");
  test_refused(SCENE
               "scene:particle { mass = 1 }\nscene:corrector(" FIXTURE("floor") ", { height = 'function' })\n" END,
               "--trust", 1, "floor: height: expected a number, got a string");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_corrector_sees_the_time_of_the_new_state),
      cmocka_unit_test(a_constraint_follows_its_function_of_time),
      cmocka_unit_test(a_source_sees_the_time_of_the_birth),
      cmocka_unit_test(an_integrator_sees_the_time_of_its_step),
      cmocka_unit_test(a_solver_sees_the_time_of_the_step),
      cmocka_unit_test(an_output_sees_the_time_of_the_frame),
      cmocka_unit_test(a_parameter_that_is_none_of_time_refuses_a_function),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
