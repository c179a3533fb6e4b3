/* cvode and arkode in steps that the host limits: a limit holds for the step that it is given with. Their errors and
 * solvers are in tests/plugins/common/sundials. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <unistd.h>

#include <cmocka.h>

/* The steps that an orbit takes with two cuts close to each other, between which steps can be no longer than that. */
static size_t steps_with_cuts(const char *integrator, const char *method, const double cut[2]) {
  test_engine e;
  hk_summary s;
  test_engine_open(&e);
  test_particle(&e, 0.4, 0, 0, 1);
  e.scene->particles.velocity[1] = 2;
  hk_plugin_spec *sun = test_plugin(&e, HK_FORCE, "central");
  test_number(&e, sun, "strength", 1);
  test_number(&e, sun, "power", -2);
  hk_plugin_spec *spec = test_plugin(&e, HK_INTEGRATOR, integrator);
  hk_value value = {.kind = HK_VALUE_STRING, .text = method};
  assert_int_equal(hk_spec_set(spec, hk_spec_param(spec, "method", &e.error), &value, 1, &e.error), HK_OK);
  e.scene->duration = 10;
  e.options.tol = 1e-5;
  e.options.refine = 1;
  e.options.cut = cut, e.options.cuts = cut ? 2 : 0;
  test_run(&e);
  test_advance(&e, 10);
  hk_run_summary(e.run, &s);
  test_engine_close(&e);
  return s.steps;
}

static void a_short_piece_leaves_later_steps_as_long_as_they_were(void **state) {
  (void)state;
  static const char *const methods[][2] = {{"cvode", "adams"}, {"cvode", "bdf"}, {"arkode", "erk"}};
  static const double cut[2] = {5.003, 5.003 + 1e-6};
  if (access(HK_BUILD "/plugins/integrators/cvode.so", R_OK) != 0) skip();
  for (size_t k = 0; k < 3; k++) {
    size_t without = steps_with_cuts(methods[k][0], methods[k][1], NULL);
    size_t with = steps_with_cuts(methods[k][0], methods[k][1], cut);
    print_message("%s %s: %zu steps, with a piece of 1e-6 s %zu\n", methods[k][0], methods[k][1], without, with);
    assert_true(with < 3 * without); /* with a limit of 3e-7 s that stays, 1e7 */
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_short_piece_leaves_later_steps_as_long_as_they_were),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
