/* The energy balance of steps that correctors end, by methods of every kind: a plate that sinks slowly on a pyramid of
 * stiff springs, or pulls on one that is fixed above it, does all the work that they store, k (l - l_0)^2 / 2. What a
 * step falls and is put back has to be no energy, and what is not corrected has to keep the error of its method. */
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

/* The apex is pressed from `high` to 0.1 m less in 1 s, with no speed at either end. beside: an oscillator of 4 rad/s
 * and 8 J that touches nothing. */
static const char press[] =
    "local feet, h, damping = param('feet', 4, ''), param('h', 1e-3, ''), param('damping', 0, '')\n"
    "local beside = param('beside', false, '')\n"
    "local s = hooke.scene{ duration = 1, fps = 10, dt = h }\n"
    "local base, bars, apart = {}, {}, {}\n"
    "local apex = s:particle{ position = { 0, 0, 0.3 }, mass = 0.1 }\n"
    "for q = 1, feet do\n"
    "  local a, r = 2 * math.pi * q / feet, feet > 1 and 0.3 or 0\n"
    "  base[q] = s:particle{ position = { r * math.cos(a), r * math.sin(a), feet > 1 and -0.1 or 0.7 }, mass = 1 }\n"
    "  bars[q], apart[q] = { base[q], apex }, base[q]\n"
    "end\n"
    "s:pin(base)\n"
    "s:force('springs', { edges = bars, k = 2e4, damping = damping })\n"
    "local function sink(t) return -0.1 * t * t * (3 - 2 * t) end\n"
    "if beside then\n"
    "  local fixed = s:particle{ position = { 5, 0, 0 }, mass = 1 }\n"
    "  local free = s:particle{ position = { 7, 0, 0 }, mass = 1, velocity = { 4, 0, 0 } }\n"
    "  s:pin{ fixed }\n"
    "  s:force('springs', { edges = { { fixed, free } }, k = 16 })\n"
    "  apart[#apart + 1], apart[#apart + 2] = fixed, free\n"
    "end\n"
    "s:body{ shape = 'box', size = { 0.2, 0.2, 0.1 }, position = { 0.01, 0.02, 0.355 },\n"
    "  path = function(t) return 0, 0, sink(t) end }\n"
    "s:corrector('contact', { radius = 5e-3, leave = apart })\n"
    "return s\n";

typedef struct balance {
  double work, first, last, off; /* J */
} balance;

static balance run(const char *method, double h, const char *options) {
  char command[256];
  test_write("press.lua", press);
  snprintf(command, sizeof command, "run press.lua --quiet --json --no-output --no-check --integrator %s h=%g %s",
           method, h, options);
  test_hooke(&r, NULL, command);
  if (r.code != 0 && r.code != 5) fail_msg("%s: exit %d: %s", command, r.code, r.err);
  balance b = {.work = test_json(r.out, "work"), .first = test_json(r.out, "first"), .last = test_json(r.out, "last")};
  b.off = b.last - b.first - b.work;
  print_message("%-18s h = %g s %-24s work %.9f J, energy %.9f J\n", method, h, options, b.work, b.last);
  return b;
}

static const char *const methods[] = {"leapfrog",       "local_leapfrog",  "rk4", "bdf2", "linear_bdf2", "xpbd",
                                      "backward_euler", "symplectic_euler"};
enum { METHODS = sizeof methods / sizeof *methods };

/* J: a spring of 2e4 N/m, stretched by 0.1 m, which is linear: methods of order 1 have the lag of their velocities
 * left, h/2 of the force times the plate's speed at most. */
static void a_stretched_spring_has_the_work_that_was_done(void **state) {
  (void)state;
  const double all = 100, h = 1e-3;
  for (int k = 0; k < METHODS; k++) {
    balance b = run(methods[k], h, "feet=1");
    if (!(fabs(b.work - all) < 1e-6 * all && fabs(b.last - all) < 1e-6 * all)) fail_msg("%s is off", methods[k]);
  }
  balance damped = run("bdf2", h, "feet=1 damping=20");
  assert_true(fabs(damped.work - all) < 1e-6 * all);
}

/* The pyramid is not linear: the mean of the forces at both ends of a step is right to order 2, whatever the method. */
static void the_balance_of_a_pyramid_is_of_order_two(void **state) {
  (void)state;
  static const char *const some[] = {"leapfrog", "rk4", "bdf2"};
  const double l_0 = sqrt(0.3 * 0.3 + 0.4 * 0.4), l = sqrt(0.3 * 0.3 + 0.3 * 0.3),
               all = 4 * 2e4 / 2 * (l - l_0) * (l - l_0);
  for (size_t k = 0; k < sizeof some / sizeof *some; k++) {
    balance coarse = run(some[k], 8e-4, "feet=4 damping=10"), fine = run(some[k], 4e-4, "feet=4 damping=10");
    assert_true(fabs(fine.last - all) < 1e-6 * all && fabs(coarse.off) < 1e-5 * all);
    double order = log2(fabs(coarse.off) / fabs(fine.off));
    if (!(order > 1.7)) fail_msg("%s: %g J off, then %g J: of order %g", some[k], coarse.off, fine.off, order);
  }
}

/* Backward Euler takes a part 1/(1 + (h w)^2) of the energy of an oscillator in each step. */
static void what_is_not_corrected_keeps_the_error_of_its_method(void **state) {
  (void)state;
  const double h = 1e-3, w = 4, swings = 8;
  balance damps = run("backward_euler", h, "feet=1 beside=true"), keeps = run("leapfrog", h, "feet=1 beside=true");
  double lost = swings * (1 - pow(1 + h * h * w * w, -1 / h));
  print_message("backward Euler loses %.6f J of them, expected %.6f J\n", -damps.off, lost);
  assert_true(fabs(damps.off + lost) < 1e-2 * lost);
  assert_true(fabs(keeps.off) < 1e-3 * lost);
}

/* Two boxes press a sheet between them out of its plane: the springs turn and stretch by a quarter.
 * Counted as what contact changed at the ends of steps, the balance was off by 0.16 of the largest kinetic energy. */
static const char pinch[] =
    "local N = 7\n"
    "local s = hooke.scene{ duration = 0.3, fps = 60, integrator = 'leapfrog' }\n"
    "local c = s:grid{ nx = N, ny = N, width = 0.3, height = 0.3, density = 0.2, alternating = true,\n"
    "  origin = { -0.15, -0.15, 0.2 } }\n"
    "s:force('springs', s:membrane(c, { stiffness = 100, nu = 1 / 3, damping = 0.02 }))\n"
    "local ends = {}\n"
    "for i = 1, N do ends[2 * i - 1], ends[2 * i] = c:at(i, 1), c:at(i, N) end\n"
    "s:pin(ends)\n"
    "local function way(t) t = t / 0.3; return t * t * (3 - 2 * t) end\n"
    "for _, box in ipairs{ { 0.01, 0, 0.1, 0.13 }, { -0.02, 0.02, 0.36, -0.02 } } do\n"
    "  s:body{ shape = 'box', size = { 0.08, 0.08, 0.1 }, position = { box[1], box[2], box[3] },\n"
    "    path = function(t) return 0, 0, box[4] * way(t) end }\n"
    "end\n"
    "s:force('drag', { rate = 3 })\n"
    "s:corrector('contact', { thickness = 4e-3, friction = 0.3 })\n"
    "return s\n";

static void a_pinched_sheet_is_balanced_at_the_step_that_is_chosen(void **state) {
  (void)state;
  test_write("pinch.lua", pinch);
  test_hooke(&r, NULL, "run pinch.lua --quiet --json --no-output --no-check");
  double drift = test_json(r.out, "drift");
  print_message("a pinched sheet: off by %g of the largest kinetic energy\n", drift);
  assert_int_equal(r.code, 0);
  assert_true(fabs(drift) < 0.02);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(a_stretched_spring_has_the_work_that_was_done),
                                     cmocka_unit_test(the_balance_of_a_pyramid_is_of_order_two),
                                     cmocka_unit_test(what_is_not_corrected_keeps_the_error_of_its_method),
                                     cmocka_unit_test(a_pinched_sheet_is_balanced_at_the_step_that_is_chosen)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
