/* A force in Lua: the paths and energies of the same forces in C, wrong results named with the script's line, the time
 * and the particle, and the limits of the sandbox inside it. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

/* ---- in a script ---- */

#define HEAD                                                                                                           \
  "local scene = hooke.scene { duration = 1, fps = 10, dt = 0.05, integrator = 'rk4' }\n"                              \
  "scene:particle { position = {2, 0, 0}, velocity = {0, 1, 0}, mass = 0.5 }\n"                                        \
  "scene:particle { position = {0, 3, 0}, velocity = {0, 0, 1}, mass = 2 }\n"

/* The field is on line 5; from 0.5 s on it is wrong for particle 2. */
static void refused(const char *result, const char *text) {
  char scene[2048];
  snprintf(scene, sizeof scene,
           HEAD "scene:force('field', {\nf = function(t, x, y, z, vx, vy, vz, id) if t < 0.5 or id == 1 then return 1, "
                "2, 3 end; %s end })\nreturn scene\n",
           result);
  test_refused(scene, "--quiet --no-output", 1, text);
}

static void a_wrong_result_is_named_with_line_time_and_particle(void **state) {
  (void)state;
  refused("return nil", "bad.lua:5: this function returned nil where a number is needed at t = 0.5 s, particle 2");
  refused("return", "bad.lua:4: field: a function gave 0 numbers at t = 0.5 s for particle 2, expected 3");
  refused("return 1, 2", "bad.lua:4: field: a function gave 2 numbers at t = 0.5 s for particle 2, expected 3");
  refused("return 1, 2, 3, 4", "bad.lua:5: this function returned more numbers than are expected at t = 0.5 s, part");
  refused("return 1, 0/0, 3", "bad.lua:5: this function returned nan at t = 0.5 s, particle 2");
  refused("return 1, 2, -1/0", "bad.lua:5: this function returned -inf at t = 0.5 s, particle 2");
  refused("return 'x', 2, 3", "bad.lua:5: this function returned a text where a number is needed at t = 0.5");
  refused("return qqqqqq.there",
          "bad.lua:5: 'qqqqqq' is not defined; a text stands in quotes, \"qqqqqq\" (at t = 0.5 s, particle 2)");
  refused("error('no force here')", "bad.lua:5: no force here (at t = 0.5 s, particle 2)");
}

static void a_wrong_potential_is_named_as_well(void **state) {
  (void)state;
  test_refused(HEAD
               "scene:force('field', {\npotential = function(t, x) if t > 0.4 then return 0/0 end; return x end })\n"
               "return scene\n",
               "--quiet --no-output", 1, "bad.lua:5: this function returned nan at t = 0.4");
}

/* Particles are taken in groups. */
static void the_particle_is_named_wherever_it_is_in_a_group(void **state) {
  static const int wrong[] = {1, 64, 65, 128, 129, 200};
  (void)state;
  for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    char scene[1024], text[128];
    snprintf(
        scene, sizeof scene,
        "local scene = hooke.scene { duration = 1, fps = 10, dt = 0.05, integrator = 'rk4' }\n"
        "local s = scene:strand { from = {0, 0, 0}, to = {1, 0, 0}, n = 200, mass = 1 }\n"
        "scene:force('field', { f = function(t, x, y, z, vx, vy, vz, id) return 1, id == %d and 0/0 or 2, 3 end })\n"
        "return scene\n",
        wrong[k]);
    snprintf(text, sizeof text, "bad.lua:3: this function returned nan at t = 0 s, particle %d", wrong[k]);
    test_refused(scene, "--quiet --no-output", 1, text);
  }
}

static void neither_or_both_functions_are_refused(void **state) {
  (void)state;
  test_refused(HEAD "scene:force('field')\nreturn scene\n", "--quiet", 1,
               "bad.lua:4: field: give either f or potential");
  test_refused(HEAD
               "local function f() return 0, 0, 0 end\nscene:force('field', { f = f, potential = f })\nreturn scene\n",
               "--quiet", 1, "bad.lua:5: field: give either f or potential");
  test_refused(HEAD "scene:force('field', { f = 3 })\nreturn scene\n", "--quiet", 1,
               "f: expected function(t, x, y, z, vx, vy, vz, id) -> fx, fy, fz, got a number");
}

static void the_limits_of_the_sandbox_hold_inside(void **state) {
  (void)state;
  refused("while true do end", "the script ran beyond its limit of");
  bool sanitized = strstr(HK_BUILD, "sanitize") != NULL; /* their allocators are slower than the limit of time */
  /* In copies of some size: of single letters a slow memory takes longer than the limit of time. */
  if (!sanitized)
    refused("local t, s = {}, ('x'):rep(1e5); while true do t[#t + 1] = s:rep(10) .. #t end", "not enough memory");
  refused("return os.time(), 0, 0", "bad.lua:5: os.time is not available to scenes");
}

/* The same scene with a field and with the force in C: the same path, energy and force. Of the potential's differences
 * roundings of 10 J/2e-5 m = 1e-10 N are left; all else is rounding. The id is a whole number, and s:force calls the
 * field from within the script. */
static void a_field_is_the_force_that_it_writes(void **state) {
  (void)state;
  static test_result r;
  static const char *const keys[] = {"x", "y", "f", "u"};
  double first[4];
  char command[1200];
  test_write("same.lua", HEAD
             "local which = param('which', 0, 'the force')\n"
             "if which == 0 then scene:force('central', { strength = 4, label = 'pull' })\n"
             "elseif which == 1 then scene:force('field', { label = 'pull', f = function(t, x, y, z, vx, vy, vz, id)\n"
             "  assert(math.type(id) == 'integer')\n"
             "  local k = -4 * ({ 0.5, 2 })[id]; return k * x, k * y, k * z end })\n"
             "else scene:force('field', { label = 'pull', potential = function(t, x, y, z, id)\n"
             "  return 2 * ({ 0.5, 2 })[id] * (x * x + y * y + z * z) end }) end\n"
             "scene:measure('x', function(s) return s:position(1)[1] end)\n"
             "scene:measure('y', function(s) return s:position(1)[2] end)\n"
             "scene:measure('f', function(s) return s:force('pull', 2)[2] end)\n"
             "scene:measure('u', function(s) return s:potential() end)\nreturn scene\n");
  for (int which = 0; which < 3; which++) {
    snprintf(command, sizeof command, "run %s/same.lua which=%d --json --no-output", test_folder(), which);
    test_hooke(&r, NULL, command);
    if (r.code != 0) fail_msg("%s", r.err);
    for (int k = 0; k < 4; k++) {
      double value = test_json(r.out, keys[k]);
      if (which == 0) first[k] = value;
      bool none = which == 1 && k == 3; /* f has no energy */
      if (!none && !(fabs(value - first[k]) < 1e-9))
        fail_msg("%d: %s is %.12g, not %.12g", which, keys[k], value, first[k]);
    }
  }
}

/* Energy that a potential gains by its change in time is work: m x'' = -(1 + sin 3 t) x by rk4 with steps of 0.05 s. */
static void a_potential_that_changes_in_time_does_work(void **state) {
  (void)state;
  static test_result r;
  char command[1200];
  test_write("work.lua", HEAD "scene:force('field', { potential = function(t, x, y, z)\n"
                              "  return (1 + math.sin(3 * t)) * (x * x + y * y + z * z) / 2 end })\nreturn scene\n");
  snprintf(command, sizeof command, "run %s/work.lua --json --no-output", test_folder());
  test_hooke(&r, NULL, command);
  if (r.code != 0) fail_msg("%s", r.err);
  assert_true(fabs(test_json(r.out, "work")) > 0.5 && fabs(test_json(r.out, "drift")) < 1e-4);
}

/* A push that is zero at all steps of 1/60 s, at all half steps, and not between them. */
static void what_a_field_does_between_the_steps_is_noticed(void **state) {
  (void)state;
  static test_result r;
  char command[1200];
  test_write("hum.lua",
             "local scene = hooke.scene { duration = 0.5, accuracy = 1e-3, dt = 1/60 }\n"
             "scene:particle { mass = 1 }\n"
             "scene:force('field', { f = function(t) return 2e3 * math.sin(2 * math.pi * 1800 * t), 0, 0 end })\n"
             "return scene\n");
  snprintf(command, sizeof command, "run %s/hum.lua --no-output", test_folder());
  test_hooke(&r, NULL, command);
  if (r.code != 5) fail_msg("%d: %s", r.code, r.out);
}

/* With a length no step moves a particle by more than half of it: 0.2 m at 4 m/s. */
static void a_stated_length_limits_the_steps(void **state) {
  (void)state;
  static test_result r;
  char command[1200];
  test_write("length.lua", "local scene = hooke.scene { duration = 1, fps = 1, integrator = 'leapfrog' }\n"
                           "scene:particle { velocity = {0, 4, 0}, mass = 1 }\n"
                           "scene:force('field', { f = function() return 0, 0, 0 end, length = 0.2 })\nreturn scene\n");
  snprintf(command, sizeof command, "run %s/length.lua --json --no-output", test_folder());
  test_hooke(&r, NULL, command);
  if (r.code != 0) fail_msg("%s", r.err);
  assert_true(fabs(test_json(r.out, "dt_max") - 0.025) < 1e-12);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_wrong_result_is_named_with_line_time_and_particle),
      cmocka_unit_test(a_wrong_potential_is_named_as_well),
      cmocka_unit_test(the_particle_is_named_wherever_it_is_in_a_group),
      cmocka_unit_test(neither_or_both_functions_are_refused),
      cmocka_unit_test(the_limits_of_the_sandbox_hold_inside),
      cmocka_unit_test(a_field_is_the_force_that_it_writes),
      cmocka_unit_test(a_potential_that_changes_in_time_does_work),
      cmocka_unit_test(what_a_field_does_between_the_steps_is_noticed),
      cmocka_unit_test(a_stated_length_limits_the_steps),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
