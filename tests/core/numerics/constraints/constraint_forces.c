/* The forces of constraints that a script reads at a frame: against closed forms, for every kind of method, shared by
 * equations that follow from others; and reading them changes nothing. */
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

static void run(const char *options) {
  char arguments[1024];
  snprintf(arguments, sizeof arguments, "run %s/scene.lua --json --quiet --no-output %s", test_folder(), options);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0) fail_msg("%s: exit %d: %s", options, r.code, r.err);
}

static void near(const char *key, double wanted, double tolerance) {
  double got = test_json(strstr(r.out, "\"measures\""), key);
  if (!(fabs(got - wanted) <= tolerance)) fail_msg("%s is %.17g, not %.17g +- %g", key, got, wanted, tolerance);
}

static const char *const methods[] = {"leapfrog", "rk4", "dopri5", "implicit_midpoint", "bdf2", "esdirk4"};

enum { METHODS = sizeof methods / sizeof *methods };

/* A chain of 8 bars hangs at rest: bar k carries the weight of the particles below it. A pendulum beside it swings from
 * the horizontal: its tension is m (g cos + v^2/L) at any place of a swing. Both at the state of the frame, whatever
 * the method's error is. Rounding of sums of ten weights. */
static void hanging_chain_and_pendulum_have_their_tensions(void **state) {
  (void)state;
  test_write("scene.lua",
             "local scene = hooke.scene { duration = 0.7, fps = 10, dt = 1 / 200 }\n"
             "local c = scene:strand { n = 9, from = { 0, 0, 0 }, to = { 0, 0, -2 }, mass = 0.9 }\n"
             "local pivot = scene:particle { position = { 5, 0, 0 } }\n"
             "local bob = scene:particle { position = { 5.5, 0, 0 }, mass = 2 }\n"
             "scene:pin { c:at(1), pivot }\n"
             "scene:force('gravity')\n"
             "scene:constraint('bars', { edges = c:structural() })\n"
             "scene:constraint('bars', { edges = { { pivot, bob } }, label = 'rod' })\n"
             "scene:measure('chain', function(s)\n"
             "  local worst = 0\n"
             "  for k, T in ipairs(s:constraint_forces('bars')) do\n"
             "    worst = math.max(worst, math.abs(T - (9 - k) * 0.1 * 9.81))\n"
             "  end\n"
             "  return worst\n"
             "end)\n"
             "scene:measure('rod', function(s)\n"
             "  local x, v = s:position(bob), s:velocity(bob)\n"
             "  return s:constraint_forces('rod')[1] - 2 * (-9.81 * x[3] + v[1]^2 + v[3]^2) / 0.5\n"
             "end)\n"
             "scene:measure('on the bob', function(s)\n"
             "  local x, f, T = s:position(bob), s:force('rod', bob), s:constraint_forces('rod')[1]\n"
             "  return math.abs(f[1] + T * (x[1] - 5) / 0.5) + math.abs(f[2]) + math.abs(f[3] + T * x[3] / 0.5)\n"
             "end)\n"
             "scene:measure('on the pin', function(s) return s:force('bars', c:at(1))[3] end)\n"
             "return scene\n");
  for (int m = 0; m < METHODS; m++) {
    char options[64];
    snprintf(options, sizeof options, "--integrator %s", methods[m]);
    run(options);
    near("chain", 0, 1e-13);
    /* The projection leaves 1e-12 of the size, 5 m, of a length of 0.5 m: 1e-11 of some 40 N. */
    near("rod", 0, 1e-9);
    near("on the bob", 0, 1e-9);
    near("on the pin", -0.8 * 9.81, 1e-13);
  }
}

/* Three bars side by side carry a third each, a bar beside them all of its own load; the motion, and the forces with
 * it, are those of one bar. The refinement of the singular system ends at 1e-14 of the largest. */
static void bars_that_follow_from_others_share_the_load(void **state) {
  (void)state;
  test_write("scene.lua", "local scene = hooke.scene { duration = 0.1, fps = 10, dt = 1 / 100 }\n"
                          "local a = scene:particle { position = { 0, 0, 0 } }\n"
                          "local b = scene:particle { position = { 0, 0, -1 }, mass = 3 }\n"
                          "local c = scene:particle { position = { 0, 0, -2 }, mass = 5 }\n"
                          "scene:pin { a }\n"
                          "scene:force('gravity', { g = { 0, 0, -10 } })\n"
                          "scene:constraint('bars', { edges = { { a, b }, { b, a }, { a, b }, { b, c } } })\n"
                          "scene:measure('sum', function(s)\n"
                          "  local T = s:constraint_forces('bars')\n"
                          "  return T[1] + T[2] + T[3]\n"
                          "end)\n"
                          "for k = 1, 4 do\n"
                          "  scene:measure('T' .. k, function(s) return s:constraint_forces('bars')[k] end)\n"
                          "end\n"
                          "return scene\n");
  run("");
  for (int k = 0; k < 3; k++) near((const char *[]){"T1", "T2", "T3"}[k], 80.0 / 3, 1e-6 * 80.0 / 3);
  near("sum", 80, 1e-11);
  near("T4", 50, 1e-11);
}

/* A cable pushes where it is taut only: a weight on two cables, of which one is slack. */
static void a_slack_cable_has_no_force(void **state) {
  (void)state;
  test_write("scene.lua", "local scene = hooke.scene { duration = 0.2, fps = 10, dt = 1 / 100 }\n"
                          "local a = scene:particle { position = { 0, 0, 0 } }\n"
                          "local b = scene:particle { position = { 0, 0, -1 }, mass = 3 }\n"
                          "scene:pin { a }\n"
                          "scene:force('gravity', { g = { 0, 0, -10 } })\n"
                          "scene:constraint('cables', { edges = { { a, b } } })\n"
                          "scene:constraint('cables', { edges = { { a, b } }, length = 2, label = 'slack' })\n"
                          "scene:measure('taut', function(s) return s:constraint_forces('cables')[1] end)\n"
                          "scene:measure('slack', function(s) return s:constraint_forces('slack')[1] end)\n"
                          "return scene\n");
  run("");
  near("taut", 30, 1e-11);
  near("slack", 0, 0);
}

/* ---- reading changes nothing ---- */

static char *end_state(const char *options) {
  static char text[2][4096];
  static int next;
  char path[512], arguments[256], *to = text[next = !next];
  snprintf(arguments, sizeof arguments, "%s --state %s/end.csv", options, test_folder());
  run(arguments);
  snprintf(path, sizeof path, "%s/end.csv", test_folder());
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  to[fread(to, 1, sizeof text[0] - 1, file)] = 0;
  fclose(file);
  return to;
}

/* A swinging chain with a bar given twice, and a chain of cables that lands in its taut state. */
static void reading_them_does_not_change_a_bit_of_the_motion(void **state) {
  (void)state;
  test_write("scene.lua",
             "local reads, cables = param('reads', 1, 'whether it reads'), param('cables', 0, 'cables')\n"
             "local scene = hooke.scene { duration = 0.5, fps = 20, dt = 1 / 200 }\n"
             "local c = scene:strand { n = 6, from = { 0, 0, 0 }, to = { 1, 0, 0.3 }, mass = 0.5 }\n"
             "scene:pin { c:at(1) }\n"
             "scene:force('gravity')\n"
             "scene:force('drag', { rate = 0.3 })\n"
             "local edges = c:structural() .. { { 2, 3 } }\n"
             "scene:constraint(cables == 1 and 'cables' or 'bars', { edges = edges, label = 'links' })\n"
             "if reads == 1 then\n"
             "  scene:measure('top', function(s) return s:constraint_forces('links')[1] + s:force('links', 3)[1] end)\n"
             "end\n"
             "return scene\n");
  for (int m = 0; m < METHODS; m++)
    for (int cables = 0; cables < 2; cables++) {
      char with[128], without[160];
      snprintf(with, sizeof with, "cables=%d --integrator %s", cables, methods[m]);
      snprintf(without, sizeof without, "%s reads=0", with);
      char *one = end_state(with), *other = end_state(without);
      if (strcmp(one, other) != 0) fail_msg("%s: the ends differ", with);
    }
}

static void a_wrong_label_is_an_error_with_the_line(void **state) {
  (void)state;
#define BODY                                                                                                           \
  "local scene = hooke.scene { duration = 0.2, fps = 10 }\n"                                                           \
  "local c = scene:strand { n = 3, mass = 1, length = 1 }\n"                                                           \
  "scene:constraint('bars', { edges = c:structural() })\n"
  test_refused(BODY "scene:measure('T', function(s) return s:constraint_forces('bar')[1] end)\nreturn scene\n",
               "--quiet", 1, "bad.lua:4: there is no constraint 'bar'; did you mean 'bars'?");
  test_refused(BODY "scene:measure('T', function(s) return s:constraint_forces()[1] end)\nreturn scene\n", "--quiet", 1,
               "bad.lua:4: expected a text, as in state:constraint_forces(LABEL), got nothing");
  test_refused(BODY "scene:measure('T', function(s) return s:constraint_forces('bars')[3] end)\nreturn scene\n",
               "--quiet", 1, "bad.lua:4: this function returned nil");
  test_refused(BODY "scene:measure('T', function(s) return s:force('bars', 4)[3] end)\nreturn scene\n", "--quiet", 1,
               "there is no particle 4");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(hanging_chain_and_pendulum_have_their_tensions),
      cmocka_unit_test(bars_that_follow_from_others_share_the_load),
      cmocka_unit_test(a_slack_cable_has_no_force),
      cmocka_unit_test(reading_them_does_not_change_a_bit_of_the_motion),
      cmocka_unit_test(a_wrong_label_is_an_error_with_the_line),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
