/* Weight, its energy, and whom it acts on. */
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

static hk_plugin_spec *open_scene(test_engine *e) {
  test_engine_open(e);
  test_particle(e, 1, 2, 3, 0.5);
  test_particle(e, -1, 0.5, 2, 2);
  test_particle(e, 0.3, 0.1, -4, 3);
  e->options.dt = 1e-3;
  return test_plugin(e, HK_FORCE, "gravity");
}

/* The products are exact to their one rounding. */
static void gravity_is_mass_times_g(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_scene(&e);
  test_run(&e);
  hk_instance *g = test_instance(&e, spec);
  hk_view view = force_view(&e, g);
  double F[9], standard[9] = {0, 0, -4.905, 0, 0, -19.62, 0, 0, -29.43};
  assert_true(force_evaluate(g, &view, F) == 0);
  for (int k = 0; k < 9; k++) assert_true(fabs(F[k] - standard[k]) < 1e-14);
  test_engine_close(&e);
}

/* The energy is linear, so differences have rounding alone: 1e-16 of some 50 J over a step of 1e-3 m. */
static void gravity_is_minus_the_gradient_of_its_energy(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_scene(&e);
  test_vector(&e, spec, "g", 1, -2, 3.5);
  test_run(&e);
  hk_instance *g = test_instance(&e, spec);
  hk_view view = force_view(&e, g);
  assert_true(force_gradient_error(g, &view) < 1e-12);
  assert_true(fabs(g->plugin->force->energy(g->self, &view) - (-0.5 * 7.5 - 2 * 5 - 3 * (0.3 - 0.2 - 14))) < 1e-13);
  test_engine_close(&e);
}

static void gravity_names_no_blocks(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_scene(&e);
  test_run(&e);
  hk_instance *g = test_instance(&e, spec);
  hk_view view = force_view(&e, g);
  double K[81], D[81];
  assert_int_equal(force_matrices(g, &view, K, D), 0);
  test_engine_close(&e);
}

static void gravity_acts_on_the_chosen_only(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_scene(&e);
  spec->only = malloc(sizeof *spec->only);
  spec->only[0] = 1;
  spec->only_count = 1;
  test_run(&e);
  hk_instance *g = test_instance(&e, spec);
  hk_view view = force_view(&e, g);
  double F[9];
  force_evaluate(g, &view, F);
  for (int k = 0; k < 9; k++) assert_true(k == 5 ? F[k] < -19 : F[k] == 0);
  assert_true(fabs(g->plugin->force->energy(g->self, &view) - 2 * 9.81 * 2) < 1e-13);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(gravity_is_mass_times_g),
      cmocka_unit_test(gravity_is_minus_the_gradient_of_its_energy),
      cmocka_unit_test(gravity_names_no_blocks),
      cmocka_unit_test(gravity_acts_on_the_chosen_only),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
