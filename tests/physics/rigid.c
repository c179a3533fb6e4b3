/* Rigid bodies in whole runs: a run goes on from a checkpoint to the same bits, results do not depend on the number of
 * threads, and methods of every kind come to the same motion of bodies, joints and springs. */
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

static void run(const char *arguments) {
  test_hooke(&r, NULL, arguments);
  if (r.code != 0) fail_msg("%s: exit %d: %s", arguments, r.code, r.err);
}

/* A file of the test's folder, in malloc's memory. */
static char *text_of(const char *name) {
  char path[512];
  snprintf(path, sizeof path, "%s/%s", test_folder(), name);
  FILE *file = fopen(path, "r");
  assert_non_null(file);
  char *text = calloc(1, 1 << 20);
  assert_non_null(text);
  assert_true(fread(text, 1, (1 << 20) - 1, file) > 0);
  fclose(file);
  return text;
}

static void same(const char *one, const char *other) {
  char *a = text_of(one), *b = text_of(other);
  if (strcmp(a, b) != 0) fail_msg("%s and %s differ", one, other);
  free(a);
  free(b);
}

static const char *const linkage =
    "local scene = hooke.scene { duration = 1, fps = 10, dt = param('dt', 1 / 200, 's') }\n"
    "local a = scene:rigid { shape = 'box', size = {0.2, 0.3, 1}, mass = 2, spin = {1, 2, 0.5} }\n"
    "local b = scene:rigid { shape = 'box', size = {1, 0.2, 0.3}, mass = 1, position = {0.5, 0, 0.5} }\n"
    "scene:joint { kind = 'hinge', a = a, b = b, at = {0, 0, 0.5}, axis = {0, 1, 0} }\n"
    "scene:joint { kind = 'ball', a = a, at = {0, 0, -0.5} }\n"
    "local q = scene:particle { position = {2, 0.3, 0.5}, mass = 0.3 }\n"
    "local tip = b:point{0.5, 0, 0}\n"
    "scene:force('springs', { edges = {{ tip, q }}, k = 30, damping = 0.1, rest = 0.7 })\n"
    "scene:force('gravity', { g = {0, 0, -9.81} })\n"
    "for c = 1, 3 do scene:measure('tip' .. c, function(s) return s:position(tip)[c] end) end\n"
    "scene:output('checkpoint', { every = 5 })\n"
    "return scene\n";

static void a_run_goes_on_to_the_same_bits(void **state) {
  static const char *const methods[] = {"leapfrog", "kahan_li8", "dopri5", "bdf2"};
  (void)state;
  test_write("linkage.lua", linkage);
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    char line[256];
    snprintf(line, sizeof line, "run linkage.lua --quiet --trust --integrator %s --state whole.csv --out whole",
             methods[k]);
    run(line);
    snprintf(line, sizeof line, "run linkage.lua --quiet --trust --integrator %s --until 0.5 --out part", methods[k]);
    run(line);
    snprintf(
        line, sizeof line,
        "run linkage.lua --quiet --trust --integrator %s --resume part/newest.checkpoint --until 1 --state part.csv",
        methods[k]);
    run(line);
    same("whole.csv", "part.csv");
  }
}

/* 3,600 particles and 1,800 points, in several blocks and domains. */
static void threads_do_not_change_a_bit(void **state) {
  (void)state;
  test_write("many.lua",
             "local scene = hooke.scene { duration = 0.02, fps = 50, dt = 1e-3 }\n"
             "local edges, last = {}, nil\n"
             "for k = 1, 900 do\n"
             "  local b = scene:rigid { shape = 'box', size = {0.2, 0.3, 1}, mass = 1 + k % 3, position = {k, 0, 0},\n"
             "    spin = {1, 2, k % 5} }\n"
             "  local low, high = b:point{0, 0, -0.5}, b:point{0, 0, 0.5}\n"
             "  if last then edges[#edges + 1] = { last, low } end\n"
             "  last = high\n"
             "end\n"
             "scene:force('springs', { edges = edges, k = 100, damping = 0.1 })\n"
             "scene:force('gravity', { g = {0, 0, -9.81} })\n"
             "return scene\n");
  run("run many.lua --quiet --trust --no-output --threads 1 --state one.csv");
  run("run many.lua --quiet --trust --no-output --threads 3 --state three.csv");
  same("one.csv", "three.csv");
}

/* The reference is gauss_radau, by rounding; methods of order 2, as kahan_li8 is where a force depends on velocities,
 * come to it with their square of the step, adaptive ones with their tolerance. */
static void methods_of_every_kind_come_to_the_same_motion(void **state) {
  static const struct {
    const char *method;
    double within; /* m */
  } list[] = {{"leapfrog", 2e-3},          {"kahan_li8", 1e-4},          {"rk4", 1e-5},  {"dopri5 --tol 1e-9", 1e-6},
              {"implicit_midpoint", 2e-3}, {"esdirk4 --tol 1e-8", 1e-4}, {"bdf2", 1e-2}, {"cvode --tol 1e-9", 1e-4}};
  double tip[3];
  (void)state;
  test_write("linkage.lua", linkage);
  run("run linkage.lua --quiet --json --no-output --trust --integrator gauss_radau");
  for (int c = 0; c < 3; c++) tip[c] = test_json(r.out, (const char *[]){"tip1", "tip2", "tip3"}[c]);
  for (size_t k = 0; k < sizeof list / sizeof *list; k++) {
    char line[256];
    snprintf(line, sizeof line, "run linkage.lua --quiet --json --no-output --trust --integrator %s", list[k].method);
    run(line);
    for (int c = 0; c < 3; c++) {
      double off = test_json(r.out, (const char *[]){"tip1", "tip2", "tip3"}[c]) - tip[c];
      if (!(fabs(off) <= list[k].within)) fail_msg("%s: tip%d is off by %g m", list[k].method, c + 1, off);
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_run_goes_on_to_the_same_bits),
      cmocka_unit_test(threads_do_not_change_a_bit),
      cmocka_unit_test(methods_of_every_kind_come_to_the_same_motion),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
