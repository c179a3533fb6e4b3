/* A corrector bounds the length of steps, of every kind of method, and is told the accelerations of the start, which
 * count as no evaluations. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

static void fall(test_engine *e, const char *method, double longest, hk_summary *s) {
  test_engine_open(e);
  test_particle(e, 0, 0, 0, 1);
  test_plugin(e, HK_FORCE, "gravity");
  hk_plugin_spec *pacer = test_plugin(e, HK_CORRECTOR, "fixture:pacer");
  test_number(e, pacer, "longest", longest);
  e->options.integrator = method;
  test_run(e);
  test_advance(e, 0.5);
  hk_run_summary(e->run, s);
}

static void steps_are_as_short_as_a_corrector_demands(void **state) {
  (void)state;
  static const char *const methods[] = {"symplectic_euler", "bdf2", "dopri5"};
  for (size_t k = 0; k < sizeof methods / sizeof *methods; k++) {
    test_engine e;
    hk_summary s;
    fall(&e, methods[k], 2e-3, &s);
    if (!(s.dt_max <= 2e-3 * (1 + 1e-9))) fail_msg("%s: steps of %g s", methods[k], s.dt_max);
    test_engine_close(&e);
  }
}

static void accelerations_of_the_start_are_told(void **state) {
  (void)state;
  test_engine e;
  hk_summary s;
  fall(&e, "symplectic_euler", 2e-3, &s);
  size_t found = 0;
  for (size_t k = 0; k < s.plugins; k++)
    if (s.plugin[k].figures == 3) found = k;
  assert_true(fabs(s.plugin[found].figure[1].value - 9.81) < 1e-12);
  assert_int_equal(s.force_evaluations, s.steps);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(steps_are_as_short_as_a_corrector_demands),
      cmocka_unit_test(accelerations_of_the_start_are_told),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
