/* linear_bdf2 on a stiff curtain against leapfrog's many steps: the error that few steps leave, that it falls with the
 * tolerance, that both direct and iterative solvers give it. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

enum { SIDE = 12, PARTICLES = SIDE * SIDE };

static test_result r;

static const char curtain[] =
    "local k = 1e6\n"
    "local s = hooke.scene{ duration = 0.25, fps = 60, threads = 1, integrator = 'leapfrog' }\n"
    "local c, row, d = s:grid{ nx = 12, ny = 12, width = 1, height = 1, mass = 0.15 }, {}, math.sqrt(k / 1000)\n"
    "for i = 1, 12 do row[i] = c:at(i, 12) end\n"
    "s:pin(row)\n"
    "s:force('gravity', { g = {0, 0, -9.81} })\n"
    "s:force('springs', { edges = c:structural(), k = k, damping = 0.02 * d })\n"
    "s:force('springs', { edges = c:shear(), k = 0.3 * k, damping = 0.01 * d })\n"
    "s:force('springs', { edges = c:flexion(), k = 0.05 * k, damping = 0.005 * d })\n"
    "return s\n";

static void simulate(const char *options, double *x) {
  char command[256];
  snprintf(command, sizeof command, "run curtain.lua --quiet --json --state end.csv %s", options);
  test_hooke(&r, NULL, command);
  if (r.code != 0 && r.code != 5) fail_msg("%s: exit %d: %s", options, r.code, r.err);
  char line[512];
  char path[512];
  snprintf(path, sizeof path, "%s/end.csv", test_folder());
  FILE *f = fopen(path, "r");
  assert_non_null(f);
  for (int i = -1; i < PARTICLES && fgets(line, sizeof line, f); i++)
    if (i >= 0) assert_int_equal(sscanf(line, "%*d,%lf,%lf,%lf", &x[3 * i], &x[3 * i + 1], &x[3 * i + 2]), 3);
  fclose(f);
}

static double apart(const double *a, const double *b) {
  double sum = 0;
  for (size_t e = 0; e < 3 * PARTICLES; e++) sum += (a[e] - b[e]) * (a[e] - b[e]);
  return sqrt(sum / PARTICLES);
}

/* Errors asked for in the method's own measure, 1e-1 and 1e-2 of the motion a step, are 2e-2 and 2e-3 m here. */
static void few_steps_follow_a_stiff_curtain(void **state) {
  (void)state;
  static double exact[3 * PARTICLES], x[3 * PARTICLES];
  test_write("curtain.lua", curtain);
  simulate("", exact);
  double many = test_json(r.out, "steps");
  simulate("--integrator linear_bdf2 --tol 1e-1", x);
  double coarse = apart(x, exact);
  assert_true(coarse < 3e-2);
  simulate("--integrator linear_bdf2 --tol 1e-2", x);
  double fine = apart(x, exact), steps = test_json(r.out, "steps");
  assert_true(fine < 3e-3 && fine < coarse);
  assert_true(steps < many / 20);
  simulate("--integrator linear_bdf2 --tol 1e-2 --solver stale_cholesky", x);
  assert_true(apart(x, exact) < 3e-3);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(few_steps_follow_a_stiff_curtain),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
