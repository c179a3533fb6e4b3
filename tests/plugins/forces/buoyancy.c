/* Buoyancy by hand, and a hot particle that cools while it rises, against the closed form. */
#include "tests/support/force_check.h"

#include <setjmp.h>
#include <stdarg.h>
#include <string.h>

#include <cmocka.h>

static hk_plugin_spec *open_scene(test_engine *e, double decay) {
  test_engine_open(e);
  assert_int_equal(hk_scene_add_channel(e->scene, "age", 2, (double[]){1, 2}, NAN, NULL, &e->error), HK_OK);
  assert_int_equal(hk_scene_add_channel(e->scene, "temperature", 1, (double[]){400}, decay, NULL, &e->error), HK_OK);
  test_particle(e, 0, 0, 0, 0.5);
  test_particle(e, 1, 0, 0, 2);
  assert_int_equal(hk_scene_set_channel(e->scene, "temperature", 2, (double[]){250}, 1, &e->error), HK_OK);
  memcpy(e->scene->particles.velocity, (double[]){0, 0, 3, 0, 1, -1}, 6 * sizeof(double));
  hk_plugin_spec *spec = test_plugin(e, HK_FORCE, "buoyancy");
  test_number(e, spec, "ambient", 300);
  return spec;
}

/* m g beta (T - T0) upwards: 0.5 * 10 * 100/300 and -2 * 10 * 50/300, times 0.6 with beta = 0.002. */
static void buoyancy_by_hand(void **state) {
  (void)state;
  for (int given = 0; given < 2; given++) {
    double F[6], scale = given ? 0.6 : 1;
    test_engine e;
    hk_plugin_spec *spec = open_scene(&e, NAN);
    test_vector(&e, spec, "g", 0, 0, -10);
    if (given) test_number(&e, spec, "beta", 0.002);
    e.options.dt = 1e-3;
    test_run(&e);
    hk_instance *force = test_instance(&e, spec);
    hk_view view = force_view(&e, force);
    double power = force_evaluate(force, &view, F);
    const double wanted[6] = {0, 0, scale * 5.0 / 3, 0, 0, -scale * 10.0 / 3};
    for (int k = 0; k < 6; k++) assert_true(fabs(F[k] - wanted[k]) < 1e-14);
    assert_true(fabs(power - (3 * wanted[2] - wanted[5])) < 1e-14);
    test_engine_close(&e);
  }
}

/* T = T1 exp(-k t), T0 = 300: z'' = g (T/T0 - 1), z = v t + g (T1/T0 (exp(-k t) - 1 + k t)/k^2 - t^2/2). rk4 with h =
 * 1/100 is off by some h^4 = 1e-8 of a metre. */
static void what_rises_cools(void **state) {
  (void)state;
  const double k = 0.7, t = 1;
  test_engine e;
  open_scene(&e, -k);
  e.options.integrator = "rk4";
  e.options.dt = 0.01;
  test_run(&e);
  test_advance(&e, t);
  double z = 3 * t + 9.81 * (400.0 / 300 * (exp(-k * t) - 1 + k * t) / (k * k) - t * t / 2);
  assert_true(fabs(test_position(&e, 1)[2] - z) < 1e-8);
  test_engine_close(&e);
}

/* Ice of 0.5 kg at 0 C floats by 0.083 of its weight, 2 kg of water at 10 K above T0 by 10 beta of its; half of it
 * molten by half of what ice has, at the melting point, which is T0. */
static void what_melts_is_lifted_by_what_is_solid_and_what_is_warm(void **state) {
  (void)state;
  const double latent = 333600, capacity = 4220, beta = 0.002, lighter = 0.083, warm = latent + 9 * capacity;
  const double h[3] = {0, warm, latent / 2},
               wanted[3] = {0.5 * 10 * lighter, 2 * 10 * 10 * beta, 10 * (lighter / 2 + beta * 0.5 / 2)};
  test_engine e;
  double F[9];
  test_engine_open(&e);
  assert_int_equal(hk_scene_add_channel(e.scene, "enthalpy", 1, (double[]){0}, NAN, NULL, &e.error), HK_OK);
  test_particle(&e, 0, 0, 0, 0.5), test_particle(&e, 1, 0, 0, 2), test_particle(&e, 2, 0, 0, 1);
  for (uint32_t id = 1; id <= 3; id++)
    assert_int_equal(hk_scene_set_channel(e.scene, "enthalpy", id, &h[id - 1], 1, &e.error), HK_OK);
  hk_plugin_spec *melt = test_plugin(&e, HK_FORCE, "melt"), *spec = test_plugin(&e, HK_FORCE, "buoyancy");
  test_text(&e, melt, "channel", "enthalpy");
  test_number(&e, melt, "solidus", 273.15);
  test_number(&e, melt, "liquidus", 274.15);
  test_number(&e, melt, "latent", latent);
  test_number(&e, melt, "capacity", capacity);
  test_number(&e, melt, "viscosity", 0.0018);
  test_text(&e, spec, "of", "melt");
  test_number(&e, spec, "lighter", lighter);
  test_number(&e, spec, "beta", beta);
  test_number(&e, spec, "ambient", 273.15);
  test_vector(&e, spec, "g", 0, 0, -10);
  e.options.dt = 1e-3;
  test_run(&e);
  hk_instance *force = test_instance(&e, spec), *before = test_instance(&e, melt);
  hk_view view = force_view(&e, force), its = force_view(&e, before);
  double rate[3] = {0};
  assert_int_equal(before->plugin->force->rates(before->self, &its, rate), HK_OK); /* as each evaluation begins */
  force_evaluate(force, &view, F);
  for (int k = 0; k < 3; k++)
    if (!(fabs(F[3 * k + 2] - wanted[k]) < 1e-12)) fail_msg("%d: %.15g N, not %.15g N", k, F[3 * k + 2], wanted[k]);
  test_engine_close(&e);
}

static void refused(const char *name, const char *text, double lighter, const char *says) {
  test_engine e;
  hk_plugin_spec *spec = open_scene(&e, NAN);
  if (name) test_text(&e, spec, name, text);
  if (name) test_text(&e, spec, "of", "melt");
  test_number(&e, spec, "lighter", lighter);
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
  if (!strstr(e.error.text, says)) fail_msg("%s", e.error.text);
  test_engine_close(&e);
}

static void wrong_melts_are_refused(void **state) {
  (void)state;
  refused(NULL, NULL, 0.083, "give the label of a force melt");
  refused("channel", "temperature", 0, "give one of channel, of");
  refused("of", "melt", 0, "nothing with the label 'melt'");
}

static void a_scene_without_temperatures_is_refused(void **state) {
  (void)state;
  test_engine e;
  test_engine_open(&e);
  test_particle(&e, 0, 0, 0, 1);
  test_plugin(&e, HK_FORCE, "buoyancy");
  assert_int_equal(hk_run_open(e.scene, &e.options, &e.run, &e.error), HK_BAD_PARAM);
  assert_non_null(strstr(e.error.text, "channel: the scene has no channel 'temperature'; declare it"));
  test_engine_close(&e);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(buoyancy_by_hand),
      cmocka_unit_test(what_rises_cools),
      cmocka_unit_test(what_melts_is_lifted_by_what_is_solid_and_what_is_warm),
      cmocka_unit_test(wrong_melts_are_refused),
      cmocka_unit_test(a_scene_without_temperatures_is_refused),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
