/* A magnetic field by hand, its Jacobian and power, the choice between its two charges, and the circle that it makes.
 */
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static hk_plugin_spec *open_scene(test_engine *e) {
  test_engine_open(e);
  test_particle(e, 0, 0, 0, 0.5);
  test_particle(e, 1, 0, 0, 2);
  memcpy(e->scene->particles.velocity, (double[]){1, -2, 3, 0.5, 4, -1}, 6 * sizeof(double));
  e->options.dt = 1e-3;
  hk_plugin_spec *field = test_plugin(e, HK_FORCE, "magnetic");
  test_vector(e, field, "B", 2, 1, -1);
  return field;
}

/* v x B is (-1, 7, 5) and (-3, -1.5, -7.5); masses are 0.5 and 2. All exact in binary. */
static void check(const char *name, double value, const double factor[2]) {
  static const double across[6] = {-1, 7, 5, -3, -1.5, -7.5};
  test_engine e;
  double F[6], K[36], D[36];
  hk_plugin_spec *spec = open_scene(&e);
  test_number(&e, spec, name, value);
  test_run(&e);
  hk_instance *field = test_instance(&e, spec);
  hk_view view = force_view(&e, field);
  assert_true(force_evaluate(field, &view, F) == 0); /* it does no work */
  for (int k = 0; k < 6; k++) assert_true(F[k] == factor[k / 3] * across[k]);
  /* The force is linear: differences have rounding alone. */
  assert_true(force_damping_error(field, &view) < 1e-12 && force_stiffness_error(field, &view) == 0);
  assert_int_equal(force_matrices(field, &view, K, D), 2);
  for (int r = 0; r < 6; r++)
    for (int c = 0; c < 6; c++) assert_true(D[6 * r + c] == -D[6 * c + r]);
  test_engine_close(&e);
}

static void magnetic_force_per_particle_and_per_mass_by_hand(void **state) {
  (void)state;
  check("charge", 0.25, (double[]){0.25, 0.25});
  check("charge", -0.5, (double[]){-0.5, -0.5});
  check("ratio", 0.5, (double[]){0.25, 1});
}

static void magnetic_wants_exactly_one_charge(void **state) {
  (void)state;
  for (int both = 0; both < 2; both++) {
    test_engine e;
    hk_plugin_spec *field = open_scene(&e);
    if (both) test_number(&e, field, "charge", 1), test_number(&e, field, "ratio", 1);
    assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
    assert_non_null(strstr(e.error.text, "give either charge"));
    test_engine_close(&e);
  }
}

static void magnetic_acts_on_the_chosen_only(void **state) {
  (void)state;
  test_engine e;
  double F[6];
  hk_plugin_spec *spec = open_scene(&e);
  test_number(&e, spec, "charge", 1);
  spec->only = malloc(sizeof *spec->only);
  spec->only[0] = 1;
  spec->only_count = 1;
  test_run(&e);
  hk_instance *field = test_instance(&e, spec);
  hk_view view = force_view(&e, field);
  force_evaluate(field, &view, F);
  assert_memory_equal(F, ((double[]){0, 0, 0, -3, -1.5, -7.5}), sizeof F);
  assert_true(force_damping_error(field, &view) < 1e-12);
  test_engine_close(&e);
}

/* A circle of radius v m/(q B) = 2 at the rate q B/m = 2, closed after pi s. Implicit midpoint is a rotation by 2
 * atan(h w/2), so it keeps the speed and lags by (h w)^2/12 of the angle: 2 pi/12 x 4e-6 x 2 m = 4.2e-6 m at h = 1e-3.
 * Newton's iteration ends at 1e-6 of the speed, and does so here in one step, for the force is linear. */
static void a_charge_turns_at_its_gyrofrequency(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 3);
  memcpy(e.scene->particles.velocity, (double[]){4, 0, 0}, 3 * sizeof(double));
  hk_plugin_spec *field = test_plugin(&e, HK_FORCE, "magnetic");
  test_vector(&e, field, "B", 0, 0, 2);
  test_number(&e, field, "charge", 3);
  test_plugin(&e, HK_INTEGRATOR, "implicit_midpoint");
  e.scene->duration = acos(-1);
  e.scene->fps = 1 / acos(-1);
  e.options.dt = acos(-1) / 3142;
  test_run(&e);
  test_advance(&e, acos(-1) / 2);
  assert_true(fabs(test_position(&e, 1)[1] + 4) < 1e-5 && fabs(test_velocity(&e, 1)[0] + 4) < 1e-5);
  test_advance(&e, acos(-1));
  const double *x = test_position(&e, 1), *v = test_velocity(&e, 1);
  double off = sqrt(x[0] * x[0] + x[1] * x[1]);
  assert_true(off > 2e-6 && off < 8e-6 && x[2] == 0);
  assert_true(fabs(sqrt(v[0] * v[0] + v[1] * v[1]) - 4) < 1e-11); /* 3142 steps' rounding */
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(magnetic_force_per_particle_and_per_mass_by_hand),
      cmocka_unit_test(magnetic_wants_exactly_one_charge),
      cmocka_unit_test(magnetic_acts_on_the_chosen_only),
      cmocka_unit_test(a_charge_turns_at_its_gyrofrequency),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
