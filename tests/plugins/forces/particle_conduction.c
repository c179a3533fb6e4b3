/* Heat between particles: a wave of temperature decays at its rate, the enthalpy is kept, walls hold their temperature,
 * and steps are short enough. */
#include "tests/support/engine.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

static const double pi = 3.14159265358979323846;

/* A bar of `length` x 4 particles of the distance 0.1 m in a plane that repeats, whose enthalpies `h` gives. */
static hk_plugin_spec *bar(test_engine *e, int length, double (*h)(double x)) {
  double none = 0, spacing = 0.1;
  test_engine_open(e);
  assert_int_equal(hk_scene_add_channel(e->scene, "enthalpy", 1, &none, NAN, NULL, &e->error), HK_OK);
  assert_int_equal(hk_scene_add_channel(e->scene, "given", 1, &none, NAN, NULL, &e->error), HK_OK);
  e->scene->box = (hk_periodic_box){{0, 0, 0}, {length * spacing, 8 * spacing, 0}, {true, true, false}};
  for (int i = 0; i < length; i++)
    for (int j = 0; j < 8; j++) {
      double x = (i + 0.5) * spacing, value = h(x);
      uint32_t id = test_particle(e, x, (j + 0.5) * spacing, 0, 1000 * spacing * spacing * spacing);
      assert_int_equal(hk_scene_set_channel(e->scene, "enthalpy", id, &value, 1, &e->error), HK_OK);
      test_pin(e, HK_PIN_PLANE, id, (double[]){0, 0, 1});
    }
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "particle_conduction");
  test_text(e, spec, "channel", "enthalpy");
  test_text(e, spec, "account", "given");
  test_number(e, spec, "spacing", spacing);
  test_number(e, spec, "dimensions", 2);
  test_number(e, spec, "capacity", 2);
  test_number(e, spec, "conductivity", 50);
  e->options.integrator = "rk4";
  return spec;
}

static double total(test_engine *e) {
  const hk_view *view = hk_run_view(e->run);
  double sum = 0;
  for (size_t i = 0; i < view->n; i++) sum += view->model->mass[i] * (view->y[i] - view->y[view->n + i]);
  return sum;
}

static double wave(double x) { return 100 + sin(2 * pi * x / 3.2); }

/* exp(-a k^2 t) with a = k/(rho c): the error is of the order (k R)^2 = 0.35, by a small
 * number, 0.6 % here. */
static double decay_error(int length) {
  test_engine e;
  bar(&e, length, wave);
  double a = 50 / (1000.0 * 2), k = 2 * pi / 3.2, end = 0.5 / (a * k * k);
  e.scene->fps = 1 / end;
  test_run(&e);
  double before = total(&e), start = hk_run_view(e.run)->y[3 * 8] - 100;
  test_advance(&e, end);
  double rate = -log((hk_run_view(e.run)->y[3 * 8] - 100) / start) / 0.5;
  printf("decay rate %.5g of the exact one, enthalpy off by %.2g of it\n", rate, total(&e) / before - 1);
  assert_true(fabs(total(&e) / before - 1) < 1e-12);
  test_engine_close(&e);
  return rate - 1;
}

static void a_wave_decays_at_its_rate(void **state) {
  (void)state;
  assert_true(fabs(decay_error(32)) < 0.01);
}

static double step_of_ten(double x) { return x < 1.6 ? 110 : 100; }

/* The first column is a wall: it keeps 110, what it gives is counted, and nothing becomes warmer. */
static void walls_keep_their_temperature(void **state) {
  (void)state;
  test_engine e;
  double wall[8];
  hk_plugin_spec *spec = bar(&e, 32, step_of_ten);
  for (int j = 0; j < 8; j++) wall[j] = 1 + j;
  test_list(&e, spec, "walls", wall, 8);
  test_number(&e, spec, "wall_volume", 1e-3);
  e.options.integrator = "euler";
  e.options.dt = 100;
  e.scene->fps = 0.1;
  test_run(&e);
  double before = total(&e);
  test_advance(&e, 100);
  const double *y = hk_run_view(e.run)->y;
  for (int i = 0; i < 256; i++) assert_true(y[i] >= 100 && y[i] <= 110);
  assert_true(y[0] == 110 && y[256] > 1 && y[8 * 20] > 100.1);
  assert_true(fabs(total(&e) / before - 1) < 1e-12);
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_wave_decays_at_its_rate),
      cmocka_unit_test(walls_keep_their_temperature),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
