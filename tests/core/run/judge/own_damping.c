/* What core/run/judge/own_damping.c promises: below which time a method damps, and that this is said instead of being
 * held against a run that asks for no accuracy. */
#include "tests/support/command.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

/* A sheet that swings down from its upper edge, with springs too fast for the steps of 1/120 s. */
static void run(const char *arguments, int code) {
  char all[512];
  snprintf(all, sizeof all, "run %s/scripts/scenes/curtain.lua N=12 --until 0.5 --json --quiet --no-output %s", HK_ROOT,
           arguments);
  test_hooke(&r, NULL, all);
  if (r.code != code) fail_msg("%s: exit %d instead of %d: %s%s", all, r.code, code, r.err, r.out);
}

/* Backward Euler divides the amplitude by sqrt(1 + z^2) in a step of z = h w, and by 2 in 2 pi/z of them. */
static void it_is_half_in_a_swing(void **state) {
  (void)state;
  double z = 0.1;
  for (z = 0.1; acos(-1) / z * log1p(z * z) < log(2);) z += 1e-5;
  run("--integrator backward_euler --dt 0.01", 0);
  double dt = test_json(r.out, "dt_max"), said = test_json(r.out, "damps_below");
  if (!(fabs(said / (2 * acos(-1) * dt / z) - 1) < 0.03)) fail_msg("%g s for steps of %g s", said, dt);
}

static void damping_that_was_chosen_is_said(void **state) {
  (void)state;
  static const char *const methods[] = {"backward_euler", "local_global"};
  for (size_t k = 0; k < 2; k++) {
    char arguments[80];
    snprintf(arguments, sizeof arguments, "--integrator %s --no-check", methods[k]);
    run(arguments, 0);
    assert_true(test_json(r.out, "drift") < -0.1);
    assert_non_null(strstr(r.out, "damps what swings faster than 0.2"));
    snprintf(arguments, sizeof arguments, "--integrator %s --accuracy 1e-4", methods[k]);
    run(arguments, 5);
  }
}

static void methods_that_resolve_or_keep_what_swings_say_nothing(void **state) {
  (void)state;
  static const char *const methods[] = {"leapfrog", "rk4", "implicit_midpoint", "esdirk4"};
  for (size_t k = 0; k < 4; k++) {
    char arguments[80];
    snprintf(arguments, sizeof arguments, "--integrator %s --until 0.02", methods[k]);
    run(arguments, 0);
    assert_true(isnan(test_json(r.out, "damps_below")));
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(it_is_half_in_a_swing),
      cmocka_unit_test(damping_that_was_chosen_is_said),
      cmocka_unit_test(methods_that_resolve_or_keep_what_swings_say_nothing),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
