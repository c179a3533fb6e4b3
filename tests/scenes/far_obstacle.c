/* What is far away and pinned takes no part: a cloth that falls on a ball has the same steps, evaluations, iterations
 * and factorisations, the same solver and the same places with a sphere 100 m away as without it, by explicit, implicit
 * and adaptive methods. */
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

/* The sphere comes last, so that the others keep their places; of `detail` 1e-3 m it has 10,602 unknowns, more than
 * those from which scenes in contact have iterations in place of factors. */
static const char scene[] =
    "local far, contact = param('far', 'none'), param('contact', 'contact')\n"
    "local s = hooke.scene { duration = 0.12, dt = 0.002, integrator = 'leapfrog' }\n"
    "s:force('gravity', { g = { 0, 0, -9.81 } })\n"
    "s:body { shape = 'sphere', radius = 0.25, position = { 0, 0, 0.45 }, detail = 1e-2 }\n"
    "local cloth = s:grid { nx = 8, ny = 8, width = 0.7, height = 0.7, density = 0.2, alternating = true,\n"
    "  origin = { -0.35, -0.35, 0.72 }, u = { 1, 0, 0 }, v = { 0, 1, 0 } }\n"
    "s:force('springs', s:membrane(cloth, { stiffness = 100, nu = 1 / 3, damping = 0.02 }))\n"
    "if contact == 'barrier' then s:force('barrier', { thickness = 2e-3, d_hat = 2e-3, friction = 0.3 })\n"
    "else s:corrector('contact', { thickness = 4e-3, friction = 0.3 }) end\n"
    "if far == 'body' then s:body { shape = 'sphere', radius = 1, position = { 100, 0, 0 }, detail = 1e-3 } end\n"
    "if far == 'obstacle' then\n"
    "  s:corrector('obstacle', { shape = 'sphere', radius = 1, position = { 100, 0, 0 } })\n"
    "end\n"
    "return s\n";

enum { COUNTS = 5 };
static const char *const count_name[COUNTS] = {"steps", "force_evaluations", "jacobian_evaluations", "factorizations",
                                               "linear_iterations"};

typedef struct ending {
  char solver[64], *state;
  double count[COUNTS];
} ending;

static char *read_all(const char *name) {
  char path[512];
  snprintf(path, sizeof path, "%s/%s", test_folder(), name);
  FILE *file = fopen(path, "rb");
  assert_non_null(file);
  assert_int_equal(fseek(file, 0, SEEK_END), 0);
  long size = ftell(file);
  rewind(file);
  char *text = calloc((size_t)size + 1, 1);
  assert_non_null(text);
  assert_int_equal(fread(text, 1, (size_t)size, file), (size_t)size);
  fclose(file);
  return text;
}

static ending run(const char *far, const char *options) {
  static test_result r;
  char arguments[512];
  ending end = {.state = NULL};
  test_write("far.lua", scene);
  snprintf(arguments, sizeof arguments, "run far.lua far=%s %s --json --quiet --no-check --no-output --state end.csv",
           far, options);
  test_hooke(&r, NULL, arguments);
  if (r.code != 0 && r.code != 5) fail_msg("%s: exit %d: %s", arguments, r.code, r.err);
  for (int k = 0; k < COUNTS; k++) end.count[k] = test_json(r.out, count_name[k]);
  const char *solver = strstr(r.out, "\"solver\"");
  if (solver) snprintf(end.solver, sizeof end.solver, "%.40s", solver);
  end.state = read_all("end.csv");
  return end;
}

/* m, the largest difference of two states in what both have; of a prefix: the far sphere comes last. */
static double difference(const char *a, const char *b) {
  double most = 0;
  while (a && b && *a && *b) {
    double x[4], y[4];
    if (sscanf(a, "%lf,%lf,%lf,%lf", x, x + 1, x + 2, x + 3) == 4 &&
        sscanf(b, "%lf,%lf,%lf,%lf", y, y + 1, y + 2, y + 3) == 4)
      for (int c = 0; c < 4; c++) most = fmax(most, fabs(x[c] - y[c]));
    a = strchr(a, '\n'), b = strchr(b, '\n');
    if (a && b) a++, b++;
  }
  return most;
}

/* m. Where sums end depends on how many particles a scene has, so that the last bit of a force may: 1e-16 of a
 * coordinate, which contact makes larger in some tens of steps. */
static const double rounding = 1e-12;

static void compare(const char *options) {
  static const char *const fars[] = {"body", "obstacle"};
  ending near = run("none", options);
  for (int k = 0; k < 2; k++) {
    ending far = run(fars[k], options);
    for (int c = 0; c < COUNTS; c++)
      if (far.count[c] != near.count[c])
        fail_msg("%s, %s: %s: %g, %g without it", options, fars[k], count_name[c], far.count[c], near.count[c]);
    assert_string_equal(far.solver, near.solver);
    double off = difference(far.state, near.state);
    if (!(off <= rounding)) fail_msg("%s, %s: off by %g m", options, fars[k], off);
    free(far.state);
  }
  free(near.state);
}

static void steps_with_impulses_are_the_same(void **state) {
  (void)state;
  compare("--integrator leapfrog");
  compare("--integrator backward_euler");
  compare("--integrator local_global");
}

/* Their tolerances are relative to the size of what moves. */
static void adaptive_steps_are_the_same(void **state) {
  (void)state;
  compare("--integrator linear_bdf2 --dt 0.02");
  compare("--integrator dopri5 --dt 0.02");
}

static void a_barrier_has_the_same_iterations(void **state) {
  (void)state;
  compare("contact=barrier --integrator bdf2 --dt 0.0167");
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(steps_with_impulses_are_the_same),
      cmocka_unit_test(adaptive_steps_are_the_same),
      cmocka_unit_test(a_barrier_has_the_same_iterations),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
