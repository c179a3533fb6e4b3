/* core/run/judge/checked.c: what stands still and trembles by rounding has no energy to lose, and what moves little
 * has. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

enum { N = 9 };

/* The verdict of a chain whose last particle starts with the speed, by its energy alone: compared with no other run. */
static hk_verdict verdict_of(const char *method, double dt, double speed) {
  uint32_t edge[N - 1][2];
  hk_summary s;
  test_engine e;
  test_engine_open(&e);
  for (uint32_t k = 0; k < N; k++) test_particle(&e, 0.2 + 0.1 * k, 0.3 - 0.07 * k, 0.4, 0.01);
  for (uint32_t k = 0; k + 1 < N; k++) edge[k][0] = k + 1, edge[k][1] = k + 2;
  e.scene->particles.velocity[3 * (N - 1)] = speed;
  hk_plugin_spec *springs = test_plugin(&e, HK_FORCE, "springs");
  test_edges(&e, springs, (const uint32_t(*)[2])edge, N - 1);
  test_number(&e, springs, "k", 100);
  e.options.integrator = method;
  e.options.dt = dt;
  e.options.until = 0.5;
  e.options.compare = HK_COMPARE_ASKED;
  test_run(&e);
  test_advance(&e, 0.5);
  hk_run_close(e.run, &e.error);
  hk_run_summary(e.run, &s);
  print_message("%s at %g m/s: energy %g J to %g J, %s %s\n", method, speed, s.energy_first, s.energy_last,
                s.verdict_name, s.reason);
  test_engine_close(&e);
  return s.verdict;
}

static void rounding_is_no_energy(void **state) {
  (void)state;
  assert_int_equal(verdict_of("leapfrog", 1e-3, 0), HK_VERDICT_OK);
}

/* Kinetic and potential energy that cancel: their sum is rounding of each. One frame, so that there is no mean. */
static void what_cancels_is_rounding(void **state) {
  hk_summary s;
  test_engine e;
  (void)state;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1);
  test_plugin(&e, HK_FORCE, "gravity");
  e.options.integrator = "leapfrog";
  e.options.dt = 0.01;
  e.scene->fps = 10;
  e.scene->duration = 0.1;
  e.options.compare = HK_COMPARE_ASKED;
  test_run(&e);
  test_advance(&e, 0.05);
  hk_run_close(e.run, &e.error);
  hk_run_summary(e.run, &s);
  if (s.verdict == HK_INACCURATE) fail_msg("%s; last %g J", s.reason, s.energy_last);
  test_engine_close(&e);
}

/* Euler's method makes energy: 0.5 h w^2 of it a second, with w of some 200/s; also of a billionth of a metre. */
static void little_energy_is_energy(void **state) {
  (void)state;
  assert_int_equal(verdict_of("leapfrog", 1e-3, 1e-7), HK_VERDICT_OK);
  assert_int_equal(verdict_of("euler", 1e-3, 1e-7), HK_INACCURATE);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(rounding_is_no_energy),
                                     cmocka_unit_test(what_cancels_is_rounding),
                                     cmocka_unit_test(little_energy_is_energy)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
