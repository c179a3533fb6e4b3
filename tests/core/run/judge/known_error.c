/* Where a scene states its exact solution, an error of more than a tenth of the motion makes a run inaccurate, whether
 * an accuracy was asked for or not; right runs stay ok. */
#include "tests/support/command.h"
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static test_result r;

/* A mass of 1 kg on a spring of 100 N/m swings with an amplitude of 0.2 m for ten periods; the exact solution is that
 * of the angular frequency w, 10 1/s. */
static void swing(const char *arguments, int code) {
  char scene[1024], all[256];
  snprintf(scene, sizeof scene, "%s",
           "local scene = hooke.scene { duration = 6.5, fps = 10, integrator = 'leapfrog' }\n"
           "local a = scene:particle { mass = 1 }\nlocal b = scene:particle { position = {1.2, 0, 0}, mass = 1 }\n"
           "scene:pin { a }\nscene:force('springs', { edges = {{a, b}}, k = 100, rest = 1 })\n"
           "scene:exact(function(t) return 0, 0, 0, 1 + 0.2 * math.cos(10 * t), 0, 0 end)\nreturn scene\n");
  test_write("swing.lua", scene);
  snprintf(all, sizeof all, "run swing.lua --json --quiet %s", arguments);
  test_hooke(&r, NULL, all);
  if (r.code != code) fail_msg("%s: exit %d: %s%s", arguments, r.code, r.out, r.err);
}

/* Leapfrog with h w = 0.5 is ahead by h^2 w^2/24 of the phase, 0.68 radians after 6.5 s; with 0.05 by 0.007. */
static void an_error_above_a_tenth_of_the_motion_is_inaccurate(void **state) {
  (void)state;
  swing("--dt 0.05", 5);
  assert_true(test_json(r.out, "exact_error") > 0.02);
  assert_non_null(strstr(r.out, "the error against the exact solution"));
  assert_non_null(strstr(r.out, "is more than a tenth of the motion"));
}

static void a_right_run_is_ok(void **state) {
  (void)state;
  swing("--dt 0.005", 0);
  assert_true(test_json(r.out, "exact_error") < 0.005);
}

/* The accuracy that was asked for is the measure where there is one: 1 m is reached, 1e-4 m is not. */
static void an_accuracy_that_is_asked_for_is_the_measure(void **state) {
  (void)state;
  swing("--dt 0.05 --accuracy 1", 0);
  swing("--dt 0.005 --accuracy 1e-4", 5);
}

/* One metre off all the way: the particle flies, its exact solution stands a metre beside its path. */
static hk_status beside(const hk_function *f, const void *caller, const double *in, size_t n_in, double *out,
                        size_t max_out, size_t *n_out, hk_error *error) {
  (void)f, (void)caller, (void)n_in, (void)max_out, (void)error;
  memcpy(out, (double[]){in[0], 1, 0}, 3 * sizeof *out);
  *n_out = 3;
  return HK_OK;
}

static hk_verdict verdict_of(bool ignore_exact) {
  test_engine e;
  hk_summary s;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1);
  e.scene->particles.velocity[0] = 1;
  e.scene->exact = (hk_function){.call = beside};
  e.options.ignore_exact = ignore_exact;
  test_run(&e);
  test_advance(&e, 0.5);
  assert_int_equal(hk_run_close(e.run, &e.error), HK_OK);
  hk_run_summary(e.run, &s);
  assert_true(fabs(s.exact_error - 1) < 1e-12);
  test_engine_close(&e);
  return s.verdict;
}

static void tools_may_judge_without_it(void **state) {
  (void)state;
  assert_int_equal(verdict_of(false), HK_INACCURATE);
  assert_int_equal(verdict_of(true), HK_VERDICT_OK);
}

/* What stands still has no motion to compare an error with; rounding is no error. */
static void a_scene_at_rest_is_ok(void **state) {
  (void)state;
  test_write("rest.lua", "local scene = hooke.scene { duration = 1, fps = 10 }\n"
                         "local a = scene:particle { mass = 1 }\nlocal b = scene:particle { position = {0, 0, -1}, "
                         "mass = 1 }\nscene:pin { a }\nscene:force('gravity')\n"
                         "scene:force('springs', { edges = {{a, b}}, k = 98.1, rest = 0.9 })\n"
                         "scene:exact(function(t) return 0, 0, 0, 0, 0, -1 end)\nreturn scene\n");
  test_hooke(&r, NULL, "run rest.lua --json --quiet");
  if (r.code != 0) fail_msg("%s", r.out);
}

/* With a z forgotten, all numbers behind it would be those of other coordinates, or nothing be compared. */
static void numbers_that_are_no_positions_are_refused(void **state) {
  (void)state;
  static const char *const given[] = {"t, 0", "t, 0, 0, 1"};
  for (size_t k = 0; k < 2; k++) {
    char scene[512];
    snprintf(scene, sizeof scene,
             "local scene = hooke.scene { duration = 1, fps = 10 }\n"
             "scene:particle { velocity = {1, 0, 0}, mass = 1 }\nscene:particle { position = {1, 0, 0}, mass = 1 }\n"
             "scene:exact(function(t) return %s end)\nreturn scene\n",
             given[k]);
    test_write("short.lua", scene);
    test_hooke(&r, NULL, "run short.lua --quiet");
    if (r.code != 1 || !strstr(r.err, "which are not x, y, z of whole particles")) fail_msg("%d: %s", r.code, r.err);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(an_error_above_a_tenth_of_the_motion_is_inaccurate),
      cmocka_unit_test(a_right_run_is_ok),
      cmocka_unit_test(an_accuracy_that_is_asked_for_is_the_measure),
      cmocka_unit_test(numbers_that_are_no_positions_are_refused),
      cmocka_unit_test(tools_may_judge_without_it),
      cmocka_unit_test(a_scene_at_rest_is_ok),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
