/* Forces on single particles, gravity, drag and central: values by hand, gradients, and what must never be NaN. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

/* The force of one plugin on one particle of 2 kg at x with velocity v. */
static double force_at(test_engine *e, hk_instance *force, const double x[3], const double v[3], double F[3]) {
  hk_view view = *hk_run_view(e->run);
  double power = 0;
  view.x = x;
  view.v = v;
  view.power = &power;
  view.host = &force->host;
  memset(F, 0, 3 * sizeof *F);
  assert_int_equal(force->plugin->force->add(force->self, &view, F), HK_OK);
  return power;
}

static double energy_at(test_engine *e, hk_instance *force, const double x[3]) {
  hk_view view = *hk_run_view(e->run);
  view.x = x;
  return force->plugin->force->energy(force->self, &view);
}

static hk_plugin_spec *open_one(test_engine *e, const char *name) {
  test_engine_open(e);
  test_particle(e, 1, 0, 0, 2);
  e->options.dt = 1e-3;
  return test_plugin(e, HK_FORCE, name);
}

static void gravity_is_m_g(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_one(&e, "gravity");
  double F[3], x[3] = {1, 2, 3}, v[3] = {4, 5, 6};
  test_vector(&e, spec, "g", 1, -2, 3);
  test_run(&e);
  hk_instance *gravity = test_instance(&e, spec);
  assert_true(force_at(&e, gravity, x, v, F) == 0);
  assert_true(F[0] == 2 && F[1] == -4 && F[2] == 6);
  assert_true(energy_at(&e, gravity, x) == -2 * (1 - 4 + 9));
  test_engine_close(&e);
}

static void drag_is_per_particle_or_per_mass(void **state) {
  (void)state;
  const char *const names[] = {"d", "rate"};
  for (int k = 0; k < 2; k++) {
    test_engine e;
    hk_plugin_spec *spec = open_one(&e, "drag");
    double F[3], x[3] = {0}, v[3] = {1, -2, 2}, d = k == 0 ? 0.5 : 0.5 * 2;
    test_number(&e, spec, names[k], 0.5);
    test_run(&e);
    hk_instance *drag = test_instance(&e, spec);
    assert_true(force_at(&e, drag, x, v, F) == -d * 9);
    assert_true(F[0] == -d && F[1] == 2 * d && F[2] == -2 * d);
    test_engine_close(&e);
  }
}

static void drag_wants_exactly_one_coefficient(void **state) {
  (void)state;
  for (int both = 0; both < 2; both++) {
    test_engine e;
    hk_plugin_spec *drag = open_one(&e, "drag");
    if (both) test_number(&e, drag, "d", 1), test_number(&e, drag, "rate", 1);
    assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
    assert_non_null(strstr(e.error.text, "give either d"));
    test_engine_close(&e);
  }
}

/* Kepler: at (3, 4, 0) with GM = 50, m = 2: F = -2 * 50 / 25 toward the centre; energy -m GM / r. */
static void central_power_minus_two_is_keplers(void **state) {
  (void)state;
  test_engine e;
  hk_plugin_spec *spec = open_one(&e, "central");
  double F[3], x[3] = {3, 4, 0}, v[3] = {0};
  test_number(&e, spec, "strength", 50);
  test_number(&e, spec, "power", -2);
  test_run(&e);
  hk_instance *central = test_instance(&e, spec);
  force_at(&e, central, x, v, F);
  assert_true(fabs(F[0] + 4 * 0.6) < 1e-14 && fabs(F[1] + 4 * 0.8) < 1e-14 && F[2] == 0);
  assert_true(fabs(energy_at(&e, central, x) + 2 * 50 / 5.0) < 1e-13);
  test_engine_close(&e);
}

/* Central differences with h = 6e-6, truncation and rounding each about 4e-11 times derivatives of some tens. */
static void central_force_is_minus_the_gradient_of_its_energy(void **state) {
  (void)state;
  const double powers[] = {1, 0, -1, -2, -3, 2.5};
  for (size_t p = 0; p < sizeof powers / sizeof *powers; p++)
    for (int line = 0; line < 2; line++) {
      test_engine e;
      hk_plugin_spec *spec = open_one(&e, "central");
      double F[3], x[3] = {0.7, -0.4, 0.9}, v[3] = {0}, h = 6e-6;
      test_number(&e, spec, "strength", 3);
      test_number(&e, spec, "power", powers[p]);
      test_number(&e, spec, "softening", 0.1);
      test_vector(&e, spec, "center", 0.1, 0.2, -0.3);
      if (line) test_vector(&e, spec, "axis", 1, 2, 2);
      test_run(&e);
      hk_instance *central = test_instance(&e, spec);
      force_at(&e, central, x, v, F);
      for (int c = 0; c < 3; c++) {
        double up[3] = {x[0], x[1], x[2]}, down[3] = {x[0], x[1], x[2]};
        up[c] += h;
        down[c] -= h;
        double slope = (energy_at(&e, central, up) - energy_at(&e, central, down)) / (2 * h);
        if (!(fabs(F[c] + slope) < 2e-8)) fail_msg("power %g: %g is not %g", powers[p], F[c], -slope);
      }
      test_engine_close(&e);
    }
}

static void the_centre_itself_gets_no_force_and_no_nan(void **state) {
  (void)state;
  const double powers[] = {1, 0, -1, -2, -20};
  for (size_t p = 0; p < sizeof powers / sizeof *powers; p++) {
    test_engine e;
    hk_plugin_spec *spec = open_one(&e, "central");
    double F[3], x[3] = {0}, v[3] = {0};
    test_number(&e, spec, "strength", 3);
    test_number(&e, spec, "power", powers[p]);
    test_run(&e);
    hk_instance *central = test_instance(&e, spec);
    force_at(&e, central, x, v, F);
    assert_true(F[0] == 0 && F[1] == 0 && F[2] == 0);
    assert_true(isfinite(energy_at(&e, central, x)));
    test_engine_close(&e);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(gravity_is_m_g),
      cmocka_unit_test(drag_is_per_particle_or_per_mass),
      cmocka_unit_test(drag_wants_exactly_one_coefficient),
      cmocka_unit_test(central_power_minus_two_is_keplers),
      cmocka_unit_test(central_force_is_minus_the_gradient_of_its_energy),
      cmocka_unit_test(the_centre_itself_gets_no_force_and_no_nan),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
